"""Stops that fail, with the deadline of each part of a stop; and motion or load at rest.

Rest means idle, armed, latched, or a run with its drives off.
"""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import POSITIVE, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import (
    CLEAR_MM,
    SPEEDS_OLD_S,
    STANDING_M_S,
    Inputs,
    Row,
    contactor_open,
    standing,
    unloaded,
)
from tester.kinds.wheel_on_belt.interlocks.motion import DROPPED_DELAY_S
from tester.machine.drive_rows import keeps_power, not_stopping, quick_stop_failed, stop_not_ended
from tester.machine.row import CONTROLLED, ENDING, POWER_OFF, REFUSE, SELDOM, Compared, Interlock, always
from tester.machine.watches import at_most, condition

LIFT_LATE_S: Final = Parameter(
    "lift_late_s", "s", "1 s", "after a stop: unloaded by then, else both drives stop fast [A]",
    hardest="1.5 s",
    because="lifting 2.5 mm at 10 mm/s takes 0.3 s; what does not lift must have lost its power 2.5 s after the stop",
)  # fmt: skip

NOT_LIFTED: Final[Row] = Interlock(
    name="not lifted",
    cause="still loaded after a stop or in a hold",
    watch=at_most("Fz >= 20 N at {} after it began", lambda v: v.lifting_s, LIFT_LATE_S),
    parameters=(SPEEDS_OLD_S, CLEAR_MM),
    applies=lambda v: v.lifting_s >= 0.0 and not unloaded(v),
    when=ENDING,
)

LIFT_FAILED_S: Final = Parameter(
    "lift_failed_s", "s", "1800 ms", "... and by then, else the power is taken off and the press's spring lifts [A]",
    hardest="2 s", because="the spring takes half a second more, and a rig is to be safe 3 s after its trip",
)  # fmt: skip
LIFTED_MM: Final = Parameter(
    "lifted_mm", "mm", "0.2 mm", "the press is where it was sent within this [A]",
    hardest="1 mm", because="lifted means 2 mm off the contact: half of that must be there",
)  # fmt: skip
PUSHED_MM: Final = Parameter(
    "pushed_mm", "mm", "0.3 mm", "ordered to lift or rest, the press moves on by this at most: 50 N at 200 N [A]",
    hardest="0.5 mm", because="0.5 mm are 86 N at 400 N (172 N/mm): 486 N, and harm begins at 500 N",
)  # fmt: skip
PRESS_LAG_S: Final = Parameter(
    "press_lag_s", "s", "50 ms", "from a command to the press following it: scan, wire and drive together [A]",
    hardest="100 ms", because="at 2 mm/s of loading the press may move another 0.2 mm unseen",
)  # fmt: skip


def _lift_failed(v: Inputs) -> bool:
    p = v.parameters
    late = v.lifting_s >= 0.0 and not (v.lifting_s <= p[LIFT_LATE_S]) and not (v.lifting_s <= p[LIFT_FAILED_S])
    goes_on = v.stopped_s >= 0.0 and not (v.readings.press_mm <= v.stop_start.press_mm + p[PUSHED_MM])
    return (not unloaded(v) and (late or goes_on)) or _not_up(v)


def _not_up(v: Inputs) -> bool:
    """Return whether a press with power is not seen to have come up in the time of its way, whatever the cell shows."""
    p, start = v.parameters, v.stop_start
    if not v.stopped_s >= 0.0 or v.setpoints.power_off or v.setpoints.creeps or v.readings.drives_disabled:
        return False
    way_mm = start.press_mm - start.lifted_mm
    late_s = v.stopped_s - p[LIFT_FAILED_S]
    return not (v.readings.press_mm <= start.lifted_mm + p[LIFTED_MM]) and not (late_s * v.limits.lift_mm_s <= way_mm)


def _still_pressing(v: Inputs) -> Compared:
    press_mm, most_mm = v.readings.press_mm, v.stop_start.press_mm + v.parameters[PUSHED_MM]
    if v.stopped_s >= 0.0 and not (press_mm <= most_mm):
        return Compared(press_mm, most_mm, "mm")
    return Compared(v.lifting_s, v.parameters[LIFT_FAILED_S], "s")


LIFT_FAILED: Final[Row] = Interlock(
    name="lift failed",
    cause="still loaded after the quick stop, the press moves on, or its position does not show that it lifts",
    watch=condition(
        "Fz >= 20 N at lift_failed after it began; or the press beyond its ramp and lag by pushed; or not up at"
        " lift_failed and its way",
        _lift_failed,
        _still_pressing,
    ),
    parameters=(LIFT_FAILED_S, PUSHED_MM, PRESS_LAG_S, LIFTED_MM),
    when=ENDING,
    reaction=POWER_OFF,
)

SLIP_OUT_S: Final = Parameter(
    "slip_out_s", "s", "500 ms", "slip is taken out for this long at most before both drives come down [A]",
    hardest="1 s", because="the press has lifted by then: later there is no slip to take out",
)  # fmt: skip
STOP_MARGIN_S: Final = Parameter(
    "stop_margin_s", "s", "500 ms", "drives may stand this much later than their ramps say [A]",
    hardest="1 s",
    because="a drive that does not stop loses its power after two of these; a rig is to be safe 3 s after its trip",
)  # fmt: skip


def _ramp_s(v: Inputs) -> float:
    # Slip is taken out first, then both decelerate on the ramp.
    p = v.parameters
    return p[SLIP_OUT_S] + v.stop_start.speed_m_s / v.limits.deceleration_m_s2 + p[STOP_MARGIN_S]


NOT_STOPPING: Final = not_stopping(
    _ramp_s,
    standing,
    cause="a drive turns longer than its ramp allows",
    level="turning at slip_out + v / deceleration + stop_margin",
    parameters=(SLIP_OUT_S, STOP_MARGIN_S),
)


def _quick_stop_s(v: Inputs) -> float:
    return v.stop_start.fast_speed_m_s / v.limits.quick_stop_m_s2 + v.parameters[STOP_MARGIN_S]


QUICK_STOP_FAILED: Final = quick_stop_failed(
    _quick_stop_s,
    standing,
    cause="a drive turns longer than its quick stop allows",
    level="turning at v / quick-stop deceleration + stop_margin",
    margin=STOP_MARGIN_S,
)

HEAT_OFF_S: Final = Parameter(
    "heat_off_s", "s", "1 s", "after a stop: no heat by then, or the contactor is open [A]",
    hardest="2 s",
    because="full output heats the hub by 1 K in 2 s",
)  # fmt: skip


def _output_percent(v: Inputs) -> float:
    return v.readings.heat_percent


def _off_due(v: Inputs) -> bool:
    return v.stopped_s >= 0.0 and not (v.stopped_s <= v.parameters[HEAT_OFF_S])


HEAT_NOT_OFF: Final[Row] = Interlock(
    name="heat not off",
    cause="the jacket heats after a stop",
    watch=at_most("output and contactor on at heat_off after the stop", _output_percent, 0.0, "%"),
    parameters=(HEAT_OFF_S,),
    applies=lambda v: _off_due(v) and not contactor_open(v),
    when=ENDING,
    ends_lease=True,
)

OUTPUT_NOT_OFF: Final[Row] = Interlock(
    name="output not off",
    cause="the jacket's controller gives output after a stop, whatever the contactor does",
    watch=at_most("output on at heat_off after the stop, or at rest", _output_percent, 0.0, "%"),
    parameters=(HEAT_OFF_S,),
    applies=lambda v: v.resting or _off_due(v),
    when=ENDING,
    ends_lease=True,
    reaction=CONTROLLED,
)

STOP_TIMEOUT_S: Final = Parameter(
    "stop_timeout_s", "s", "10 s",
    "a stop that has not ended by then takes the power off and latches [A]",
    hardest="15 s",
    because="every part of a stop has been escalated 2.5 s after it began; nothing gets better by waiting longer",
)  # fmt: skip


STOP_NOT_ENDED: Final = stop_not_ended(
    "a stop has not come to its end: standing, lifted, unloaded, without heat",
    "stop_timeout after it began, and once more after the power was taken",
    STOP_TIMEOUT_S,
    LIFTED_MM,
)

CONTACTOR_DELAY_S: Final = Parameter(
    "contactor_delay_s", "s", "500 ms", "the contactor has not followed its request by then [A]", POSITIVE,
    hardest="1 s", because="a contactor opens within 0.1 s [A]; the input word that shows it may be 0.25 s old",
)  # fmt: skip

CONTACTOR_WELDED: Final[Row] = Interlock(
    name="contactor welded",
    cause="the contactor is closed without request",
    watch=condition(
        "feedback closed, request off", lambda v: v.readings.contactor_closed and not v.setpoints.contactor
    ),
    delay=CONTACTOR_DELAY_S,
    when=SELDOM,
    at_rest=always,
    ends_lease=True,
    reaction=CONTROLLED,
)

def _moving(v: Inputs) -> bool:
    if keeps_power(v):
        return True
    if v.resting:
        r = v.readings
        comes = not r.drives_disabled and not (r.press_mm <= v.stop_start.press_mm + v.parameters[PUSHED_MM])
        return comes or not standing(v)
    return v.unpowered and not _still(v)


def _still(v: Inputs) -> bool:
    """Return whether a run is at rest, with drives off or on their way to operation: a person may be near.

    A drive without power may be turned by hand; a drive without data counts as powered.
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

FROZEN_WHEEL_S: Final = Parameter(
    "frozen_wheel_s", "s", "1 s", "the creep of a cool-down changes twice a second; a speed that does not is old [A]",
    hardest="1.5 s", because="the creep has changed three times by then",
)  # fmt: skip


def _wheel_changed_s(v: Inputs) -> float:
    r = v.readings
    return r.now_s - (r.wheel_changed_s if r.wheel_changed_s > v.mode_since_s else v.mode_since_s)


WHEEL_FROZEN: Final[Row] = Interlock(
    name="wheel frozen",
    cause="the wheel's drive repeats an old speed in a cool-down",
    watch=at_most("speed unchanged for {} in the cool-down", _wheel_changed_s, FROZEN_WHEEL_S),
    applies=lambda v: v.setpoints.creeps and v.setpoints.wheel_rad_s != 0.0,
    when=ENDING,
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

ROWS: Final[tuple[Row, ...]] = (
    NOT_LIFTED, LIFT_FAILED, NOT_STOPPING, QUICK_STOP_FAILED, HEAT_NOT_OFF, OUTPUT_NOT_OFF, STOP_NOT_ENDED,
    CONTACTOR_WELDED, MOVING_AT_REST, WHEEL_FROZEN, LOADED_AT_REST,
)  # fmt: skip
