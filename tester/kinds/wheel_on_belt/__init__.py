"""A rubber wheel that rolls and slips on a belt: the machine of Polymers 2024, 16(5), 596."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from tester.kinds.kind import Kind

if TYPE_CHECKING:
    from tester.analysis.fit.fit_part import FitPart
    from tester.analysis.master_curve.points import MasterPart
    from tester.analysis.papers.item import Paper
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.rig import Rig
    from tester.machine.commission.commission_step import CommissionPart
    from tester.machine.interlock_sheet import InterlockSheet
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind
    from tester.results.ring_part import RingPart


def _rig() -> type[Rig]:
    from tester.kinds.wheel_on_belt.rig.wheel_rig import RigConfig

    return RigConfig


def _interlocks() -> InterlockSheet:
    from tester.kinds.wheel_on_belt.interlocks import operation
    from tester.kinds.wheel_on_belt.interlocks.table import INTERLOCKS
    from tester.machine.interlock_sheet import InterlockSheet

    return InterlockSheet(INTERLOCKS, operation.PARAMETERS, operation.ABOUT)


def _recipe() -> RecipePart:
    from tester.kinds.wheel_on_belt.recipe.part import PART

    return PART


def _runs() -> KindRun:
    from tester.kinds.wheel_on_belt.run.runs import RUNS

    return RUNS


def _served() -> ServedKind:
    from tester.kinds.wheel_on_belt.served.served import SERVED

    return SERVED


def _fits() -> FitPart:
    from tester.kinds.wheel_on_belt.fit.fits import FITS

    return FITS


def _papers() -> tuple[Paper, ...]:
    from tester.kinds.wheel_on_belt.papers import PAPERS

    return PAPERS


def _masters() -> MasterPart:
    from tester.kinds.wheel_on_belt.fit.master_conditions import MASTERS

    return MASTERS


def _commissions() -> CommissionPart:
    from tester.kinds.wheel_on_belt.commission.commission_steps import COMMISSIONS

    return COMMISSIONS


def _ring() -> RingPart:
    from tester.kinds.wheel_on_belt.run.past_runs import RING

    return RING


KIND: Final = Kind(
    name="wheel_on_belt",
    title="rubber wheel on a belt",
    measurand="the friction coefficient of a rubber wheel that turns against an abrasive belt and slips on it: "
    "horizontal force at the contact over the load, mean of the repeats of each condition",
    rigs={"sim": "sim:rig.yaml"},
    rig=_rig,
    interlocks=_interlocks,
    page="docs/kinds/wheel-on-belt.md",
    recipe=_recipe,
    runs=_runs,
    served=_served,
    fits=_fits,
    papers=_papers,
    masters=_masters,
    commissions=_commissions,
    ring=_ring,
)
