"""The hub, its sensor and its heater."""

from __future__ import annotations

from math import inf, sqrt
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs, Row
from tester.kinds.wheel_on_belt.interlocks.surface import BLIND_S, JUMP_K, STALE_DELAY_S
from tester.machine.row import ACK, CONTROLLED, SELDOM, Interlock, always
from tester.machine.watches import at_least, at_most, condition
from tester.machine.wires import answered_s

_INF: Final = inf


def _hub_known(v: Inputs) -> bool:
    return v.readings.jacket_valid and not v.attended


JACKET_MARGIN_K: Final = Parameter(
    "jacket_margin_k", "K", "3 K", "the hub may overshoot limits.jacket by this; 155 degC is harm [A]", NOT_NEGATIVE,
    hardest="4 K", because="140 degC and 4 K leave 11 K to harm for what a sensor that drifts hides",
)  # fmt: skip
JACKET_DELAY_S: Final = Parameter(
    "jacket_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    hardest="2 s",
    because="200 W heat a hub of 420 J/K by 1 K in two seconds",
)  # fmt: skip

JACKET_HOT: Final[Row] = Interlock(
    name="jacket hot",
    cause="hub above its limit",
    watch=at_most(
        "hub > limits.jacket + jacket_margin",
        lambda v: v.readings.hub_c,
        lambda v: v.limits.jacket_c + v.parameters[JACKET_MARGIN_K],
        "degC",
    ),
    parameters=(JACKET_MARGIN_K,),
    applies=lambda v: v.readings.jacket_valid,
    delay=JACKET_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)

RUNAWAY_K: Final = Parameter(
    "runaway_k", "K", "8 K", "hub above every setpoint of runaway_window by this",
    hardest="15 K", because="three times the overshoot of a jacket controller that is tuned [A]",
)  # fmt: skip
RUNAWAY_WINDOW_S: Final = Parameter(
    "runaway_window_s", "s", "10 min", "how far back setpoints count: a hub cools more slowly than it heats [A]",
    hardest="30 min",
    because="a hub at 112 degC cools to 45 degC in half an hour: an older setpoint does not describe it",
)  # fmt: skip
RUNAWAY_DELAY_S: Final = Parameter(
    "runaway_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    hardest="10 s", because="200 W heat a hub of 420 J/K by 5 K in that time",
)  # fmt: skip


def _highest_c(v: Inputs) -> float:
    """Return the limit of the hub, degC: the highest setpoint that counts, plus ``runaway``."""
    r, setpoints = v.readings, v.hub_setpoints
    # A hot hub takes longer to cool than the window lasts: without output it must not get hotter again,
    # except from rubber that friction has made hotter than the hub.
    coolest = v.jacket.coolest_c
    highest = max(setpoints[0][1] if setpoints else _INF, v.limits.hub_min_c, coolest)
    if coolest > -_INF and r.surface_valid and r.surface_c > highest:
        highest = r.surface_c
    return highest + v.parameters[RUNAWAY_K]


JACKET_RUNAWAY: Final[Row] = Interlock(
    name="jacket runaway",
    cause="hub above every setpoint of the last ten minutes",
    watch=at_most(
        "hub > highest setpoint in runaway_window + runaway; without output: > coolest since, or rubber, + runaway",
        lambda v: v.readings.hub_c,
        _highest_c,
        "degC",
    ),
    parameters=(RUNAWAY_K, RUNAWAY_WINDOW_S),
    applies=lambda v: _hub_known(v) and len(v.hub_setpoints) > 0,
    delay=RUNAWAY_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)

STUCK_RATE_K_S: Final = Parameter(
    "stuck_rate_k_s", "K/s", "0.05 K/s", "the hub rises faster than this ...",
    hardest="0.2 K/s", because="full output, 200 W at 420 J/K, makes 0.48 K/s: less than half of it must be noticed",
)  # fmt: skip
STUCK_OFF_S: Final = Parameter(
    "stuck_off_s", "s", "5 s", "... with no output for this long ...", NOT_NEGATIVE,
    hardest="20 s", because="20 s of full output are 10 K",
)  # fmt: skip
STUCK_DELAY_S: Final = Parameter(
    "stuck_delay_s", "s", "2 s", "... for this long", NOT_NEGATIVE,
    hardest="10 s", because="10 s of full output are 5 K",
)  # fmt: skip
RATE_FILTER_S: Final = Parameter(
    "rate_filter_s", "s", "1 s", "the hub's rate is that of readings filtered like this ... [A]",
    hardest="10 s", because="as stuck_delay: the rate is known later by so much",
)  # fmt: skip
RATE_WINDOW_S: Final = Parameter(
    "rate_window_s", "s", "4 s", "... over one to two times this: 5 mK/s of noise at 5 readings a second [A]",
    hardest="10 s", because="as stuck_delay: the rate is known later by up to twice so much",
)  # fmt: skip
RATE_SETTLE_S: Final = Parameter(
    "rate_settle_s", "s", "3 s", "after the heat went off, sensor and filter still catch up for this long [A]",
    hardest="20 s", because="as stuck_off",
)  # fmt: skip


def _off_for_long(v: Inputs) -> bool:
    return _hub_known(v) and v.readings.now_s - v.jacket.off_since_s >= v.parameters[STUCK_OFF_S]


HEATER_STUCK: Final[Row] = Interlock(
    name="heater stuck",
    cause="the hub heats although no output is given",
    watch=at_most("rate > {}, no output for stuck_off", lambda v: v.jacket.rate_k_s, STUCK_RATE_K_S),
    parameters=(STUCK_OFF_S, RATE_FILTER_S, RATE_WINDOW_S, RATE_SETTLE_S),
    applies=_off_for_long,
    delay=STUCK_DELAY_S,
    reaction=CONTROLLED,
)

_COLD: Final = "a heater that does not heat does no harm"
OPEN_OUTPUT_PERCENT: Final = Parameter("open_output_percent", "%", "80 %", "output at least this ...", because=_COLD)
OPEN_S: Final = Parameter("open_s", "s", "60 s", "... for this long ...", because=_COLD)
OPEN_BELOW_K: Final = Parameter(
    "open_below_k", "K", "5 K", "... with the hub this far below its setpoint ...", because=_COLD
)
OPEN_RISE_K: Final = Parameter(
    "open_rise_k", "K", "2 K", "... and rising by less than this: the heater's line is open", because=_COLD
)

HEATER_LINE_OPEN: Final[Row] = Interlock(
    name="heater line open",
    cause="full output and the hub does not warm: slip ring or heater open",
    watch=at_least("output > open_output for open, rise < {}", lambda v: v.jacket.rise_k, OPEN_RISE_K),
    parameters=(OPEN_OUTPUT_PERCENT, OPEN_S, OPEN_BELOW_K, OPEN_RISE_K),
    applies=lambda v: v.readings.now_s - v.jacket.weak_since_s >= v.parameters[OPEN_S],
    reaction=CONTROLLED,
)

STANDSTILL_HEAT_DELAY_S: Final = Parameter(
    "standstill_heat_delay_s", "s", "100 ms", "heating with the wheel not turning", NOT_NEGATIVE,
    hardest="300 ms", because="harm is half a second of heat on a standing wheel; the contactor needs its time to open",
)  # fmt: skip

HEATING_AT_STANDSTILL: Final[Row] = Interlock(
    name="heating at standstill",
    cause="jacket heating with the wheel not turning",
    watch=at_most("output > {}, wheel at rest", lambda v: v.readings.heat_percent, 0.0, "%"),
    applies=lambda v: v.readings.contactor_closed and not v.turning,
    delay=STANDSTILL_HEAT_DELAY_S,
    when=SELDOM,
    at_rest=always,
    ends_lease=True,
    reaction=CONTROLLED,
    reset=ACK,
)


HUB_JUMP: Final[Row] = Interlock(
    name="hub sensor jump",
    cause="hub sensor's line noisy (slip ring)",
    watch=at_most("two readings apart by > {}", lambda v: v.jacket.jump_k, JUMP_K),
    parameters=(BLIND_S,),
    applies=lambda v: not v.attended,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)


HEAT_SHARE: Final = Parameter(
    "heat_share", "1", "0.3",
    "heat beyond what hub and rubber show, and this share: observer's error [A] ...",
    SHARE, hardest="0.3",
    because="0.3 hides temperatures that read 26 % low until a rig has a history: heat_share_known",
)  # fmt: skip
HEAT_SHARE_KNOWN: Final = Parameter(
    "heat_share_known", "1", "0.09",
    "... or this beyond the ratio that a rig's own heatings have shown [A] ...",
    SHARE, hardest="0.09",
    because="0.1 and heat_leak hide temperatures 14 % low: at 85 degC the hub is at 155 degC then",
)  # fmt: skip
HEAT_LEAK_W: Final = Parameter(
    "heat_leak_w", "W", "5 W", "... and this: air 10 K colder than believed takes 4 W [A] ...", NOT_NEGATIVE,
    hardest="10 W", because="85 degC take some 25 W: a common supply 30 % low puts in 10 W more",
)  # fmt: skip
UNSEEN_HEAT_K: Final = Parameter(
    "unseen_heat_k", "K", "4 K",
    "... adds up to this much of hub: 8 s of full output; a sensor may be 5 s late [A]",
    hardest="8 K", because="a hub sensor 20 s late hides 9 K at full output",
)  # fmt: skip
SHOWN_SHARE: Final = 0.5
"""Least share of the heat that must show [A]; less is a heater without current, which has its own row."""
UNSEEN_LEAST_K: Final = 1.0
"""Greatest error of a sound sensor, K [A]: with 1 s of lag, read every 0.2 s, it hides 0.6 K at full output."""


def _unseen_most_k(v: Inputs) -> float:
    """Return the allowed excess of the hub over its reading, K: within the hub's limit."""
    heat, p = v.heat, v.parameters
    most_k = max(v.limits.jacket_c + p[JACKET_MARGIN_K] - v.readings.hub_c, UNSEEN_LEAST_K)
    if heat.shown_w < SHOWN_SHARE * heat.put_w or most_k < p[UNSEEN_HEAT_K]:
        return most_k
    return p[UNSEEN_HEAT_K]


HEAT_NOT_SHOWN: Final[Row] = Interlock(
    name="heat not shown",
    cause="more heat put in than the temperatures show: hub sensor, or its supply, low, late or loose; or heater weak",
    watch=at_most(
        "heat beyond the shares of what is shown > unseen_heat of hub, while half of it shows; or hub then too hot",
        lambda v: v.heat.unseen_k,
        _unseen_most_k,
        "K",
    ),
    parameters=(HEAT_SHARE, HEAT_SHARE_KNOWN, HEAT_LEAK_W, UNSEEN_HEAT_K, JACKET_MARGIN_K),
    applies=lambda v: not v.heat.unseen_k <= 0.0 and _hub_known(v),
    when=SELDOM,
    reaction=CONTROLLED,
)

UNGIVEN_HEAT_K: Final = Parameter(
    "ungiven_heat_k", "K", "5 K", "heat that shows beyond the output, heat_leak and the shares, in K of hub [A]",
    hardest="8 K", because="as unseen_heat: a relay that sticks beside a sensor that drifts heats by so much unseen",
)  # fmt: skip

HEAT_NOT_GIVEN: Final[Row] = Interlock(
    name="heat not given",
    cause="more heat shows than the heater's output puts in: relay sticks, or hub sensor rises by itself",
    watch=at_most("heat shown beyond output, heat_leak and shares > {} of hub", lambda v: v.heat.ungiven_k,
                  UNGIVEN_HEAT_K),
    applies=lambda v: not v.heat.ungiven_k <= 0.0 and _hub_known(v),
    delay=RUNAWAY_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
)  # fmt: skip

HIDDEN_MODEL_K: Final = Parameter(
    "hidden_model_k", "K", "5 K", "surface off the thermal model, while the hub heats ...",
    hardest="8 K", because="as model: with 8 K a common drift of both sensors hides 20 K of hub",
)  # fmt: skip
HIDDEN_DELAY_S: Final = Parameter(
    "hidden_delay_s", "s", "5 s", "... or less, where heat is missing as well, for this long [A]", NOT_NEGATIVE,
    hardest="30 s", because="sensors that drift by 10 K/min hide 5 K more in that time",
)  # fmt: skip


def _hidden(v: Inputs) -> float:
    """Return how much speaks for a hub hotter than shown: surface off the model and heat missing, each as a multiple of
    its allowance, as independent errors add up. Heat of which less than half shows has rows of its own."""
    heat = v.heat
    off = (v.readings.surface_c - v.model_c) / v.parameters[HIDDEN_MODEL_K]
    lack = heat.lack if heat.shown_w >= SHOWN_SHARE * heat.put_w else 0.0
    return sqrt(off * off + lack * lack)


HUB_HOTTER: Final[Row] = Interlock(
    name="hub hotter than shown",
    cause="hub sensor, alone or together with the thermometer, drifts or reads low; or observer wrong",
    watch=at_most("root of squares of surface off model / hidden_model and heat missing / its shares > 1", _hidden, 1.0,
                  "1"),
    parameters=(HIDDEN_MODEL_K, HEAT_SHARE, HEAT_SHARE_KNOWN, HEAT_LEAK_W),
    applies=lambda v: v.setpoints.heat and v.turning and v.readings.surface_valid and _hub_known(v),
    delay=HIDDEN_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
)  # fmt: skip

FROZEN_HUB_K: Final = Parameter(
    "frozen_hub_k", "K", "3 K", "heat beyond that of before must have moved the reading by now [A] ...",
    hardest="4 K",
    because="a hub at limits.jacket is 15 K from harm, and rises by 3 K more while the output begins to rise",
)  # fmt: skip
FROZEN_HUB_SHARE: Final = Parameter(
    "frozen_hub_share", "1", "0.3", "... or this share of what limits.jacket is away, where that is more [A]",
    SHARE, hardest="0.5", because="a hub that moves by as much again before the trip stays below limits.jacket",
)  # fmt: skip


def _still_most_k(v: Inputs) -> float:
    """Return by how many K the hub may have warmed while its reading is constant: fewer close to the hub's limit."""
    p = v.parameters
    away_k = v.limits.jacket_c - v.readings.hub_c
    return max(p[FROZEN_HUB_K], p[FROZEN_HUB_SHARE] * away_k)


HUB_FROZEN: Final[Row] = Interlock(
    name="hub sensor frozen",
    cause="the hub's temperature repeats itself while the heater gives more",
    watch=at_most(
        "within a count, and heat beyond the least since, heat_leak and what is lost > frozen_hub, or its share",
        lambda v: v.heat.still_k,
        _still_most_k,
        "K",
    ),
    parameters=(FROZEN_HUB_K, FROZEN_HUB_SHARE),
    applies=lambda v: not v.heat.still_k <= 0.0 and _hub_known(v),
    when=SELDOM,
    reaction=CONTROLLED,
)

STALE_JACKET_S: Final = Parameter(
    "stale_jacket_s", "s", "1 s", "age of the hub temperature",
    hardest="3 s",
    because="full output heats the hub by 1.4 K in that time",
)  # fmt: skip


def _hub_answered_s(v: Inputs) -> float:
    r = v.readings
    return answered_s(r.jacket_silent, r.now_s, r.jacket_at_s)


JACKET_SILENT: Final[Row] = Interlock(
    name="jacket silent",
    cause="cable, supply or address; the hub's temperature is not known",
    watch=at_most("age > {}, or several requests without an answer", _hub_answered_s, STALE_JACKET_S),
    applies=lambda v: not v.attended,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

HUB_NOT_VALID: Final[Row] = Interlock(
    name="hub sensor broken",
    cause="the jacket's controller reports a broken sensor, or a hub out of its range",
    watch=condition("reading not valid", lambda v: not v.readings.jacket_valid),
    applies=lambda v: not v.attended and not v.readings.jacket_silent,
    delay=STALE_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)

ROWS: Final[tuple[Row, ...]] = (
    JACKET_HOT, JACKET_RUNAWAY, HEATER_STUCK, HEATER_LINE_OPEN, HEATING_AT_STANDSTILL, HUB_JUMP, HUB_FROZEN,
    HEAT_NOT_SHOWN, HUB_HOTTER, HEAT_NOT_GIVEN, JACKET_SILENT, HUB_NOT_VALID,
)  # fmt: skip
