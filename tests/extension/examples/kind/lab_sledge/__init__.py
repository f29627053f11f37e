"""A sledge that a drive pulls over a plate through a spring: a kind of rig of a laboratory's own."""

from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.rig import Rig
from tester.kinds.kind import Kind
from tester.machine.interlock_sheet import InterlockSheet
from tester.machine.run_parts import KindRun
from tester.machine.served import ServedKind


def _rig() -> type[Rig]:
    from lab_sledge.rig import SledgeRig

    return SledgeRig


def _interlocks() -> InterlockSheet:
    from lab_sledge.rig import TABLE
    from tester.machine.plain.rows import ABOUT

    return InterlockSheet(TABLE.rows, TABLE.operation, ABOUT)


def _runs() -> KindRun:
    from lab_sledge.runs import RUNS

    return RUNS


def _served() -> ServedKind:
    from lab_sledge.runs import SERVED

    return SERVED


def _recipe() -> RecipePart:
    from lab_sledge.recipe import PART

    return PART


KIND = Kind(
    name="sledge",
    title="sledge on a plate, pulled through a spring",
    rigs={"sledge": "lab_sledge:rig.yaml"},
    rig=_rig,
    interlocks=_interlocks,
    page="README.md",
    runs=_runs,
    served=_served,
    recipe=_recipe,
)
