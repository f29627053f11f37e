"""The plant: wheel, belt, contact, heat and sensors; friction and wear are in ``rubbing``.

``Plant.advance`` is called once a tick with the drives' positions and speeds at its end. Forces follow at once, heat in
its own steps. Every public attribute is the truth; the ``measured`` methods return the instruments' readings.
"""

from __future__ import annotations

import math
from dataclasses import replace
from math import cos, exp, inf, pi, sin, sqrt
from typing import Final

from sim.machines.wheel_on_belt.heat_flow import SAME_STEP_S, HeatFlow
from sim.machines.wheel_on_belt.rubbing import (
    Rubbing,
    WheelSetting,
    belt_named,
    condition_factor,
    run_factor,
    wheel_factor,
)
from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.noise import NormalStream, uniforms
from sim.physics.contact import ContactModel, Relaxation, Warmth
from sim.physics.parameters import SimParameters
from sim.physics.thermal import ThermalModel, ThermalState
from sim.sensors import SpeedSensor, TemperatureSensor

_TURN: Final = 2.0 * pi
_SAME_SIZE_K: Final = 0.005
"""Least change of the rubber's mean temperature that is applied, K: 0.02 um of radius, 0.002 % of stiffness."""


class Plant(Rubbing):
    """The physics of one rig, with a wheel after ``install``. Deep-copyable; all randomness is from one seed."""

    __slots__ = (
        "_cold_factor", "_dt", "_flow", "_grips", "_place", "_relaxation", "_rotating_above", "_seed", "_stiffness",
        "_swing_mm", "_warm_c", "_warmth", "belt_speed", "hub_sensor", "hung", "ir", "load_cell", "size",
        "wheel_angle_rev", "wheel_speed",
    )  # fmt: skip

    def __init__(self, parameters: SimParameters, seed: int) -> None:
        """Build a rig at ambient temperature without a wheel; draw the numbers that stay for the session."""
        super().__init__(parameters, seed)
        p = parameters
        self._seed = seed
        self._grips: dict[str, float] = {}
        """Share of its grip that each belt had left when it was taken off."""
        contact = ContactModel(p.contact)
        self._stiffness = (contact.factor, contact.exponent, contact.damping_n_s_mm)
        self._cold_factor = contact.factor
        self._warmth = Warmth(p)
        self._warm_c = inf
        self._relaxation: Relaxation | None = None
        self.size = 1.0
        self.set_runout(p.contact.runout)
        self._rotating_above = p.thermal.rotating_above
        self._dt = 0.0
        self.set_relaxation(p.relaxation * p.contact.relaxation)
        self._build_sensors()
        self.hung: tuple[float, float, float] | None = None
        """Forces of a weight that a person has hung on the load cell, N."""
        model = ThermalModel(p.wheel, p.thermal, p.friction_heat_fraction, p.belt_conductance)
        self._flow = HeatFlow(model, p.ambient, self.hub_sensor, self.load_cell)
        self._place: tuple[int, ...] = ()
        self._mount(p.wheel.outer_diameter, 0.0)
        self._touch_mm = inf  # nothing to touch before a wheel is installed
        self._key_streams()

    def _build_sensors(self) -> None:
        """Create the sensors with the imperfections of this session."""
        s, noise, seed = self.parameters.sensors, self.parameters.noise, self._seed
        sign = -1.0 if self.parameters.mirrored else 1.0
        bias, wheel, belt = (sign * u for u in uniforms(3, seed, "session"))
        unused = NormalStream(seed, "unused")  # _key_streams gives each sensor its own
        self.load_cell = LoadCellSensor(s, noise, seed, self.parameters.ambient, sign)
        self.ir = TemperatureSensor(s.ir_time, noise * s.ir_rms, noise * s.ir_bias * bias, unused)
        self.hub_sensor = TemperatureSensor(s.hub_time, noise * s.hub_rms, 0.0, unused)
        self.wheel_speed = SpeedSensor(1.0 + noise * s.speed_scale * wheel, noise * s.speed_rms, unused)
        self.belt_speed = SpeedSensor(1.0 + noise * s.speed_scale * belt, noise * s.speed_rms, unused)

    def _key_streams(self) -> None:
        """Start every stream of noise anew at the present place (none, wheel or repeat)."""
        seed, place = self._seed, self._place
        self._noise = NormalStream(seed, "within", *place)
        self.load_cell.noise = NormalStream(seed, "cell", *place)
        self.ir.noise = NormalStream(seed, "ir", *place)
        self.hub_sensor.noise = NormalStream(seed, "hub", *place)
        self.wheel_speed.noise = NormalStream(seed, "wheel speed", *place)
        self.belt_speed.noise = NormalStream(seed, "belt speed", *place)
        self._within.restart(self._noise.next())
        if self._stick_slip is not None:
            self._stick_slip.restart(NormalStream(seed, "stick-slip", *place))

    def _mount(self, diameter_mm: float, sliding_m: float) -> None:
        """Mount a wheel at ambient temperature, out of contact."""
        self._flow.state.set_rubber(self.parameters.ambient)
        self._flow.restart()
        self.surface_c = self.parameters.ambient
        self.cold_mm = self.diameter_mm = self.size * diameter_mm
        self._touch_mm = self._place_of_touch_mm()
        self._warm_c = inf  # heat effects of the last wheel do not count
        if self._relaxation is not None:
            self._relaxation.forget()
        self.sliding_m = sliding_m
        self.wheel_angle_rev = 0.0
        self.slip_m_s = 0.0
        self.ir.reset(self.surface_c)
        self._release()

    def install(
        self,
        specimen: int,
        wheel: int,
        compound: str,
        new_specimen: bool,
        diameter_mm: float | None = None,
        sliding_m: float = 0.0,
    ) -> None:
        """Mount a wheel: rubber at ambient temperature, out of contact.

        ``specimen`` and ``wheel`` (0 and up) key the wheel's scatter. With ``new_specimen`` hub, belt and
        load cell start at ambient temperature as well; otherwise they keep their temperatures. A resumed run passes the
        wheel's earlier ``diameter_mm`` (at ambient temperature) and sliding distance in m; by default the wheel is
        new. Raises the exceptions of ``wheel_law``.
        """
        p = self.parameters
        self._take(compound)
        self._compound = compound
        self._yaw(self._sideslip_deg)
        if new_specimen:
            self.heat.set_all(p.ambient)
            self.load_cell.set_temperature(p.ambient)
        self._mount(p.wheel.outer_diameter if diameter_mm is None else diameter_mm, sliding_m)
        self.wheel_factor = wheel_factor(p, self._seed, specimen, wheel)
        self.condition_factor = self.run_factor = 1.0
        self._scatter = self.belt.factor * self.wheel_factor * self._grip
        self._place = (specimen, wheel)
        self._key_streams()

    def cover(self, surface: str) -> None:
        """Put a belt of this name on, at ambient temperature, with the wear that it has from before.

        Raises the exceptions of ``wheel_law``, for a law that is made of the surface.
        """
        p = self.parameters
        self._grips[self.belt.name] = self.belt_grip
        self.setting = replace(self.setting, surface=surface)
        self.belt = belt_named(p, self._seed, surface)
        self.belt_grip = self._grips.get(surface, 1.0)
        self.heat.belt_c = p.ambient
        self.set_grip(self._grip)
        if self._compound:
            self._take(self._compound)
            self._touch_mm = self._place_of_touch_mm()

    def _place_of_touch_mm(self) -> float:
        """Return the position of the press at which wheel and belt touch."""
        p = self.parameters
        return p.contact.gap + 0.5 * (p.wheel.outer_diameter - self.diameter_mm) - self.belt.thicker_mm

    def begin_repeat(self, condition: int, repeat: int, attempt: int, setting: WheelSetting) -> None:
        """Draw the scatter of a setting and of a repeat, and start the repeat's noise streams; all numbers 0 and up.

        Raises RuntimeError when no wheel is installed.
        """
        if not self._compound:
            raise RuntimeError("a repeat needs a wheel: install one first")
        specimen, wheel = self._place[:2]
        place = (specimen, wheel, condition, repeat, attempt)
        self.condition_factor = condition_factor(self.parameters, self._seed, self._compound, setting)
        self.run_factor = run_factor(self.parameters, self._seed, *place)
        self.set_grip(self._grip)
        self._place = place
        self._key_streams()

    def set_runout(self, runout_mm: float) -> None:
        """Set the swing of the tread, peak to peak in mm, once a turn."""
        self._swing_mm = 0.5 * runout_mm

    def set_relaxation(self, share: float) -> None:
        """Set the share of the load that the contact loses in a decade of time, 0 to 0.15, from now on."""
        if self._relaxation is not None and share > 0.0:
            self._relaxation.change(share)
            return
        self._relaxation = Relaxation(share) if share > 0.0 else None
        if self._relaxation is not None and self._dt > 0.0:
            self._relaxation.retime(self._dt)

    def set_size(self, share: float) -> None:
        """Set the diameter of this and every later wheel as a share of the right one; out of contact only."""
        self.cold_mm *= share / self.size
        self.size = share
        self._grow(self._flow.rubber_c)

    def _grow(self, rubber_c: float) -> None:
        """Update the wheel's size and stiffness for its temperatures."""
        self._warm_c = rubber_c
        if not (self._warmth.matters or self.size != 1.0) or not self._compound:
            return
        warmth = self._warmth
        _, exponent, damping = self._stiffness
        self._stiffness = (self._cold_factor * warmth.stiffness_share(rubber_c), exponent, damping)
        grown_mm = warmth.growth_mm(rubber_c, self._flow.state.hub_c, self.cold_mm)
        self.diameter_mm = self.cold_mm + 2.0 * grown_mm
        self._touch_mm = self._place_of_touch_mm()

    def advance(
        self,
        dt: float,
        wheel_rad_s: float,
        belt_m_s: float,
        press_mm: float,
        press_mm_s: float,
        sideslip_deg: float,
        heater_w: float,
    ) -> None:
        """Advance by ``dt`` s, 1 to 100 ms; speeds and positions are those at the end, the heater's power is the mean.

        ``press_mm`` is 0 when fully lifted and grows towards the wheel.
        """
        if not -SAME_STEP_S < dt - self._dt < SAME_STEP_S:
            self._retime(dt)
        if sideslip_deg != self._sideslip_deg:
            self._yaw(sideslip_deg)
        flow = self._flow
        if not -_SAME_SIZE_K < flow.rubber_c - self._warm_c < _SAME_SIZE_K:
            self._grow(flow.rubber_c)
        self.wheel_angle_rev = turns = self.wheel_angle_rev + wheel_rad_s * dt / _TURN
        wheel_m_s = 0.0005 * self.diameter_mm * wheel_rad_s
        vx, vy = wheel_m_s - belt_m_s * self._cos, belt_m_s * self._sin
        self.slip_m_s = sqrt(vx * vx + vy * vy)
        power_w = load_n = 0.0
        depth_mm, swing, relaxation = press_mm - self._touch_mm, self._swing_mm, self._relaxation
        angle = _TURN * turns
        if depth_mm > -swing:
            depth_mm += swing * sin(angle)
        if depth_mm > 0.0:
            factor, exponent, damping = self._stiffness
            load_n = factor * math.pow(depth_mm, exponent)
            if relaxation is not None:
                load_n = relaxation.load_n(load_n)
            load_n += damping * (press_mm_s + swing * wheel_rad_s * cos(angle))
        elif relaxation is not None:
            relaxation.rest(dt)
        if load_n > 0.0:
            if self._blunts:
                self.travel(abs(belt_m_s * dt), self.surface_c)
            power_w = self._rub(dt, load_n, vx, vy)
        elif self.force_z_n > 0.0:
            self._release()
        turning = abs(wheel_m_s) > self._rotating_above
        self.surface_c = surface_c = flow.advance(dt, heater_w, power_w, load_n > 0.0, turning)
        ir = self.ir  # its ``follow``, without the call
        ir.lagged_c += (surface_c - ir.lagged_c) * ir.gain

    def _retime(self, dt: float) -> None:
        """Prepare the values that depend on the length of a tick alone."""
        self._dt = dt
        if self._relaxation is not None:
            self._relaxation.retime(dt)
        self._within.retime(dt)
        self.ir.retime(dt)
        self._deficit_keep = exp(-dt / self.parameters.friction.touch_time)

    def press_at_mm(self, load_n: float) -> float:
        """Return the position of the press under a load of at least 0 N, now and at rest, mm."""
        factor, exponent, _ = self._stiffness
        lost_n = self._relaxation.lost_n if self._relaxation is not None else 0.0
        depth_mm = math.pow((load_n + lost_n) / factor, 1.0 / exponent)
        return self._touch_mm + depth_mm - self._swing_mm * sin(_TURN * self.wheel_angle_rev)

    @property
    def heat(self) -> ThermalState:
        """True temperatures."""
        return self._flow.state

    @property
    def hub_c(self) -> float:
        """True temperature of the hub in degC."""
        return self.heat.hub_c

    @property
    def belt_c(self) -> float:
        """True temperature of the belt in degC."""
        return self.heat.belt_c

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return the load cell's present readings (Fx, Fy, Fz in N, moment in N m); ``t`` is the time of asking."""
        fy = self.force_y_n
        if self.hung is not None:
            x, y, z = self.hung
            return self.load_cell.measure(self.force_x_n + x, fy + y, self.force_z_n + z, self._arm_m * fy)
        return self.load_cell.measure(self.force_x_n, fy, self.force_z_n, self._arm_m * fy)

    def surface_measured_c(self, t: float) -> float:
        """Return the infrared thermometer's present reading, in degC; ``t`` is the time of asking."""
        return self.ir.measure()

    def controller_measured_c(self, t: float) -> float:
        """Return the present reading of the hub's sensor, in degC; ``t`` is the time of asking."""
        return self.hub_sensor.measure()
