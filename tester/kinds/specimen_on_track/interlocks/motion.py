"""Track and arm: age of their data, the track's speed and travel, the arm's place."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import STANDING_SHARE, Row, TrackInputs, standing_m_s
from tester.machine.drive_rows import DRIVE_DATA_STALE, drive_dropped_out
from tester.machine.row import ACK, CONTROLLED, Compared, Interlock
from tester.machine.watches import at_most, condition, within
from tester.machine.wires import INPUTS_STALE

DROPPED_DELAY_S: Final = Parameter(
    "dropped_delay_s", "s", "50 ms", "a drive leaves operation by itself [A]", NOT_NEGATIVE,
    hardest="200 ms", because="the other drive continues meanwhile: 200 ms is what a drive takes to miss our heartbeat",
)  # fmt: skip


DRIVE_DROPPED_OUT: Final = drive_dropped_out(DROPPED_DELAY_S)

OVERSPEED_SHARE: Final = Parameter(
    "overspeed_share", "1", "5 %", "the track above limits.track_speed by this share [A]", NOT_NEGATIVE,
    hardest="10 %", because="a tenth more speed is a tenth more way that a stop takes before the end of the travel",
)  # fmt: skip
OVERSPEED_DELAY_S: Final = Parameter(
    "overspeed_delay_s", "s", "50 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="200 ms",
    because="at 10 mm/s the track goes 2 mm in 200 ms; 10 mm are left beyond the soft end of its travel",
)  # fmt: skip


def _speed_m_s(v: TrackInputs) -> float:
    return abs(v.readings.track_now_m_s)


OVERSPEED: Final[Row] = Interlock(
    name="overspeed",
    cause="the track is faster than it may be",
    watch=at_most(
        "speed > limits.track_speed + overspeed_share",
        _speed_m_s,
        lambda v: v.limits.track_m_s * (1.0 + v.parameters[OVERSPEED_SHARE]),
        "m/s",
    ),
    parameters=(OVERSPEED_SHARE,),
    applies=lambda v: not v.readings.drives_disabled,
    delay=OVERSPEED_DELAY_S,
    reset=ACK,
)

SPEED_SHARE: Final = Parameter(
    "speed_share", "1", "0.3", "way of a second off what is commanded by this share of it ... [A]", SHARE,
    hardest="0.5", because="at half the way the friction recorded for a speed is that of another one",
)  # fmt: skip
SPEED_FLOOR: Final = Parameter(
    "speed_floor", "1", "0.00002", "... and this share of axes.track.max_speed, times a second [A] ...", SHARE,
    hardest="0.0001", because="1 um/s is a ten-thousandth of 10 mm/s: a track at rest instead would pass",
)  # fmt: skip
SPEED_DELAY_S: Final = Parameter(
    "speed_delay_s", "s", "200 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="500 ms",
    because="a runaway at 10 mm/s goes 5 mm in half a second; 10 mm are left beyond the soft end of the travel",
)  # fmt: skip


def _allowed_m(v: TrackInputs) -> float:
    return v.track.allowed_m(v.parameters[SPEED_SHARE], v.parameters[SPEED_FLOOR] * v.limits.fastest_m_s)


TRACK_SPEED: Final[Row] = Interlock(
    name="track speed",
    cause="the track does not follow its command: stalled, slipping, running away, wrong scale",
    watch=at_most(
        "way of the last second off its command by > speed_share and speed_floor",
        lambda v: abs(v.track.off_m),
        _allowed_m,
        "m",
    ),
    parameters=(SPEED_SHARE, SPEED_FLOOR),
    applies=lambda v: v.confirmed,
    delay=SPEED_DELAY_S,
    reset=ACK,
)

BEYOND_MM: Final = Parameter(
    "beyond_mm", "mm", "2 mm", "a linear track this far beyond limits.travel [A]", NOT_NEGATIVE,
    hardest="5 mm", because="the end switches open 10 mm beyond the soft ends, the stops stand 5 mm behind them",
)  # fmt: skip


def _travel_mm(v: TrackInputs) -> tuple[float, float, float]:
    far = v.parameters[BEYOND_MM]
    return v.limits.low_mm - far, v.readings.track_mm, v.limits.high_mm + far


END_OF_TRAVEL: Final[Row] = Interlock(
    name="end of travel",
    cause="the track is beyond the soft end of its travel, where it is never sent",
    watch=within("a linear track beyond limits.travel by beyond", _travel_mm, "mm"),
    parameters=(BEYOND_MM,),
    applies=lambda v: not v.readings.drives_disabled and v.limits.high_mm != inf,
    reset=ACK,
)


def _arm_wrong(v: TrackInputs) -> bool:
    r = v.readings
    if not v.confirmed or r.raised or (r.lowered and v.demand.tared):
        return False
    return not (_speed_m_s(v) < standing_m_s(v))


ARM_WRONG: Final[Row] = Interlock(
    name="arm not in place",
    cause="the track moves while the arm is on its way, or down before the tare",
    watch=condition(
        "speed >= standing_share, arm neither raised nor lowered with a cell that is tared",
        _arm_wrong,
        lambda v: Compared(_speed_m_s(v), standing_m_s(v), "m/s"),
    ),
    parameters=(STANDING_SHARE,),
    reset=ACK,
)

ARM_LATE_S: Final = Parameter(
    "arm_late_s", "s", "3.5 s", "the arm is not where it was sent after this long [A]: 10 mm take 1.2 s",
    hardest="5 s", because="three times the time of the move: an arm that is not there by then does not come",
)  # fmt: skip

ARM_LATE: Final[Row] = Interlock(
    name="arm stuck",
    cause="the arm does not arrive: lift jammed, or something in its way",
    watch=at_most("arm off where it was sent for {}", lambda v: v.readings.now_s - v.arm_since_s, ARM_LATE_S),
    applies=lambda v: v.arm_since_s < inf,
    reaction=CONTROLLED,
)

ROWS: Final[tuple[Row, ...]] = (
    DRIVE_DATA_STALE, INPUTS_STALE, DRIVE_DROPPED_OUT, ARM_WRONG, OVERSPEED, END_OF_TRAVEL, TRACK_SPEED, ARM_LATE,
)  # fmt: skip
