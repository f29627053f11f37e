"""The wheel on a belt with one interlock more: the rubber is hotter than its hub by more than friction makes it."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from tester.inputs.rig.ceilings import ceilings_of
from tester.inputs.rig.config import section_of
from tester.inputs.rig.parameter import Parameter
from tester.kinds import wheel_on_belt
from tester.kinds.wheel_on_belt.interlocks import operation
from tester.kinds.wheel_on_belt.interlocks.inputs import Row
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.kinds.wheel_on_belt.rig.wheel_rig import RigConfig
from tester.machine.interlock_table import SECTION, InterlockSheet, InterlockTable
from tester.machine.row import ACK, CONTROLLED, Interlock
from tester.machine.watches import at_most

FAULT = "thermometer drift 2 K/s"
"""Trips it first: a line of a fault script, behind the time at which it begins."""
EXCESS_K = Parameter(
    "surface_excess_k", "K", "8 K", "the rubber hotter than its hub by this: friction makes a few kelvin [A]",
    hardest="30 K", because="at limits.surface a hub that cold says that nothing heats but friction",
)  # fmt: skip


HOTTER_THAN_HUB: Row = Interlock(
    name="rubber hotter than hub",
    cause="rubber far hotter than its hub: thermometer wrong, or far too much friction",
    watch=at_most("surface - hub > {}", lambda v: v.readings.surface_c - v.readings.hub_c, EXCESS_K),
    applies=lambda v: v.readings.surface_valid and v.readings.jacket_valid,
    reaction=CONTROLLED,
    reset=ACK,
)
ROWS = InterlockTable((HOTTER_THAN_HUB, *TABLE.rows), operation.PARAMETERS)
Section: Any = section_of("Section", ROWS.parameters, __name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class LabRig(RigConfig):
    """The wheel's rig file, with the parameter of the row."""

    table: ClassVar[InterlockTable] = ROWS
    parameters: ClassVar[tuple[Parameter, ...]] = ROWS.parameters
    ceilings: ClassVar = (*RigConfig.ceilings, *ceilings_of(SECTION, (EXCESS_K,)))
    interlocks: Section


KIND = replace(
    wheel_on_belt.KIND,
    name="lab_wheel:KIND",
    title="rubber wheel on a belt, watched against its hub",
    rigs={},
    rig=lambda: LabRig,
    interlocks=lambda: InterlockSheet(ROWS.rows, operation.PARAMETERS, operation.ABOUT),
)
