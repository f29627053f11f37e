"""Second witnesses of the force: the torque of the press's drive, and the press's own movement."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs, Row
from tester.machine.row import LOADED, Interlock
from tester.machine.watches import at_most, within

FORCE_STEP_N: Final = Parameter(
    "force_step_n", "N", "14 N",
    "force changes by this in 0.1 s without the press: runout makes 7 N at 400 N [A]",
    hardest="30 N", because="400 N, 30 N and what the press brings until it stops stay below 500 N",
)  # fmt: skip
FORCE_STEP_UNSEEN_SHARE: Final = Parameter(
    "force_step_unseen_share", "1", "0.3",
    "... and this share of what the press does, at a stiffness not seen yet [A] ...", SHARE,
    hardest="0.5", because="rubber differs from loops.load.stiffness by a third: more hides a step while loading",
)  # fmt: skip
FORCE_STEP_SEEN_SHARE: Final = Parameter(
    "force_step_seen_share", "1", "0.15", "... or, once it was seen in this contact, this one [A] ...", SHARE,
    hardest="0.3", because="loading at 2 mm/s changes 400 N by 34 N in 0.1 s: a third of that is 11 N",
)  # fmt: skip
FORCE_STEP_CROSS_SHARE: Final = Parameter(
    "force_step_cross_share", "1", "0.015",
    "... and of the change of Fx: the cell's cross-talk and 0.5 deg of misalignment [A]", SHARE,
    hardest="0.03", because="friction changes by 600 N at most: 18 N",
)  # fmt: skip
FORCE_STEP_DELAY_S: Final = Parameter(
    "force_step_delay_s", "s", "30 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="80 ms", because="a step stays in the comparison for 100 ms",
)  # fmt: skip

FORCE_STEP: Final[Row] = Interlock(
    name="force step",
    cause="the force has changed without the press: load cell, its amplifier, or the rubber",
    watch=at_most(
        "change of Fz in 0.1 s off what press and Fx explain by > {} (and shares of both)",
        lambda v: v.force.off_n,
        FORCE_STEP_N,
    ),
    parameters=(FORCE_STEP_UNSEEN_SHARE, FORCE_STEP_SEEN_SHARE, FORCE_STEP_CROSS_SHARE),
    applies=lambda v: v.pressing,
    delay=FORCE_STEP_DELAY_S,
    when=LOADED,
)

TORQUE_MARGIN_N: Final = Parameter(
    "press_torque_margin_n", "N", "20 N",
    "Fz outside what the press's torque and screw can mean, by this [A] ...",
    hardest="40 N", because="at the torque's limit 440 N or more press: a cell that shows less than 400 N trips",
)  # fmt: skip
TORQUE_DELAY_S: Final = Parameter(
    "press_torque_delay_s", "s", "100 ms",
    "... for this long: acceleration, and torque and force read at two times [A]",
    NOT_NEGATIVE, hardest="300 ms",
    because="the press's torque has a limit that keeps the force below 500 N: a trip in time is the test",
)  # fmt: skip


def _torque_allows_n(v: Inputs) -> tuple[float, float, float]:
    band, margin, r = v.press_band, v.parameters[TORQUE_MARGIN_N], v.readings
    least_n, most_n = band.least_n(r.press_torque_nm, r.press_mm), band.most_n(r.press_torque_nm, r.press_mm)
    return least_n - margin, r.force_z_n, most_n + margin


PRESS_TORQUE: Final[Row] = Interlock(
    name="press torque",
    cause="the load cell denies the press's torque: its gain, zero or channels, or the press's screw",
    watch=within("Fz off the range that the press's torque allows by > press_torque_margin", _torque_allows_n, "N"),
    parameters=(TORQUE_MARGIN_N,),
    applies=lambda v: v.confirmed and v.press_band.known,
    delay=TORQUE_DELAY_S,
    when=LOADED,
)

PRESS_SPRING_SHARE: Final = Parameter(
    "press_spring_share", "1", "5 %",
    "in free travel the press's torque, mean of both ways, off that of its spring [A]", SHARE,
    hardest="5 %",
    because="with 0x6077's digit the cell's supply may be 12 % low: 430 N are 489 N then, and harm begins at 500 N",
)  # fmt: skip

PRESS_SPRING: Final[Row] = Interlock(
    name="press spring",
    cause="the press's torque is not its lifting spring's: its gain or zero, perhaps with the load cell's, or"
    " screw.spring",
    watch=at_most(
        "in free travel the press's torque, mean of both ways, off that of the screw's spring by > {}",
        lambda v: v.free.off_share,
        PRESS_SPRING_SHARE,
    ),
    applies=lambda v: v.confirmed,
    when=LOADED,
)  # fmt: skip

ROWS: Final[tuple[Row, ...]] = (FORCE_STEP, PRESS_TORQUE, PRESS_SPRING)
