"""Track and arm: their data, the track's speed and travel, the arm's place."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs
from tester.kinds.specimen_on_track.interlocks.known import STANDING_SHARE, standing_m_s
from tester.machine.drive_rows import drive_data_stale, drive_dropped_out
from tester.machine.row import ACK, CONTROLLED, FAST, REPAIR, Compared, Interlock
from tester.machine.wires import INPUTS_STALE

DRIVE_DATA_STALE: Final = drive_data_stale(lambda r: (r.track_at_s, r.lift_at_s))

DROPPED_DELAY_S: Final = Parameter(
    "dropped_delay_s", "s", "50 ms", "a drive leaves operation by itself [A]", NOT_NEGATIVE,
    hardest="200 ms", because="the other drive goes on meanwhile: 200 ms is what a drive takes to miss our heartbeat",
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


def _too_fast(v: TrackInputs) -> bool:
    most = v.limits.track_m_s * (1.0 + v.parameters[OVERSPEED_SHARE])
    return not v.readings.drives_disabled and not (-most <= v.readings.track_now_m_s <= most)


OVERSPEED: Final = Interlock(
    name="overspeed",
    cause="the track is faster than it may be",
    level="speed > limits.track_speed + overspeed_share",
    condition=_too_fast,
    compared=lambda v: Compared(
        abs(v.readings.track_now_m_s), v.limits.track_m_s * (1.0 + v.parameters[OVERSPEED_SHARE]), "m/s"
    ),
    parameters=(OVERSPEED_SHARE,),
    delay=OVERSPEED_DELAY_S,
    reaction=FAST,
    reset=ACK,
)

SPEED_SHARE: Final = Parameter(
    "speed_share", "1", "0.3", "way of a second off what is commanded by this share of it ... [A]", SHARE,
    hardest="0.5", because="at half the way the friction that is told for a speed is that of another one",
)  # fmt: skip
SPEED_FLOOR: Final = Parameter(
    "speed_floor", "1", "0.00002", "... and this share of axes.track.max_speed, times a second [A] ...", SHARE,
    hardest="0.0001", because="1 um/s is a ten-thousandth of 10 mm/s: a track that stands instead would pass",
)  # fmt: skip
SPEED_DELAY_S: Final = Parameter(
    "speed_delay_s", "s", "200 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="500 ms",
    because="a runaway at 10 mm/s goes 5 mm in half a second; 10 mm are left beyond the soft end of the travel",
)  # fmt: skip


def _allowed_m(v: TrackInputs) -> float:
    return v.track.allowed_m(v.parameters[SPEED_SHARE], v.parameters[SPEED_FLOOR] * v.limits.fastest_m_s)


def _off_its_way(v: TrackInputs) -> bool:
    return v.confirmed and not (abs(v.track.off_m) <= _allowed_m(v))


TRACK_SPEED: Final = Interlock(
    name="track speed",
    cause="the track does not go as it is told: stalled, slipping, running away, wrong scale",
    level="way of the last second off its command by > speed_share and speed_floor",
    condition=_off_its_way,
    compared=lambda v: Compared(abs(v.track.off_m), _allowed_m(v), "m"),
    parameters=(SPEED_SHARE, SPEED_FLOOR),
    delay=SPEED_DELAY_S,
    reaction=FAST,
    reset=ACK,
)

BEYOND_MM: Final = Parameter(
    "beyond_mm", "mm", "2 mm", "a linear track this far beyond limits.travel [A]", NOT_NEGATIVE,
    hardest="5 mm", because="the end switches open 10 mm beyond the soft ends, the stops stand 5 mm behind them",
)  # fmt: skip


def _beyond_travel(v: TrackInputs) -> bool:
    r, far = v.readings, v.parameters[BEYOND_MM]
    if r.drives_disabled or v.limits.high_mm == float("inf"):
        return False
    return not (v.limits.low_mm - far <= r.track_mm <= v.limits.high_mm + far)


def _beyond_end(v: TrackInputs) -> Compared:
    r, far = v.readings, v.parameters[BEYOND_MM]
    low = r.track_mm < v.limits.low_mm
    return Compared(r.track_mm, v.limits.low_mm - far if low else v.limits.high_mm + far, "mm")


END_OF_TRAVEL: Final = Interlock(
    name="end of travel",
    cause="the track is beyond the soft end of its travel, where it is never sent",
    level="a linear track beyond limits.travel by beyond",
    condition=_beyond_travel,
    compared=_beyond_end,
    parameters=(BEYOND_MM,),
    reaction=FAST,
    reset=ACK,
)


def _arm_wrong(v: TrackInputs) -> bool:
    r, slow = v.readings, standing_m_s(v)
    if not v.confirmed or r.raised or (r.lowered and v.demand.tared):
        return False
    return not (-slow < r.track_now_m_s < slow)


ARM_WRONG: Final = Interlock(
    name="arm not in place",
    cause="the track moves while the arm is on its way, or down before the tare",
    level="speed >= standing_share, arm neither raised nor lowered with a cell that is tared",
    condition=_arm_wrong,
    compared=lambda v: Compared(abs(v.readings.track_now_m_s), standing_m_s(v), "m/s"),
    parameters=(STANDING_SHARE,),
    reaction=FAST,
    reset=ACK,
)

ARM_LATE_S: Final = Parameter(
    "arm_late_s", "s", "3.5 s", "the arm is not where it was sent after this long [A]: 10 mm take 1.2 s",
    hardest="5 s", because="three times as long as the way takes: what is not there by then does not come",
)  # fmt: skip


def _arm_late(v: TrackInputs) -> bool:
    return not (v.readings.now_s - v.arm_since_s <= v.parameters[ARM_LATE_S]) and v.arm_since_s < float("inf")


ARM_LATE: Final = Interlock(
    name="arm stuck",
    cause="the arm does not arrive: lift jammed, or something in its way",
    level="arm off where it was sent for arm_late",
    condition=_arm_late,
    compared=lambda v: Compared(v.readings.now_s - v.arm_since_s, v.parameters[ARM_LATE_S], "s"),
    parameters=(ARM_LATE_S,),
    reaction=CONTROLLED,
    reset=REPAIR,
)

ROWS: Final[tuple[Interlock, ...]] = (
    DRIVE_DATA_STALE, INPUTS_STALE, DRIVE_DROPPED_OUT, ARM_WRONG, OVERSPEED, END_OF_TRAVEL, TRACK_SPEED, ARM_LATE,
)  # fmt: skip
