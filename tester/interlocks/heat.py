"""Heat: the hub and its heater, the rubber's surface and its thermometer."""

from __future__ import annotations

from math import inf, nan
from typing import Final

from tester.interlocks.inputs import Inputs
from tester.interlocks.parameter import NOT_NEGATIVE, Direction, Parameter
from tester.interlocks.row import ACK, CONTROLLED, REPAIR, Compared, Interlock, always

_INF: Final = inf

SURFACE_DELAY_S: Final = Parameter(
    "surface_delay_s", "s", "500 ms", "rubber above limits.surface [A]", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="2 s",
    because="35 K are left from limits.surface to harm, and a burst is over after some seconds [A]",
)  # fmt: skip


def _surface_hot(v: Inputs) -> bool:
    r = v.readings
    return r.surface_valid and not (r.surface_c <= v.limits.surface_c)


SURFACE_HOT: Final = Interlock(
    name="surface hot",
    cause="rubber surface above its limit",
    level="surface > limits.surface",
    condition=_surface_hot,
    compared=lambda v: Compared(v.readings.surface_c, v.limits.surface_c, "degC"),
    delay=SURFACE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

JACKET_MARGIN_K: Final = Parameter(
    "jacket_margin_k", "K", "3 K", "the hub may overshoot limits.jacket by this; 155 degC is harm [A]", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="4 K",
    because="150 degC and 4 K leave 1 K: what 200 W heat a hub of 420 J/K in two seconds",
)  # fmt: skip
JACKET_DELAY_S: Final = Parameter(
    "jacket_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="2 s",
    because="200 W heat a hub of 420 J/K by 1 K in two seconds; above limits.jacket and its margin 2 K are left",
)  # fmt: skip


def _hub_hot(v: Inputs) -> bool:
    r = v.readings
    return r.jacket_valid and not (r.hub_c <= v.limits.jacket_c + v.parameters[JACKET_MARGIN_K])


JACKET_HOT: Final = Interlock(
    name="jacket hot",
    cause="hub above its limit",
    level="hub > limits.jacket + jacket_margin",
    condition=_hub_hot,
    compared=lambda v: Compared(v.readings.hub_c, v.limits.jacket_c + v.parameters[JACKET_MARGIN_K], "degC"),
    parameters=(JACKET_MARGIN_K,),
    delay=JACKET_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

RUNAWAY_K: Final = Parameter(
    "runaway_k", "K", "8 K", "hub above every setpoint of runaway_window by this",
    direction=Direction.LOWER, hardest="15 K",
    because="three times the overshoot of a jacket controller that is tuned [A]",
)  # fmt: skip
RUNAWAY_WINDOW_S: Final = Parameter(
    "runaway_window_s", "s", "10 min", "how far back setpoints count: a hub cools more slowly than it heats [A]",
    direction=Direction.LOWER, hardest="30 min",
    because="a hub at 112 degC cools to 45 degC in half an hour: an older setpoint says nothing of it",
)  # fmt: skip
RUNAWAY_DELAY_S: Final = Parameter(
    "runaway_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="10 s",
    because="200 W heat a hub of 420 J/K by 5 K in that time",
)  # fmt: skip


def _highest_c(v: Inputs) -> float:
    """Return what the hub may be by its setpoints: the highest of those that count."""
    r, setpoints = v.readings, v.hub_setpoints
    # A hub that was hot takes longer to cool than the window is: without output it must not get hotter again,
    # except by a rubber that friction has made hotter than itself.
    coolest = v.jacket.coolest_c
    highest = max(setpoints[0][1], v.limits.hub_min_c, coolest)
    if coolest > -_INF and r.surface_valid and r.surface_c > highest:
        highest = r.surface_c
    return highest


def _hub_above_setpoints(v: Inputs) -> bool:
    r = v.readings
    if v.attended or not r.jacket_valid or not v.hub_setpoints:
        return False
    return not (r.hub_c <= _highest_c(v) + v.parameters[RUNAWAY_K])


JACKET_RUNAWAY: Final = Interlock(
    name="jacket runaway",
    cause="hub above every setpoint of the last ten minutes",
    level="hub > highest setpoint in runaway_window + runaway; without output: > coolest since, or rubber, + runaway",
    condition=_hub_above_setpoints,
    compared=lambda v: Compared(v.readings.hub_c, _highest_c(v) + v.parameters[RUNAWAY_K], "degC"),
    parameters=(RUNAWAY_K, RUNAWAY_WINDOW_S),
    delay=RUNAWAY_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

STUCK_RATE_K_S: Final = Parameter(
    "stuck_rate_k_s", "K/s", "0.05 K/s", "the hub rises faster than this ...",
    direction=Direction.LOWER, hardest="0.2 K/s",
    because="full output, 200 W at 420 J/K, makes 0.48 K/s: less than half of it must be told",
)  # fmt: skip
STUCK_OFF_S: Final = Parameter(
    "stuck_off_s", "s", "5 s", "... with no output for this long ...", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="20 s",
    because="20 s of full output are 10 K",
)  # fmt: skip
STUCK_DELAY_S: Final = Parameter(
    "stuck_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="10 s",
    because="10 s of full output are 5 K",
)  # fmt: skip
RATE_FILTER_S: Final = Parameter(
    "rate_filter_s", "s", "1 s", "the hub's rate is that of readings filtered like this ... [A]",
    direction=Direction.LOWER, hardest="10 s",
    because="as stuck_delay: the rate is known later by so much",
)  # fmt: skip
RATE_WINDOW_S: Final = Parameter(
    "rate_window_s", "s", "4 s", "... over one to two times this: 5 mK/s of noise at 5 readings a second [A]",
    direction=Direction.LOWER, hardest="10 s",
    because="as stuck_delay: the rate is known later by up to twice so much",
)  # fmt: skip
RATE_SETTLE_S: Final = Parameter(
    "rate_settle_s", "s", "3 s", "after the heat went off, sensor and filter still catch up for this long [A]",
    direction=Direction.LOWER, hardest="20 s",
    because="as stuck_off",
)  # fmt: skip


def _hub_rises(v: Inputs) -> bool:
    r, p, jacket = v.readings, v.parameters, v.jacket
    if v.attended or not r.jacket_valid:
        return False
    return not (jacket.rate_k_s <= p[STUCK_RATE_K_S]) and r.now_s - jacket.off_since_s >= p[STUCK_OFF_S]


HEATER_STUCK: Final = Interlock(
    name="heater stuck",
    cause="the hub heats although no output is given",
    level="rate > stuck_rate, no output for stuck_off",
    condition=_hub_rises,
    compared=lambda v: Compared(v.jacket.rate_k_s, v.parameters[STUCK_RATE_K_S], "K/s"),
    parameters=(STUCK_RATE_K_S, STUCK_OFF_S, RATE_FILTER_S, RATE_WINDOW_S, RATE_SETTLE_S),
    delay=STUCK_DELAY_S,
    reaction=CONTROLLED,
    reset=REPAIR,
)

OPEN_OUTPUT_PERCENT: Final = Parameter("open_output_percent", "%", "80 %", "output at least this ...")
OPEN_S: Final = Parameter("open_s", "s", "60 s", "... for this long ...")
OPEN_BELOW_K: Final = Parameter("open_below_k", "K", "5 K", "... with the hub this far below its setpoint ...")
OPEN_RISE_K: Final = Parameter(
    "open_rise_k", "K", "2 K", "... and rising by less than this: the heater's line is open"
)


def _hub_does_not_warm(v: Inputs) -> bool:
    jacket, p = v.jacket, v.parameters
    return v.readings.now_s - jacket.weak_since_s >= p[OPEN_S] and not (jacket.rise_k >= p[OPEN_RISE_K])


HEATER_LINE_OPEN: Final = Interlock(
    name="heater line open",
    cause="full output and the hub does not warm: slip ring or heater open",
    level="output > open_output for open, rise < open_rise",
    condition=_hub_does_not_warm,
    compared=lambda v: Compared(v.jacket.rise_k, v.parameters[OPEN_RISE_K], "K"),
    parameters=(OPEN_OUTPUT_PERCENT, OPEN_S, OPEN_BELOW_K, OPEN_RISE_K),
    reaction=CONTROLLED,
    reset=REPAIR,
)

STANDSTILL_HEAT_DELAY_S: Final = Parameter(
    "standstill_heat_delay_s", "s", "100 ms", "heating with the wheel not turning", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="300 ms",
    because="harm is half a second of heat on a standing wheel; the contactor needs its time to open",
)  # fmt: skip


def _heats_a_standing_wheel(v: Inputs) -> bool:
    r = v.readings
    return r.contactor_closed and not v.turning and not (r.heat_percent <= 0.0)


HEATING_AT_STANDSTILL: Final = Interlock(
    name="heating at standstill",
    cause="jacket heating with the wheel not turning",
    level="output > 0, wheel stands",
    condition=_heats_a_standing_wheel,
    compared=lambda v: Compared(v.readings.heat_percent, 0.0, "%"),
    delay=STANDSTILL_HEAT_DELAY_S,
    at_rest=always,
    ends_lease=True,
    reaction=CONTROLLED,
    reset=ACK,
)

JUMP_K: Final = Parameter(
    "jump_k", "K", "5 K", "from one reading to the next, surface or hub",
    direction=Direction.LOWER, hardest="10 K",
    because="full output moves the hub by 0.1 K from reading to reading: more than 10 K is no temperature",
)  # fmt: skip
BLIND_S: Final = Parameter(
    "blind_s", "s", "1 s", "after a change of wheel readings are not compared for this long [A]",
    direction=Direction.LOWER, hardest="5 s",
    because="25 readings: what was on its way has long come",
)  # fmt: skip


def _hub_jumps(v: Inputs) -> bool:
    return not v.attended and not (v.jacket.jump_k <= v.parameters[JUMP_K])


HUB_JUMP: Final = Interlock(
    name="hub sensor jump",
    cause="hub sensor's line noisy (slip ring)",
    level="two readings apart by > jump",
    condition=_hub_jumps,
    compared=lambda v: Compared(v.jacket.jump_k, v.parameters[JUMP_K], "K"),
    parameters=(JUMP_K, BLIND_S),
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_wanted(v: Inputs) -> bool:
    """Tell whether anything depends on the surface temperature: a contact, or a heat."""
    return v.pressing or -_INF < v.demand.surface_c < _INF


def _surface_jumps(v: Inputs) -> bool:
    return not (v.surface.jump_k <= v.parameters[JUMP_K]) and _surface_wanted(v)


SURFACE_JUMP: Final = Interlock(
    name="surface sensor jump",
    cause="thermometer moved, covered or disturbed",
    level="two readings apart by > jump",
    condition=_surface_jumps,
    compared=lambda v: Compared(v.surface.jump_k, v.parameters[JUMP_K], "K"),
    parameters=(JUMP_K, BLIND_S),
    reaction=CONTROLLED,
    reset=ACK,
)

FROZEN_SURFACE_S: Final = Parameter(
    "frozen_surface_s", "s", "60 s", "identical raw counts of the thermometer while turning ...",
    direction=Direction.LOWER, hardest="2 min",
    because="a burst and its wait take a minute or two: a frozen thermometer must not last through them",
)  # fmt: skip
FROZEN_MODEL_K: Final = Parameter(
    "frozen_model_k", "K", "1 K", "... or while the model has moved by this",
    direction=Direction.LOWER, hardest="2 K",
    because="ten times what the thermometer resolves and a recipe's usual band of temperature",
)  # fmt: skip
FROZEN_DELAY_S: Final = Parameter(
    "frozen_delay_s", "s", "2 s",
    "either of both for this long: the thermometer is polled, the model is not [A]", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="5 s",
    because="25 readings that say what the model denies",
)  # fmt: skip


def _surface_frozen(v: Inputs) -> bool:
    r = v.readings
    if not (r.surface_valid and v.turning):
        return False
    p = v.parameters
    most = p[FROZEN_MODEL_K]
    return not (r.now_s - r.surface_changed_s <= p[FROZEN_SURFACE_S]) or not (
        -most <= v.model_c - v.surface.model_c <= most
    )


def _repeated(v: Inputs) -> Compared:
    r, p = v.readings, v.parameters
    same_s = r.now_s - r.surface_changed_s
    if not (same_s <= p[FROZEN_SURFACE_S]):
        return Compared(same_s, p[FROZEN_SURFACE_S], "s")
    return Compared(abs(v.model_c - v.surface.model_c), p[FROZEN_MODEL_K], "K")


THERMOMETER_FROZEN: Final = Interlock(
    name="thermometer frozen",
    cause="the thermometer repeats itself",
    level="unchanged for frozen_surface, or while the model moved by frozen_model, turning",
    condition=_surface_frozen,
    compared=_repeated,
    parameters=(FROZEN_SURFACE_S, FROZEN_MODEL_K),
    delay=FROZEN_DELAY_S,
    reaction=CONTROLLED,
    reset=REPAIR,
)

MODEL_K: Final = Parameter(
    "model_k", "K", "8 K", "surface temperature off the thermal model ...",
    direction=Direction.LOWER, hardest="15 K",
    because="a thermometer that reads 15 K low at limits.surface lets the rubber reach 110 degC, 20 K from harm",
)  # fmt: skip
MODEL_DELAY_S: Final = Parameter(
    "model_delay_s", "s", "30 s", "... for this long", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="60 s",
    because="full output heats the hub by 29 K in a minute",
)  # fmt: skip


def _surface_off_model(v: Inputs) -> bool:
    r = v.readings
    if not (r.surface_valid and v.turning):
        return False
    most = v.parameters[MODEL_K]
    return not (-most <= r.surface_c - v.model_c <= most)


SURFACE_OFF_MODEL: Final = Interlock(
    name="surface off model",
    cause="thermometer misaligned, dirty or wrong emissivity",
    level="surface off the thermal observer by > model, turning",
    condition=_surface_off_model,
    compared=lambda v: Compared(abs(v.readings.surface_c - v.model_c), v.parameters[MODEL_K], "K"),
    parameters=(MODEL_K,),
    delay=MODEL_DELAY_S,
    reaction=CONTROLLED,
    reset=REPAIR,
)

STALE_IR_S: Final = Parameter(
    "stale_ir_s", "s", "1 s", "age of the surface temperature",
    direction=Direction.LOWER, hardest="3 s",
    because="fifteen readings are missing by then: the thermometer is gone",
)  # fmt: skip
STALE_JACKET_S: Final = Parameter(
    "stale_jacket_s", "s", "1 s", "age of the hub temperature",
    direction=Direction.LOWER, hardest="3 s",
    because="full output heats the hub by 1.4 K in that time, and 2 K are left above limits.jacket and its margin",
)  # fmt: skip
STALE_DELAY_S: Final = Parameter(
    "stale_delay_s", "s", "200 ms", "for both [A]", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="1 s",
    because="with an age of 1 s ten readings are missing by then",
)  # fmt: skip


def _surface_old(v: Inputs) -> bool:
    r = v.readings
    return r.surface_silent or not (r.now_s - r.surface_at_s <= v.parameters[STALE_IR_S])


def _surface_missed(v: Inputs) -> bool:
    return _surface_old(v) and _surface_wanted(v)


def _surface_age(v: Inputs) -> Compared:
    r = v.readings
    return Compared(nan if r.surface_silent else r.now_s - r.surface_at_s, v.parameters[STALE_IR_S], "s")


THERMOMETER_SILENT: Final = Interlock(
    name="thermometer silent",
    cause="cable, supply or address; the surface temperature is not known",
    level="age > stale_ir, or several requests without an answer, and wanted",
    condition=_surface_missed,
    compared=_surface_age,
    unseen=_surface_old,
    parameters=(STALE_IR_S,),
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_invalid(v: Inputs) -> bool:
    r = v.readings
    return not r.surface_valid and not r.surface_silent


def _surface_unusable(v: Inputs) -> bool:
    return _surface_invalid(v) and _surface_wanted(v)


SURFACE_NOT_VALID: Final = Interlock(
    name="surface not valid",
    cause="the thermometer is out of its range, or reports an error",
    level="reading not valid, and wanted",
    condition=_surface_unusable,
    unseen=_surface_invalid,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)


def _jacket_old(v: Inputs) -> bool:
    r = v.readings
    return not v.attended and (r.jacket_silent or not (r.now_s - r.jacket_at_s <= v.parameters[STALE_JACKET_S]))


def _hub_age(v: Inputs) -> Compared:
    r = v.readings
    return Compared(nan if r.jacket_silent else r.now_s - r.jacket_at_s, v.parameters[STALE_JACKET_S], "s")


JACKET_SILENT: Final = Interlock(
    name="jacket silent",
    cause="cable, supply or address; the hub's temperature is not known",
    level="age > stale_jacket, or several requests without an answer",
    condition=_jacket_old,
    compared=_hub_age,
    parameters=(STALE_JACKET_S,),
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)


def _hub_invalid(v: Inputs) -> bool:
    r = v.readings
    return not v.attended and not r.jacket_valid and not r.jacket_silent


HUB_NOT_VALID: Final = Interlock(
    name="hub sensor broken",
    cause="the jacket's controller reports a broken sensor, or a hub out of its range",
    level="reading not valid",
    condition=_hub_invalid,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

ROWS: Final[tuple[Interlock, ...]] = (
    SURFACE_HOT, JACKET_HOT, JACKET_RUNAWAY, HEATER_STUCK, HEATER_LINE_OPEN, HEATING_AT_STANDSTILL, HUB_JUMP,
    SURFACE_JUMP, THERMOMETER_FROZEN, SURFACE_OFF_MODEL, THERMOMETER_SILENT, SURFACE_NOT_VALID, JACKET_SILENT,
    HUB_NOT_VALID,
)  # fmt: skip
