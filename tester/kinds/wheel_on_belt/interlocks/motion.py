"""The drives: their data, their speeds and the press's travel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Direction, Parameter
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N
from tester.kinds.wheel_on_belt.interlocks.inputs import STANDING_M_S, Inputs, Row
from tester.machine.drive_rows import DRIVE_DATA_STALE, drive_dropped_out
from tester.machine.row import ACK, LOADED, Compared, Interlock
from tester.machine.watches import at_least, at_most, condition, within
from tester.machine.wires import INPUTS_STALE

DROPPED_DELAY_S: Final = Parameter(
    "dropped_delay_s", "s", "50 ms", "a drive leaves operation by itself [A]", NOT_NEGATIVE,
    hardest="50 ms",
    because="one drive down under load rubs with up to 1 kW (3#, 430 N, 90 degC): 50 ms more are 50 J, and 40 J harm",
)  # fmt: skip


DRIVE_DROPPED_OUT: Final = drive_dropped_out(DROPPED_DELAY_S)

OVERSPEED_SHARE: Final = Parameter(
    "overspeed_share", "1", "5 %", "above a speed limit by this share [A]", NOT_NEGATIVE,
    hardest="10 %",
    because="a belt at 1.3 m/s gains a tenth in 65 ms on a ramp of 2 m/s2: more than that is no overshoot",
)  # fmt: skip
OVERSPEED_DELAY_S: Final = Parameter(
    "overspeed_delay_s", "s", "50 ms", "[A]", NOT_NEGATIVE,
    hardest="100 ms", because="at 2 m/s2 a drive gains another 0.2 m/s in 100 ms",
)  # fmt: skip


def _speeds_m_s(v: Inputs) -> tuple[float, float, float]:
    r, share = v.readings, 1.0 + v.parameters[OVERSPEED_SHARE]
    belt_m_s, most_m_s = abs(r.belt_speed_m_s), v.limits.belt_speed_m_s * share
    if not (belt_m_s <= most_m_s):
        return 0.0, belt_m_s, most_m_s
    return 0.0, abs(r.wheel_speed_m_s), v.limits.wheel_speed_m_s * share


OVERSPEED: Final[Row] = Interlock(
    name="overspeed",
    cause="wheel or belt above its limit",
    watch=within("speed > limit + overspeed_share", _speeds_m_s, "m/s"),
    parameters=(OVERSPEED_SHARE,),
    applies=lambda v: not v.readings.drives_disabled,
    delay=OVERSPEED_DELAY_S,
    reset=ACK,
)

RAMP_SHARE: Final = Parameter(
    "ramp_share", "1", "0.3", "a speed on its way may follow this share of its ramp [A]: scan, wire, load", SHARE,
    direction=Direction.HIGHER, hardest="0.2",
    because="the slower ramp reaches 0.8 m/s after 2 s instead of 0.4 s: longer than that a jammed drive would pass",
)  # fmt: skip
SPEED_ERROR_M_S: Final = Parameter(
    "speed_error_m_s", "m/s", "50 mm/s", "a speed off what its ramp allows by this [A]",
    hardest="100 mm/s",
    because="an unrequested slip of 0.1 m/s is within Table 2 of the paper; twice that doubles its heat",
)  # fmt: skip
SPEED_ERROR_DELAY_S: Final = Parameter(
    "speed_error_delay_s", "s", "100 ms", "... for this long", NOT_NEGATIVE,
    hardest="150 ms",
    because="a runaway wheel gains 0.3 m/s in that time; friction power beyond the plan harms after 0.5 s",
)  # fmt: skip


def _wheel_on_ramp(v: Inputs) -> tuple[float, float, float]:
    error, wheel = v.parameters[SPEED_ERROR_M_S], v.wheel
    return wheel.low_m_s - error, v.readings.wheel_speed_m_s, wheel.high_m_s + error


def _belt_on_ramp(v: Inputs) -> tuple[float, float, float]:
    error, belt = v.parameters[SPEED_ERROR_M_S], v.belt
    return belt.low_m_s - error, v.readings.belt_speed_m_s, belt.high_m_s + error


def _off_ramp(name: str, cause: str, on_ramp: Callable[[Inputs], tuple[float, float, float]]) -> Row:
    return Interlock(
        name=name,
        cause=cause,
        watch=within("off what its ramp allows by > speed_error", on_ramp, "m/s"),
        parameters=(RAMP_SHARE, SPEED_ERROR_M_S),
        applies=lambda v: v.confirmed,
        delay=SPEED_ERROR_DELAY_S,
        reset=ACK,
    )


WHEEL_SPEED: Final = _off_ramp(
    "wheel speed", "wheel not at its speed: jammed, slipping coupling, wrong scale", _wheel_on_ramp
)
BELT_SPEED: Final = _off_ramp("belt speed", "belt not at its speed: jammed, wrong scale", _belt_on_ramp)

PRESS_ERROR_MM: Final = Parameter(
    "press_error_mm", "mm", "0.3 mm", "the press further to the contact than its commands allow: 50 N at 200 N [A]",
    hardest="0.5 mm", because="0.5 mm are 86 N at 400 N (172 N/mm): 486 N, and harm begins at 500 N",
)  # fmt: skip

PRESS_SPEED: Final[Row] = Interlock(
    name="press speed",
    cause="press comes on its own: broken velocity loop, setpoints lost",
    watch=at_most(
        "further towards the contact than its ramp allows by > {}", lambda v: v.press.ahead_mm, PRESS_ERROR_MM
    ),
    applies=lambda v: v.confirmed,
)

PRESS_TRAVEL: Final[Row] = Interlock(
    name="press travel",
    cause="press outside its travel: ran past its end, or its zero is wrong",
    watch=within(
        "position outside axes.press.software_limits",
        lambda v: (v.limits.press_low_mm, v.readings.press_mm, v.limits.press_high_mm),
        "mm",
    ),
    applies=lambda v: v.demand.enabled and v.readings.drives_enabled,
    reset=ACK,
)

APART_M_S: Final = Parameter(
    "apart_m_s", "m/s", "0.1 m/s", "one is at rest, the other faster than this: no rounding of two equal ramps [A]",
    hardest="0.2 m/s",
    because="at 0.2 m/s a standing 3# wheel takes a quarter of that 1 kW on one spot: 40 J in 0.16 s",
)  # fmt: skip
STANDING_DELAY_S: Final = Parameter(
    "standing_delay_s", "s", "0 ms",
    "one drive is at rest under load while the other turns: 3# takes 1 kW, harm is 40 J", NOT_NEGATIVE,
    hardest="0 ms",
    because="a belt that jams under 430 N makes 38 J until it is unloaded, with no delay at all; harm is 40 J",
)  # fmt: skip


def _one_stands(v: Inputs) -> bool:
    r, p = v.readings, v.parameters
    if r.force_z_n < UNLOADED_N or v.unpowered:
        return False
    wheel, belt, still = r.wheel_speed_m_s, r.belt_speed_m_s, p[STANDING_M_S]
    belt_moves = belt > still or belt < -still
    if v.pressing and not (v.turning and belt_moves):
        return True
    if v.turning is belt_moves:
        return False
    # In a common stop either may stop a moment earlier: that is no wheel on a stopped belt.
    most = p[APART_M_S]
    slow = -most <= wheel <= most and -most <= belt <= most
    # A quick stop stops both, whatever their difference: no reaction is quicker.
    quick = v.stopped_s >= 0.0 and v.stop.fast_s <= r.now_s
    return not slow and not quick


def _slower(v: Inputs) -> Compared:
    wheel_m_s, belt_m_s = abs(v.readings.wheel_speed_m_s), abs(v.readings.belt_speed_m_s)
    still_m_s = v.parameters[STANDING_M_S]
    return Compared(belt_m_s if not (belt_m_s > still_m_s) else wheel_m_s, still_m_s, "m/s")


STANDING_UNDER_LOAD: Final[Row] = Interlock(
    name="drive standing under load",
    cause="wheel on a stopped belt, or belt under a stopped wheel",
    watch=condition("load > 20 N, one below standing, the other above apart", _one_stands, _slower),
    parameters=(STANDING_M_S, APART_M_S),
    delay=STANDING_DELAY_S,
    reset=ACK,
)

TORN_SHARE: Final = Parameter(
    "torn_share", "1", "0.05", "friction and torque below this share of the load while sliding: no belt [A] ...",
    SHARE, direction=Direction.HIGHER, hardest="0.02",
    because="a wheel on the bare roller shows friction of a few hundredths of its load [A]",
)  # fmt: skip
TORN_SLIP_M_S: Final = Parameter(
    "torn_slip_m_s", "m/s", "50 mm/s", "... above this slip [A]",
    hardest="100 mm/s", because="most conditions of a friction test slide at 0.1 m/s or more",
)  # fmt: skip
TORN_DELAY_S: Final = Parameter(
    "torn_delay_s", "s", "100 ms", "... for this long", NOT_NEGATIVE,
    hardest="200 ms", because="at 1.3 m/s a torn belt has run off its rollers by 0.26 m",
)  # fmt: skip
TORN_FRICTION_NM: Final = Parameter(
    "torn_friction_nm", "N m", "0.25 N m",
    "of the wheel's torque, taken off first: its shaft unloaded, rather too much [A]", NOT_NEGATIVE,
    direction=Direction.HIGHER, hardest="0.1 N m",
    because="a shaft with 0.2 N m then hides a torn belt below 45 N, with nothing taken off below 92 N",
)  # fmt: skip


def _least_n(v: Inputs) -> float:
    return v.parameters[TORN_SHARE] * v.readings.force_z_n


def _slides_without_torque(v: Inputs) -> bool:
    r, p = v.readings, v.parameters
    if not (v.pressing and v.contact.in_contact and v.contact.loaded and r.slip_m_s > p[TORN_SLIP_M_S]):
        return False
    # Bearings and seals need torque even without a belt; undeducted, it looks like friction at a small load.
    rubbing_nm = abs(r.drive_torque_nm) - p[TORN_FRICTION_NM]
    return not (rubbing_nm >= _least_n(v) * r.diameter_mm * 0.5e-3)


BELT_TORN: Final[Row] = Interlock(
    name="belt torn",
    cause="friction and drive torque collapsed while sliding under load",
    watch=at_least(
        "friction, and torque less torn_friction, < torn_share of the load at slip > torn_slip",
        lambda v: v.friction_n,
        _least_n,
        "N",
    ),
    parameters=(TORN_SHARE, TORN_SLIP_M_S, TORN_FRICTION_NM),
    applies=_slides_without_torque,
    delay=TORN_DELAY_S,
    when=LOADED,
)

ROWS: Final[tuple[Row, ...]] = (
    DRIVE_DATA_STALE, INPUTS_STALE, DRIVE_DROPPED_OUT, OVERSPEED, WHEEL_SPEED, BELT_SPEED, PRESS_SPEED, PRESS_TRAVEL,
    STANDING_UNDER_LOAD, BELT_TORN,
)  # fmt: skip
