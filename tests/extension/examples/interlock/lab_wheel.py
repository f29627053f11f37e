"""The wheel on a belt with one interlock more: the rubber is hotter than its hub by more than friction makes it."""

from tester.inputs.rig.parameter import Parameter
from tester.kinds import wheel_on_belt
from tester.kinds.wheel_on_belt.interlocks.inputs import Row
from tester.machine.row import ACK, CONTROLLED, Interlock
from tester.machine.watches import at_most

FAULT = "thermometer drift 2 K/s"
"""Trips it first: a line of a fault script, behind the time at which it begins."""
EXCESS_K = Parameter(
    "surface_excess_k", "K", "8 K", "the rubber hotter than its hub by this: friction makes a few kelvin [A]",
    hardest="30 K", because="at limits.surface a hub that cold shows that nothing heats but friction",
)  # fmt: skip
HOTTER_THAN_HUB: Row = Interlock(
    name="rubber hotter than hub",
    cause="rubber far hotter than its hub: thermometer wrong, or far too much friction",
    watch=at_most("surface - hub > {}", lambda v: v.readings.surface_c - v.readings.hub_c, EXCESS_K),
    applies=lambda v: v.readings.surface_valid and v.readings.jacket_valid,
    reaction=CONTROLLED,
    reset=ACK,
)
TITLE = "rubber wheel on a belt, watched against its hub"
KIND = wheel_on_belt.KIND.extended("lab_wheel:KIND", TITLE, rows=[HOTTER_THAN_HUB])
