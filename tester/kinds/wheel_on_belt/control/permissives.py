"""Permissives for heat, load and motion, and the bounds of their commands.

A permissive is checked in every scan, not only at the start: a command that loses its permissive is withdrawn in that
scan, before any interlock's delay is over.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi
from typing import Final

from tester.inputs.rig.parameter import Values
from tester.kinds.wheel_on_belt.control.loops import WheelState
from tester.kinds.wheel_on_belt.image.process_image import Demand, Readings
from tester.kinds.wheel_on_belt.interlocks.hub import STALE_JACKET_S
from tester.kinds.wheel_on_belt.interlocks.inputs import STANDING_M_S
from tester.kinds.wheel_on_belt.interlocks.load import STALE_CELL_S
from tester.kinds.wheel_on_belt.interlocks.operation import MAX_SLIP_M_S, TURNING_CONFIRMED_S
from tester.kinds.wheel_on_belt.interlocks.surface import STALE_IR_S
from tester.kinds.wheel_on_belt.rig import RigConfig

HARD_LOAD_N: Final = 500.0
HARD_HUB_C: Final = 155.0
HARD_SURFACE_C: Final = 130.0
"""Values beyond these are harmful (docs/kinds/wheel-on-belt.md), whatever a rig file or a recipe allows."""
_RADIANS: Final = pi / 180.0


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of the commands: the least of the recipe's, the rig's and the harm limits."""

    load_n: float
    wheel_speed_m_s: float
    belt_speed_m_s: float
    surface_c: float
    hub_c: float
    positions: Mapping[str, float]
    """Bounds of the positioned axes to either side, by name."""

    def within(self, other: Bounds) -> Bounds:
        """Return the lesser of each pair of bounds."""
        return Bounds(
            min(self.load_n, other.load_n),
            min(self.wheel_speed_m_s, other.wheel_speed_m_s),
            min(self.belt_speed_m_s, other.belt_speed_m_s),
            min(self.surface_c, other.surface_c),
            min(self.hub_c, other.hub_c),
            {name: min(most, other.positions[name]) for name, most in self.positions.items()},
        )


def rig_bounds(rig: RigConfig) -> Bounds:
    """Return the bounds of a rig, never beyond the harm limits."""
    limits = rig.limits
    return Bounds(
        min(limits.load_n, HARD_LOAD_N),
        limits.wheel_speed_m_s,
        limits.belt_speed_m_s,
        min(limits.surface_c, HARD_SURFACE_C),
        min(limits.jacket_c, rig.loops.heat.hub_max_c, HARD_HUB_C),
        limits.positions(),
    )


def confirmed_speed_m_s(p: Values) -> float:
    """Return the speed above which a drive is confirmed turning, m/s."""
    return 2.0 * p[STANDING_M_S]


def may_heat(state: WheelState, readings: Readings, p: Values) -> bool:
    """Return whether the jacket may heat: wheel seen turning for a while, both temperatures fresh and valid."""
    r, now = readings, readings.now_s
    return (
        now - state.turning_since_s >= p[TURNING_CONFIRMED_S]
        and r.jacket_valid
        and r.surface_valid
        and now - r.jacket_at_s <= p[STALE_JACKET_S]
        and now - r.surface_at_s <= p[STALE_IR_S]
    )


def may_load(state: WheelState, demand: Demand, readings: Readings, p: Values, most_n: float) -> bool:
    """Return whether the press may approach or press.

    Conditions: both speeds are confirmed and their difference is bounded, the angles are in place before touching, the
    measured load is fresh and the wanted load allowed. The drives' data are fresh, because stale data trip.
    """
    r = readings
    wheel, belt = r.wheel_speed_m_s, r.belt_speed_m_s
    confirmed_m_s, slip_m_s = confirmed_speed_m_s(p), p[MAX_SLIP_M_S]
    sideslip_deg = r.positions["sideslip"]
    along = wheel if sideslip_deg == 0.0 else wheel * cos(sideslip_deg * _RADIANS)
    return (
        wheel > confirmed_m_s
        and belt > confirmed_m_s
        and r.cell_valid
        and r.now_s - r.cell_at_s <= p[STALE_CELL_S]
        and (state.load.in_contact or r.yaw_reached)
        and -slip_m_s <= along - belt <= slip_m_s
        and demand.load_n <= most_n
    )
