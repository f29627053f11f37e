"""Friction: its greatest share of the load, its direction, and the shaft power of wheel and belt that it causes."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Parameter
from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs, Row
from tester.machine.row import LOADED, Interlock
from tester.machine.watches import at_most, condition, within

_RADIANS: Final = pi / 180.0

FRICTION_SHARE: Final = Parameter(
    "friction_share", "1", "2", "friction above this share of the load: Eq 9 has 1.6 at 400 N and 70 degC [A] ...",
    hardest="3", because="the published model's greatest coefficient is 1.6 at 400 N; twice that is no rubber's",
)  # fmt: skip
FRICTION_LEAST_N: Final = Parameter(
    "friction_least_n", "N", "250 N", "... and this beside it: that model has 220 N for 3# at 20 N [A] ...",
    NOT_NEGATIVE, hardest="400 N", because="more than 400 N beside the load's share would be friction without a load",
)  # fmt: skip
FRICTION_DELAY_S: Final = Parameter(
    "friction_delay_s", "s", "100 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="300 ms", because="friction power beyond the plan harms after 0.5 s",
)  # fmt: skip


def _most_n(v: Inputs) -> float:
    return v.parameters[FRICTION_SHARE] * v.readings.force_z_n + v.parameters[FRICTION_LEAST_N]


FRICTION_BEYOND_LOAD: Final[Row] = Interlock(
    name="friction beyond load",
    cause="more friction than the load can make: load cell channels exchanged, or the wheel touches something",
    watch=at_most("friction > friction_share x Fz + friction_least", lambda v: v.friction_n, _most_n, "N"),
    parameters=(FRICTION_SHARE, FRICTION_LEAST_N),
    delay=FRICTION_DELAY_S,
    when=LOADED,
)

CLEAR_SLIP_M_S: Final = Parameter(
    "clear_slip_m_s", "m/s", "50 mm/s",
    "slip above this has a sure direction: diameter and scales are known to 3 % [A] ...",
    hardest="150 mm/s",
    because="most conditions of a friction test slide at 0.1 m/s or more: above 0.15 m/s few would be watched",
)  # fmt: skip
AGAINST_SHARE: Final = Parameter(
    "against_share", "1", "0.1", "... friction of more than this share of the load with it, not against [A] ...",
    SHARE, hardest="0.3", because="the least coefficient of the paper's tests is 0.5",
)  # fmt: skip
AGAINST_LEAST_N: Final = Parameter(
    "against_least_n", "N", "5 N", "... and this beside it: the zero of Fx and Fy [A] ...", NOT_NEGATIVE,
    hardest="10 N", because="a first contact of 20 N has 10 N of friction or more",
)  # fmt: skip
AGAINST_DELAY_S: Final = Parameter(
    "against_delay_s", "s", "100 ms", "... for this long: a slip that reverses, speed and force read at two times [A]",
    NOT_NEGATIVE, hardest="300 ms", because="friction power beyond the plan harms after 0.5 s",
)  # fmt: skip


def _friction_with_slip_n(v: Inputs) -> float:
    """Return the force that acts in the slip's direction, unlike friction, N; 0 where that direction is uncertain."""
    r = v.readings
    clear, along, across = v.parameters[CLEAR_SLIP_M_S], r.wheel_speed_m_s - r.belt_speed_m_s, 0.0
    if r.positions["sideslip"] != 0.0:
        angle = r.positions["sideslip"] * _RADIANS
        along, across = r.wheel_speed_m_s - r.belt_speed_m_s * cos(angle), r.belt_speed_m_s * sin(angle)
    with_n = 0.0
    if not -clear <= along <= clear:
        with_n = -r.force_x_n if along > 0.0 else r.force_x_n
    if not -clear <= across <= clear:
        lateral_n = -r.force_y_n if across > 0.0 else r.force_y_n
        with_n = with_n if with_n > lateral_n else lateral_n
    return with_n


FRICTION_SIGN: Final[Row] = Interlock(
    name="friction sign",
    cause="friction acts with the slip: direction of wheel, belt or load cell, or their scale",
    watch=at_most(
        "friction along slip > clear_slip, and with it, > against_share x Fz + against_least",
        _friction_with_slip_n,
        lambda v: v.parameters[AGAINST_SHARE] * v.readings.force_z_n + v.parameters[AGAINST_LEAST_N],
        "N",
    ),
    parameters=(CLEAR_SLIP_M_S, AGAINST_SHARE, AGAINST_LEAST_N),
    delay=AGAINST_DELAY_S,
    when=LOADED,
)

SHAFT_FRICTION_W: Final = Parameter(
    "shaft_friction_w", "W", "30 W",
    "taken by the bearings of both shafts: 0.2 and 0.4 N m at 1.1 m/s are 13 W [A] ...",
    NOT_NEGATIVE, hardest="60 W", because="limits.slip_power and 60 W stay within what harms after 0.5 s",
)  # fmt: skip
SHAFT_GAIN_SHARE: Final = Parameter(
    "shaft_gain_share", "1", "0.05",
    "... and this share of what goes round through them: errors of the torques [A] ...",
    SHARE, hardest="0.1", because="500 W go round at 3# and 400 N: a tenth is 50 W each",
)  # fmt: skip
SHAFT_POWER_DELAY_S: Final = Parameter(
    "shaft_power_delay_s", "s", "200 ms",
    "... for this long: acceleration, and torque and force read at two times [A]",
    NOT_NEGATIVE, hardest="300 ms", because="friction power beyond the plan harms after 0.5 s",
)  # fmt: skip


def _shafts_deny_slip(v: Inputs) -> bool:
    r, p = v.readings, v.parameters
    wheel_w = r.drive_torque_nm * r.wheel_rad_s
    belt_w = r.belt_torque_nm * r.belt_speed_m_s / v.limits.roller_m
    allowed_w = p[SHAFT_FRICTION_W] + p[SHAFT_GAIN_SHARE] * (abs(wheel_w) + abs(belt_w))
    power_w = wheel_w + belt_w
    return not (-allowed_w <= power_w - v.friction_w <= allowed_w and power_w - allowed_w <= v.limits.slip_power_w)


SHAFT_POWER: Final[Row] = Interlock(
    name="shaft power",
    cause="the shafts take another power than friction and slip: direction, scale or diameter, or the load cell",
    watch=condition(
        "sum of torque x speed off friction x slip, or above limits.slip_power, by > shaft_friction (and share)",
        _shafts_deny_slip,
    ),
    parameters=(SHAFT_FRICTION_W, SHAFT_GAIN_SHARE),
    applies=lambda v: v.confirmed,
    delay=SHAFT_POWER_DELAY_S,
    when=LOADED,
)

BELT_TORQUE_NM: Final = Parameter(
    "belt_torque_nm", "N m", "3 N m",
    "belt drive off friction by this: rollers 0.4, inertia 1 N m, zero of Fx [A] ...",
    hardest="5 N m",
    because="a slack belt at rest then hides 100 N of friction: 40 J of heat on one spot in half a second",
)  # fmt: skip
BELT_TORQUE_SHARE: Final = Parameter(
    "belt_torque_share", "1", "0.05",
    "... and this share of friction's torque: errors of the drive's and of Fx [A] ...",
    SHARE, hardest="0.1", because="3# at 400 N has 32 N m: a tenth is as much as the rest",
)  # fmt: skip
BELT_TORQUE_DELAY_S: Final = Parameter(
    "belt_torque_delay_s", "s", "40 ms",
    "... for this long: friction turning round, Fx up to 20 ms later than torque [A]", NOT_NEGATIVE,
    hardest="45 ms",
    because="3# at 430 N rubs a held belt with 0.85 kW; and scans of 50 ms must count as slow for \"belt caught\"",
)  # fmt: skip


def _driven(v: Inputs) -> bool:
    """Return whether the belt's drive reports a torque: without power it reports none ("drive dropped out")."""
    return v.confirmed and v.readings.drives_enabled


def _along_n(r: Readings) -> float:
    """Return the friction force along the belt, N."""
    if r.positions["sideslip"] == 0.0:
        return r.force_x_n
    angle = r.positions["sideslip"] * _RADIANS
    return r.force_x_n * cos(angle) - r.force_y_n * sin(angle)


def _off_friction_nm(v: Inputs) -> tuple[float, float, float]:
    """Return 0, the deviation of the belt drive's torque from friction's on a gripping roller, and its limit, N m."""
    friction_nm = -_along_n(v.readings) * v.limits.roller_m
    allowed_nm = v.parameters[BELT_TORQUE_NM] + v.parameters[BELT_TORQUE_SHARE] * abs(friction_nm)
    return 0.0, abs(v.readings.belt_torque_nm - friction_nm), allowed_nm


BELT_TORQUE: Final[Row] = Interlock(
    name="belt torque",
    cause="the belt's drive denies the friction shown: the belt is held and slips on its roller, or the load cell",
    watch=within(
        "belt drive's torque off - friction along the belt x roller radius by > belt_torque (and share)",
        _off_friction_nm,
        "N m",
    ),
    parameters=(BELT_TORQUE_NM, BELT_TORQUE_SHARE),
    applies=_driven,
    delay=BELT_TORQUE_DELAY_S,
    when=LOADED,
)

BELT_PULL_NM: Final = Parameter(
    "belt_pull_nm", "N m", "10 N m",
    "belt drive pulls with this where friction does, at slip > clear_slip: 200 N [A]",
    hardest="15 N m",
    because="300 N are half of what 3# asks of the belt at 400 N: a roller that carries less slips in every test",
)  # fmt: skip


def _sense(v: Inputs) -> float:
    """Return the certain direction of friction on the belt: 1 forward, -1 back, 0 uncertain.

    In clear sliding both speeds show it. Otherwise the load cell shows it while scans are slow: then no command
    changes, so friction does not reverse between two readings.
    """
    r, p = v.readings, v.parameters
    clear, wheel_m_s = p[CLEAR_SLIP_M_S], r.wheel_speed_m_s
    if r.positions["sideslip"] != 0.0:
        wheel_m_s *= cos(r.positions["sideslip"] * _RADIANS)
    along_m_s = wheel_m_s - r.belt_speed_m_s
    if not -clear <= along_m_s <= clear:
        return 1.0 if along_m_s > 0.0 else -1.0
    if not v.scan_s > p[BELT_TORQUE_DELAY_S]:
        return 0.0
    along_n, least = _along_n(r), p[AGAINST_LEAST_N]
    return 0.0 if -least <= along_n <= least else 1.0 if along_n > 0.0 else -1.0


BELT_CAUGHT: Final[Row] = Interlock(
    name="belt caught",
    cause="the belt's drive pulls where friction does: the belt is held, its roller slips; or a direction is wrong",
    watch=at_most(
        "belt drive's torque > {} the way friction acts on the belt: slip > clear_slip, or scans are slow",
        lambda v: _sense(v) * v.readings.belt_torque_nm,
        BELT_PULL_NM,
    ),
    parameters=(CLEAR_SLIP_M_S, AGAINST_LEAST_N, BELT_TORQUE_DELAY_S),
    applies=_driven,
    when=LOADED,
)

ROWS: Final[tuple[Row, ...]] = (FRICTION_SIGN, SHAFT_POWER, BELT_TORQUE, BELT_CAUGHT, FRICTION_BEYOND_LOAD)
