"""At rest: in idle, armed and latched, and in a run that has its drives off."""

from __future__ import annotations

from typing import Final

from tester.kinds.wheel_on_belt.interlocks.inputs import (
    CLEAR_MM,
    SPEEDS_OLD_S,
    STANDING_M_S,
    Inputs,
    Row,
    standing,
    unloaded,
)
from tester.kinds.wheel_on_belt.interlocks.motion import DROPPED_DELAY_S
from tester.kinds.wheel_on_belt.interlocks.stops import PUSHED_MM
from tester.machine.row import ENDING, POWER_OFF, REFUSE, Interlock
from tester.machine.watches import condition


def _moving(v: Inputs) -> bool:
    if v.resting:
        r = v.readings
        comes = not r.drives_disabled and not (r.press_mm <= v.stop_start.press_mm + v.parameters[PUSHED_MM])
        return comes or not standing(v)
    return v.unpowered and not _still(v)


def _still(v: Inputs) -> bool:
    """Return whether a run whose drives are off, or on their way to operation, stands: a person may be near.

    A drive without power may be turned by hand; one without news counts as powered.
    """
    r, p = v.readings, v.parameters
    if v.demand.enabled:
        return standing(v) and r.press_mm <= v.rest_mm + p[PUSHED_MM]
    since = r.now_s - p[SPEEDS_OLD_S]
    return r.drives_disabled and r.wheel_at_s >= since and r.belt_at_s >= since and r.press_at_s >= since


MOVING_AT_REST: Final[Row] = Interlock(
    name="moving at rest",
    cause="a drive turns, has power or comes although everything is to rest",
    watch=condition(
        "a speed >= standing or unknown, or the press further by pushed; in a run: power that is not wanted", _moving
    ),
    parameters=(STANDING_M_S, SPEEDS_OLD_S, PUSHED_MM),
    delay=DROPPED_DELAY_S,
    when=ENDING,
    at_rest=lambda v: not v.readings.drives_disabled,  # without power a hand may turn the belt
    reaction=POWER_OFF,
)

LOADED_AT_REST: Final[Row] = Interlock(
    name="loaded at rest",
    cause="the wheel is pressed although everything is to rest",
    watch=condition(
        "Fz >= 20 N, or unknown and the press not clear of the contact", lambda v: v.resting and not unloaded(v)
    ),
    parameters=(SPEEDS_OLD_S, CLEAR_MM),
    when=ENDING,
    reaction=REFUSE,
    reset="cause gone",
)

ROWS: Final[tuple[Row, ...]] = (MOVING_AT_REST, LOADED_AT_REST)
