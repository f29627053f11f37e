"""Temperatures: the chamber's air, the thermometer beside the rig, the pyrometer at the contact."""

from __future__ import annotations

from math import inf, isfinite
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import Row, TrackInputs
from tester.machine.row import ACK, CONTROLLED, Compared, Interlock
from tester.machine.watches import at_most, condition, within
from tester.machine.wires import answered_s

STALE_AIR_S: Final = Parameter(
    "stale_air_s", "s", "2.5 s", "age of the air's temperature: five polls [A]",
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip
STALE_EXIT_S: Final = Parameter(
    "stale_exit_s", "s", "2 s", "age of the pyrometer's temperature [A]",
    hardest="10 s", because="it is recorded, and controls nothing: older data do not describe the present contact",
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


AIR_SILENT: Final[Row] = Interlock(
    name="air silent",
    cause="chamber or thermometer does not answer: the temperature of the specimen is unknown",
    watch=at_most("age > {}", _air_s, STALE_AIR_S),
    applies=lambda v: v.limits.air and not v.attended,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

EXIT_SILENT: Final[Row] = Interlock(
    name="pyrometer silent",
    cause="the pyrometer does not answer",
    watch=at_most("age > {}", _exit_s, STALE_EXIT_S),
    applies=lambda v: v.limits.exit and not v.attended,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

BROKEN_DELAY_S: Final = Parameter(
    "broken_delay_s", "s", "1 s", "a temperature that its device denies, for this long [A]", NOT_NEGATIVE,
    hardest="5 s", because="a chamber with a broken sensor goes to standby by itself; in 5 s its air changes by 0.3 K",
)  # fmt: skip

AIR_BROKEN: Final[Row] = Interlock(
    name="air sensor broken",
    cause="the sensor of the air is open",
    watch=condition(
        "reading denied by its device", lambda v: not (v.readings.air_valid and isfinite(v.readings.air_c))
    ),
    applies=lambda v: v.limits.air and not v.attended and not v.readings.air_silent,
    delay=BROKEN_DELAY_S,
    reaction=CONTROLLED,
)

RANGE_K: Final = Parameter(
    "range_k", "K", "2 K", "the chamber's air beyond limits.air_low or air_high by this ... [A]",
    hardest="4 K", because="the chamber's own limiter acts 5 K beyond; 10 K beyond specimen and cell are spoilt",
)  # fmt: skip
RANGE_DELAY_S: Final = Parameter(
    "range_delay_s", "s", "2 s", "... for this long [A]", NOT_NEGATIVE,
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip


def _air_range(v: TrackInputs) -> tuple[float, float, float]:
    far = v.parameters[RANGE_K]
    return v.limits.air_low_c - far, v.readings.air_c, v.limits.air_high_c + far


OUT_OF_RANGE: Final[Row] = Interlock(
    name="chamber beyond its range",
    cause="the chamber is hotter or colder than it may be",
    watch=within("air beyond limits.air_low or limits.air_high by range", _air_range, "degC"),
    parameters=(RANGE_K,),
    applies=lambda v: v.limits.chamber and v.readings.air_valid,
    delay=RANGE_DELAY_S,
    ends_lease=True,
    reset=ACK,
)

RUNAWAY_K: Final = Parameter(
    "runaway_k", "K", "10 K", "air off a setpoint that it has been at, by this ... [A]",
    hardest="15 K", because="a chamber that has lost its loop continues at 3.6 K a minute",
)  # fmt: skip
RUNAWAY_DELAY_S: Final = Parameter(
    "runaway_delay_s", "s", "2 s", "... for this long [A]", NOT_NEGATIVE,
    hardest="10 s", because="at full output the air changes by 0.6 K in 10 s",
)  # fmt: skip

RUNAWAY: Final[Row] = Interlock(
    name="chamber runaway",
    cause="the chamber leaves its setpoint: output stuck, door open",
    watch=at_most(
        "air off the setpoint by {} after it was there", lambda v: abs(v.readings.air_c - v.arrived_c), RUNAWAY_K
    ),
    applies=lambda v: v.arrived_c != inf and v.readings.air_valid,
    delay=RUNAWAY_DELAY_S,
    ends_lease=True,
    reaction=CONTROLLED,
)

FROZEN_AIR_S: Final = Parameter(
    "frozen_air_s", "s", "120 s", "so much full output, or more output than usual, has not moved the air by 0.3 K [A]",
    hardest="240 s", because="from 23 degC full output gains 14 K in that time",
)  # fmt: skip

AIR_FROZEN: Final[Row] = Interlock(
    name="air sensor frozen",
    cause="the chamber heats or cools, and its sensor shows no effect",
    watch=at_most("air unchanged by {} of full output, or as much beyond the usual", lambda v: v.unanswered_s,
                  FROZEN_AIR_S),
    applies=lambda v: v.full_c < inf,
    ends_lease=True,
    reaction=CONTROLLED,
)

ALARM_DELAY_S: Final = Parameter(
    "alarm_delay_s", "s", "1500 ms", "the chamber reports it in more than two polls [A]", NOT_NEGATIVE,
    hardest="5 s", because="it is in standby already: nothing gets worse meanwhile",
)  # fmt: skip
CHAMBER_ALARM: Final[Row] = Interlock(
    name="chamber alarm",
    cause="the chamber has gone to standby by itself: its own limiter, or it misses our setpoint",
    watch=condition("its alarm word, while it is to run", lambda v: v.readings.chamber_alarm),
    applies=lambda v: v.setpoints.chamber,
    unseen=True,
    delay=ALARM_DELAY_S,
    reaction=CONTROLLED,
)

CHAMBER_OFF_S: Final = Parameter(
    "chamber_off_s", "s", "3 s", "in standby the chamber gives no output after this [A]: six polls",
    hardest="30 s", because="30 s is its lease: later it would have ended by itself",
)  # fmt: skip


def _still_on(v: TrackInputs) -> bool:
    return v.off_since_s < inf and not (v.readings.now_s - v.off_since_s <= v.parameters[CHAMBER_OFF_S])


CHAMBER_NOT_OFF: Final[Row] = Interlock(
    name="chamber not off",
    cause="the chamber heats or cools although it should be in standby",
    watch=condition("output after chamber_off", _still_on, lambda v: Compared(v.readings.chamber_percent, 0.0, "%")),
    parameters=(CHAMBER_OFF_S,),
    ends_lease=True,
    reaction=CONTROLLED,
)

ROWS: Final[tuple[Row, ...]] = (
    OUT_OF_RANGE, RUNAWAY, AIR_FROZEN, AIR_SILENT, AIR_BROKEN, CHAMBER_ALARM, CHAMBER_NOT_OFF, EXIT_SILENT,
)  # fmt: skip
