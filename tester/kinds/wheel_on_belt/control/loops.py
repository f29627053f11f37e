"""The press: lift to clear, approach the wheel, hold the load.

The press is a velocity-controlled screw and the contact a stiff spring, so the path from velocity to force is an
integrator. A proportional law with the gain ``2 pi bandwidth / stiffness`` gives first-order settling; the integral
part only removes the slow drift from wear and thermal growth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import exp, inf, isfinite, log, nan, pi, sqrt
from typing import Final

from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.interlocks.contact_force import STIFFNESS_EXPONENT, UNLOADED_N, Contact
from tester.kinds.wheel_on_belt.interlocks.inputs import StopStart
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.loop_sections import HeatLoopConfig, LoadLoopConfig
from tester.machine.state import ControlState
from tester.machine.trend import TemperatureTrend

_INF: Final = inf
_LOAD: Final = Press.LOAD
_TURN: Final = 2.0 * pi
DECELERATION_SHARE: Final = 0.6
"""Share of ``loops.load.acceleration`` for profiles to a position, so that they end gently."""
POSITION_GAIN_PER_S: Final = 6.0
"""Gain of the final approach to a press position, mm/s per mm: slow compared with the drive's 30 ms lag [A]."""
HELD_BAND: Final = 0.03
"""Within this relative error the loop uses the slower holding bandwidth, which does not follow the runout."""


@dataclass(slots=True)
class LoadLoop(Contact):
    """State of the press control."""

    diameter_mm: float = nan
    """The wheel's diameter at its last first touch; it has worn since."""
    seen_open: bool = False
    """The contact has been open since the last touch: the next touch shows where the rubber begins."""
    integral_mm_s: float = 0.0
    error_n: float = 0.0
    """Load error, filtered over about one turn; decides between the fast and the holding bandwidth."""

    def forget_contact(self) -> None:
        """Forget the place of contact, since another wheel is installed."""
        self.contact_mm = nan

    def velocity(self, demand: Demand, readings: Readings, dt: float, loop: LoadLoopConfig) -> float:
        """Return the press velocity in mm/s (positive = towards the wheel) for this scan.

        With unknown force or position the press retracts.
        """
        force, position = readings.force_z_n, readings.press_mm
        if demand.press is not _LOAD or not (-_INF < force < _INF and -_INF < position < _INF):
            return self._lift(force, position, loop)
        # Comparisons: a call of min or max costs several times as much in every scan (CPython 3.11).
        load_n, change_n = demand.load_n, loop.follow_rate_n_s * dt
        highest_n, lowest_n = self.highest_n - change_n, self.lowest_n + change_n
        self.highest_n = highest_n if highest_n > load_n else load_n
        self.lowest_n = lowest_n if lowest_n < load_n else load_n
        self._track_contact(force, readings, loop)
        self.loaded = self.in_contact and (self.loaded or force >= 0.5 * load_n)
        if not self.in_contact:
            self.integral_mm_s = 0.0
            self.error_n = load_n
            return self._approach(demand, position, loop)
        return self._hold(demand, force, dt, loop)

    def lifted_mm(self, loop: LoadLoopConfig) -> float:
        """Return the lifted press position, mm: a clearance off the known contact, else fully back."""
        return max(0.0, self.contact_mm - loop.clearance_mm) if isfinite(self.contact_mm) else 0.0

    def _lift(self, force: float, position: float, loop: LoadLoopConfig) -> float:
        """Return the velocity to the lifted position; while the cell shows a load, to the end of the travel."""
        self.in_contact = self.loaded = False
        if force < loop.open_share * loop.touch_load_n:
            self.seen_open = True
        self.highest_n = self.lowest_n = 0.0
        self.integral_mm_s = 0.0
        if not isfinite(position):
            return -loop.lift_speed_mm_s
        distance = (self.lifted_mm(loop) if force < UNLOADED_N else 0.0) - position
        if distance >= 0.0:
            return min(distance * POSITION_GAIN_PER_S, loop.loading_speed_mm_s) if distance > 0.5 else 0.0
        return -min(loop.lift_speed_mm_s, _profile(-distance, loop), -distance * POSITION_GAIN_PER_S)

    def worn_to_mm(self, diameter_mm: float) -> float:
        """Return the place of contact of the wheel worn to this diameter, mm; NaN before its first touch."""
        worn = 0.5 * (self.diameter_mm - diameter_mm)
        return self.contact_mm + worn if worn > 0.0 else self.contact_mm

    def _track_contact(self, force: float, readings: Readings, loop: LoadLoopConfig) -> None:
        """Record a touch; its place counts only if the contact was open before, else the rubber begins elsewhere."""
        if force < loop.open_share * loop.touch_load_n:
            self.seen_open = True
        if not self.in_contact and force > loop.touch_load_n:
            self.in_contact = True
            if self.seen_open:
                self.contact_mm, self.diameter_mm = readings.press_mm, readings.diameter_mm
            self.seen_open = False
        elif self.in_contact and not self.loaded and force < 0.3 * loop.touch_load_n:
            self.in_contact = False

    def _approach(self, demand: Demand, position: float, loop: LoadLoopConfig) -> float:
        landing = min(
            loop.touch_speed_mm_s if demand.quick_touch else loop.loading_speed_mm_s,
            0.5 * demand.load_n * _gain(loop, loop.bandwidth_hz, 0.0),
        )
        if not isfinite(self.contact_mm):
            return landing
        distance = self.contact_mm - position
        if distance <= 0.0:
            return landing
        return min(
            loop.touch_speed_mm_s,
            sqrt(landing * landing + 2.0 * DECELERATION_SHARE * loop.acceleration_mm_s2 * distance),
        )

    def _hold(self, demand: Demand, force: float, dt: float, loop: LoadLoopConfig) -> float:
        error = demand.load_n - force
        self.error_n += (error - self.error_n) * (1.0 - exp(-dt / loop.error_filter_s))
        near = abs(self.error_n) < HELD_BAND * demand.load_n
        bandwidth = loop.rolling_bandwidth_hz if near else loop.bandwidth_hz
        gain = _gain(loop, bandwidth, force)
        limit = loop.touch_speed_mm_s if demand.quick_touch else loop.loading_speed_mm_s
        if near:  # farther off the integral would wind up
            integral, most = self.integral_mm_s + gain * self.error_n * dt / loop.integral_s, 0.1 * limit
            self.integral_mm_s = most if integral > most else -most if integral < -most else integral
        velocity = gain * error + self.integral_mm_s
        return limit if velocity > limit else -limit if velocity < -limit else velocity


def _gain(loop: LoadLoopConfig, bandwidth_hz: float, force_n: float) -> float:
    """Return the gain, mm/s per N, for ``bandwidth_hz`` at the contact's tangent stiffness."""
    stiffness = loop.stiffness_n_per_mm * math.pow((force_n if force_n > 20.0 else 20.0) / 200.0, STIFFNESS_EXPONENT)
    return _TURN * bandwidth_hz / stiffness


def _profile(distance_mm: float, loop: LoadLoopConfig) -> float:
    """Return the speed in mm/s from which the press can stop within ``distance_mm``."""
    return sqrt(2.0 * DECELERATION_SHARE * loop.acceleration_mm_s2 * distance_mm)


def loss_ratios(rig: RigConfig) -> tuple[float, float]:
    """Return the steady hub-surface difference per kelvin of surface above ambient: lifted, and in rolling contact.

    It is the resistance of hub joint and rubber times the surface's loss conductance, from the observer's parameters
    [A]. The rubber's side faces lose about half of their heat through the surface cells.
    """
    observer, thermal = rig.observer, rig.observer.thermal
    outer, width = 0.5e-3 * rig.geometry.wheel_diameter_mm, 1e-3 * rig.geometry.wheel_width_mm
    inner = outer - 1e-3 * observer.wheel.rubber_layer
    resistance = log(outer / inner) / (2.0 * pi * thermal.conductivity * width) + 1.0 / thermal.hub_to_rubber
    tread = thermal.film_rotating * 2.0 * pi * outer * width
    sides = thermal.film_sides * pi * (outer * outer - inner * inner)
    lifted = tread + sides
    return resistance * lifted, resistance * (lifted + observer.belt_conductance)


AMPLE_C: Final = 115.0
"""A hub setpoint that harms nothing even where the hub is hotter than shown by 30 % of its excess over air, degC."""
HUB_HEADROOM_K: Final = 2.5
"""Hub setpoint beyond the steady one, K [A]: for air some kelvin colder, and to reach the end of a heating."""


def hub_needed_c(rig: RigConfig, surface_c: float) -> float:
    """Return the highest hub setpoint that a condition at this surface temperature (degC) needs, degC.

    It is the steady one in rolling contact, where the loss is greatest, and HUB_HEADROOM_K; at least AMPLE_C. With a
    higher setpoint a wheel would heat sooner, and a hub hotter than its sensor shows would come to harm.
    """
    rolling_c = surface_c - rig.loops.heat.rolling_offset_k
    steady_c = rolling_c + max(0.0, rolling_c - rig.ambient_c) * loss_ratios(rig)[1]
    return max(AMPLE_C, steady_c + HUB_HEADROOM_K)


@dataclass(slots=True)
class HeatLoop:
    """State of the outer heat loop: surface error to hub setpoint."""

    hub_setpoint_c: float = 25.0
    target_c: float = float("nan")
    integral_k: float = 0.0
    due_s: float = float("-inf")

    def update(
        self,
        now: float,
        target_c: float,
        surface_c: float,
        ambient_c: float,
        loss_ratio: float,
        loop: HeatLoopConfig,
        *,
        touching: bool = True,
    ) -> float:
        """Return the hub setpoint in degC, recomputed once every ``loop.period_s``.

        ``loss_ratio`` is the steady hub-surface difference per kelvin of surface above ambient: the rubber's
        resistance times the surface's loss conductance (dimensionless). A target that moves within ``integral_band_k``
        keeps the integral, which holds the thermometer's bias and the friction heat.
        A lifted wheel, not ``touching``, leaves it alone: its error tells nothing of rolling.
        """
        if target_c != self.target_c:
            if not abs(target_c - self.target_c) <= loop.integral_band_k:
                self.integral_k = 0.0
            self.target_c = target_c
            self.due_s = now
        if now < self.due_s or not isfinite(surface_c):
            return self.hub_setpoint_c
        self.due_s = now + loop.period_s
        error = target_c - surface_c
        if touching and abs(error) < loop.integral_band_k:
            self.integral_k += loop.outer_gain * error * loop.period_s / loop.outer_integral_s
            self.integral_k = min(max(self.integral_k, -loop.integral_limit_k), loop.integral_limit_k)
        steady = target_c + max(0.0, target_c - ambient_c) * loss_ratio
        wanted = steady + loop.outer_gain * error + self.integral_k
        self.hub_setpoint_c = min(max(wanted, loop.hub_min_c), loop.hub_max_c)
        return self.hub_setpoint_c


class WheelState(ControlState[Setpoints]):
    """The state of ``WheelControl`` from one scan to the next: plain data, copyable."""

    def __init__(self, hub_min_c: float) -> None:
        """Begin in idle, with the hub's setpoint at its least, degC."""
        super().__init__(Setpoints())
        self.load = LoadLoop()
        self.heat = HeatLoop(hub_min_c)
        self.stop_start = StopStart()
        self.turning_since_s = inf
        """Time since which the wheel has been confirmed turning."""
        self.hub_ceiling: list[tuple[float, float]] = []
        """(time, hub setpoint) within ``runaway_window``, only falling setpoints: the first is the highest."""
        self.cooling = TemperatureTrend()
        """The hub's temperature in a cool-down."""
