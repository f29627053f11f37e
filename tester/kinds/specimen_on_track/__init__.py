"""A rubber specimen on a moving track: a block on a slow linear track in a chamber, or a pin on a disc."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from tester.kinds.kind import Kind

if TYPE_CHECKING:
    from tester.analysis.fit.fit_part import FitPart
    from tester.analysis.master_curve.points import MasterPart
    from tester.analysis.papers.item import Paper
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.rig import Rig
    from tester.machine.interlock_sheet import InterlockSheet
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind


def _rig() -> type[Rig]:
    from tester.kinds.specimen_on_track.rig import TrackConfig

    return TrackConfig


def _interlocks() -> InterlockSheet:
    from tester.kinds.specimen_on_track.interlocks import operation
    from tester.kinds.specimen_on_track.interlocks.table import TABLE
    from tester.machine.interlock_sheet import InterlockSheet

    return InterlockSheet(TABLE.rows, operation.PARAMETERS, operation.ABOUT)


def _recipe() -> RecipePart:
    from tester.kinds.specimen_on_track.recipe.part import PART

    return PART


def _runs() -> KindRun:
    from tester.kinds.specimen_on_track.runs import RUNS

    return RUNS


def _papers() -> tuple[Paper, ...]:
    from tester.kinds.specimen_on_track.papers import PAPERS

    return PAPERS


def _masters() -> MasterPart:
    from tester.kinds.specimen_on_track.fit.master_conditions import MASTERS

    return MASTERS


def _served() -> ServedKind:
    from tester.kinds.specimen_on_track.served import SERVED

    return SERVED


def _fits() -> FitPart:
    from tester.kinds.specimen_on_track.fit.fits import FITS

    return FITS


KIND: Final = Kind(
    name="specimen_on_track",
    title="rubber specimen on a moving track",
    measurand="the friction coefficient of a rubber specimen that is pressed on a moving track: force along the track "
    "over the load, mean of the repeats of each condition",
    rigs={
        "grosch": "tester.kinds.specimen_on_track:grosch.yaml",
        "pin-on-disc": "tester.kinds.specimen_on_track:pin-on-disc.yaml",
    },
    rig=_rig,
    interlocks=_interlocks,
    page="docs/kinds/specimen-on-track.md",
    recipe=_recipe,
    runs=_runs,
    papers=_papers,
    masters=_masters,
    served=_served,
    fits=_fits,
)
