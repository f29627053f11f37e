"""Temperatures: the chamber's air, the thermometer beside the rig, the pyrometer at the contact."""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs
from tester.machine.row import ACK, CONTROLLED, FAST, REPAIR, Compared, Interlock
from tester.machine.wires import answered_s

STALE_AIR_S: Final = Parameter(
    "stale_air_s", "s", "2.5 s", "age of the air's temperature: five polls [A]",
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip
STALE_EXIT_S: Final = Parameter(
    "stale_exit_s", "s", "2 s", "age of the pyrometer's temperature [A]",
    hardest="10 s", because="it is recorded and not controlled by: what is older says nothing of the present contact",
)  # fmt: skip
STALE_DELAY_S: Final = Parameter(
    "stale_delay_s", "s", "200 ms", "for both [A]", NOT_NEGATIVE,
    hardest="1 s", because="one reply may be lost; no more",
)  # fmt: skip


def _air_s(v: TrackInputs) -> float:
    r = v.readings
    return answered_s(r.air_silent, r.now_s, r.air_at_s)


def _exit_s(v: TrackInputs) -> float:
    r = v.readings
    return answered_s(r.exit_silent, r.now_s, r.exit_at_s)


AIR_SILENT: Final = Interlock(
    name="air silent",
    cause="chamber or thermometer does not answer: nobody knows the temperature of the specimen",
    level="age > stale_air",
    condition=lambda v: v.limits.air and not v.attended and not (_air_s(v) <= v.parameters[STALE_AIR_S]),
    compared=lambda v: Compared(_air_s(v), v.parameters[STALE_AIR_S], "s"),
    parameters=(STALE_AIR_S,),
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

EXIT_SILENT: Final = Interlock(
    name="pyrometer silent",
    cause="the pyrometer does not answer",
    level="age > stale_exit",
    condition=lambda v: v.limits.exit and not v.attended and not (_exit_s(v) <= v.parameters[STALE_EXIT_S]),
    compared=lambda v: Compared(_exit_s(v), v.parameters[STALE_EXIT_S], "s"),
    parameters=(STALE_EXIT_S,),
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

BROKEN_DELAY_S: Final = Parameter(
    "broken_delay_s", "s", "1 s", "a temperature that its device denies, for this long [A]", NOT_NEGATIVE,
    hardest="5 s", because="a chamber with a broken sensor stands by on its own; in 5 s its air changes by 0.3 K",
)  # fmt: skip


def _broken(v: TrackInputs) -> bool:
    r = v.readings
    return v.limits.air and not v.attended and not r.air_silent and not (r.air_valid and isfinite(r.air_c))


AIR_BROKEN: Final = Interlock(
    name="air sensor broken",
    cause="the sensor of the air is open",
    level="reading denied by its device",
    condition=_broken,
    delay=BROKEN_DELAY_S,
    reaction=CONTROLLED,
    reset=REPAIR,
)

RANGE_K: Final = Parameter(
    "range_k", "K", "2 K", "the chamber's air beyond limits.air_low or air_high by this ... [A]",
    hardest="4 K", because="the chamber's own limiter stands by 5 K beyond; 10 K beyond specimen and cell are spoilt",
)  # fmt: skip
RANGE_DELAY_S: Final = Parameter(
    "range_delay_s", "s", "2 s", "... for this long [A]", NOT_NEGATIVE,
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip


def _out_of_range(v: TrackInputs) -> bool:
    far, r = v.parameters[RANGE_K], v.readings
    if not (v.limits.chamber and r.air_valid):
        return False
    return not (v.limits.air_low_c - far <= r.air_c <= v.limits.air_high_c + far)


def _beyond(v: TrackInputs) -> Compared:
    far, air_c = v.parameters[RANGE_K], v.readings.air_c
    limit = v.limits.air_low_c - far if air_c < v.limits.air_low_c else v.limits.air_high_c + far
    return Compared(air_c, limit, "degC")


OUT_OF_RANGE: Final = Interlock(
    name="chamber beyond its range",
    cause="the chamber is hotter or colder than it may be",
    level="air beyond limits.air_low or limits.air_high by range",
    condition=_out_of_range,
    compared=_beyond,
    parameters=(RANGE_K,),
    delay=RANGE_DELAY_S,
    ends_lease=True,
    reaction=FAST,
    reset=ACK,
)

RUNAWAY_K: Final = Parameter(
    "runaway_k", "K", "10 K", "air off a setpoint that it has been at, by this ... [A]",
    hardest="15 K", because="a chamber that has lost its loop goes on at 3.6 K a minute",
)  # fmt: skip
RUNAWAY_DELAY_S: Final = Parameter(
    "runaway_delay_s", "s", "2 s", "... for this long [A]", NOT_NEGATIVE,
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip


def _runaway(v: TrackInputs) -> bool:
    if v.arrived_c == float("inf") or not v.readings.air_valid:
        return False
    return not (abs(v.readings.air_c - v.arrived_c) <= v.parameters[RUNAWAY_K])


RUNAWAY: Final = Interlock(
    name="chamber runaway",
    cause="the chamber leaves its setpoint: output stuck, door open",
    level="air off the setpoint by runaway after it was there",
    condition=_runaway,
    compared=lambda v: Compared(abs(v.readings.air_c - v.arrived_c), v.parameters[RUNAWAY_K], "K"),
    parameters=(RUNAWAY_K,),
    delay=RUNAWAY_DELAY_S,
    ends_lease=True,
    reaction=CONTROLLED,
    reset=REPAIR,
)

ALARM_DELAY_S: Final = Parameter(
    "alarm_delay_s", "s", "1500 ms", "the chamber says so in more than two polls [A]", NOT_NEGATIVE,
    hardest="5 s", because="it has stood by already: nothing gets worse meanwhile",
)  # fmt: skip
CHAMBER_ALARM: Final = Interlock(
    name="chamber alarm",
    cause="the chamber has stood by itself: its own limiter, or it misses our setpoint",
    level="its alarm word, while it is to run",
    condition=lambda v: v.setpoints.chamber and v.readings.chamber_alarm,
    unseen=lambda v: v.limits.chamber and v.readings.chamber_alarm,
    delay=ALARM_DELAY_S,
    reaction=CONTROLLED,
    reset=REPAIR,
)

CHAMBER_OFF_S: Final = Parameter(
    "chamber_off_s", "s", "3 s", "told to stand by, the chamber gives no output after this [A]: six polls",
    hardest="30 s", because="30 s is its lease: later it would have ended by itself",
)  # fmt: skip


def _still_on(v: TrackInputs) -> bool:
    return v.off_since_s < float("inf") and not (v.readings.now_s - v.off_since_s <= v.parameters[CHAMBER_OFF_S])


CHAMBER_NOT_OFF: Final = Interlock(
    name="chamber not off",
    cause="the chamber heats or cools although it is to stand by",
    level="output after chamber_off",
    condition=_still_on,
    compared=lambda v: Compared(v.readings.chamber_percent, 0.0, "%"),
    parameters=(CHAMBER_OFF_S,),
    ends_lease=True,
    reaction=CONTROLLED,
    reset=REPAIR,
)

ROWS: Final[tuple[Interlock, ...]] = (
    OUT_OF_RANGE, RUNAWAY, AIR_SILENT, AIR_BROKEN, CHAMBER_ALARM, CHAMBER_NOT_OFF, EXIT_SILENT,
)  # fmt: skip
