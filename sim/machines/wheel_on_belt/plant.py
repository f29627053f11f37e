"""The plant: wheel, belt, contact, heat, wear and what the sensors see of them.

``Plant.advance`` is called once a tick with where the drives are at its end; forces follow at once, heat in
steps of its own. Forces are those on the belt in the wheel's frame: Fx along the wheel's plane (above 0
when the wheel drives), Fy across it, Fz the load. Every public attribute is the truth; the ``measured``
methods are what instruments make of it. ``diameter_mm`` is the wheel's as it is, grown by its heat; ``cold_mm`` that
at ambient temperature, which a calliper would find: wear takes from it.
"""

from __future__ import annotations

import math
from math import cos, exp, inf, pi, radians, sin, sqrt
from typing import Final

from sim.machines.wheel_on_belt.heat_flow import SAME_STEP_S, HeatFlow
from sim.machines.wheel_on_belt.scatter import WheelSetting, condition_factor, run_factor, wheel_factor
from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.noise import Autoregressive, NormalStream, StickSlip, uniforms
from sim.physics import laws
from sim.physics.contact import ContactModel, Relaxation, Warmth
from sim.physics.parameters import SimParameters
from sim.physics.slip import cornering_factor, traction_direction
from sim.physics.thermal import ThermalModel, ThermalState
from sim.sensors import SpeedSensor, TemperatureSensor

_TURN: Final = 2.0 * pi
_SAME_SIZE_K: Final = 0.005
"""A change of the rubber's mean temperature that is waited for: 0.02 um of radius, 0.002 % of stiffness."""
_RUNNING_IN_LASTS: Final = 37.0
"""Running-in distances after which its factor is 1 to the last bit: exp(-37) is less than 2^-53."""


class Plant:
    """The physics of one rig, with a wheel on it after ``install``. Deep-copyable; all randomness from one seed."""

    __slots__ = (
        "_arm_m",
        "_blunts",
        "_cold_factor",
        "_compound",
        "_cornering",
        "_cos",
        "_deficit",
        "_deficit_keep",
        "_dt",
        "_excess",
        "_flow",
        "_friction",
        "_grip",
        "_law",
        "_noise",
        "_place",
        "_relaxation",
        "_rotating_above",
        "_run_in_m",
        "_run_in_scale_m",
        "_scatter",
        "_seed",
        "_sideslip_deg",
        "_sin",
        "_stick_slip",
        "_stiffness",
        "_swing_mm",
        "_touch_mm",
        "_warm_c",
        "_warmth",
        "_wear_per_width",
        "_within",
        "belt_grip",
        "belt_speed",
        "cold_mm",
        "condition_factor",
        "diameter_mm",
        "drive_torque_nm",
        "force_x_n",
        "force_y_n",
        "force_z_n",
        "hub_sensor",
        "hung",
        "ir",
        "load_cell",
        "mu",
        "parameters",
        "run_factor",
        "size",
        "sliding_m",
        "slip_m_s",
        "surface_c",
        "wheel_angle_rev",
        "wheel_factor",
        "wheel_speed",
    )  # fmt: skip

    def __init__(self, parameters: SimParameters, seed: int) -> None:
        """Build a rig at ambient temperature without a wheel; draw what stays the same for the session."""
        p = parameters
        self.parameters = p
        self._seed = seed
        contact = ContactModel(p.contact)
        self._stiffness = (contact.factor, contact.exponent, contact.damping_n_s_mm)
        self._cold_factor = contact.factor
        self._warmth = Warmth(p)
        self._warm_c = inf
        self._relaxation: Relaxation | None = None
        self.size = 1.0
        self.set_runout(p.contact.runout)
        self._arm_m = 0.001 * p.friction.aligning_arm
        self._rotating_above = p.thermal.rotating_above
        self._within = Autoregressive(p.scatter * p.variability.within, p.variability.within_time)
        self._stick_slip: StickSlip | None = None
        if p.stick_slip > 0.0:
            self._stick_slip = StickSlip(p.stick_slip, p.stick_slip_frequency, NormalStream(seed, "unused"))
        self._grip = 1.0
        self._blunts = p.counterface.loss > 0.0
        self.belt_grip = 1.0
        """What the belt has left of the grip that it began with; wheels come and go on it."""
        self._dt, self._deficit_keep = 0.0, 1.0
        self.set_relaxation(p.relaxation * p.contact.relaxation)
        self._sideslip_deg, self._cos, self._sin, self._cornering = 0.0, 1.0, 0.0, 1.0
        self._build_sensors()
        self.hung: tuple[float, float, float] | None = None
        """What a person has hung on the load cell, N."""
        model = ThermalModel(p.wheel, p.thermal, p.friction_heat_fraction, p.belt_conductance)
        self._flow = HeatFlow(model, p.ambient, self.hub_sensor, self.load_cell)
        self._compound = ""
        self._friction, self._run_in_scale_m = p.friction, p.abrasion.running_in_distance
        self._take("1#")
        self._place: tuple[int, ...] = ()
        self.wheel_factor = self.condition_factor = self.run_factor = self._scatter = 1.0
        self._mount(p.wheel.outer_diameter, 0.0)
        self._touch_mm = inf  # nothing to touch before a wheel is installed
        self._key_streams()

    def _take(self, compound: str) -> None:
        """Take the law of a compound, and what running-in and wear make of the parameters."""
        p = self.parameters
        a = p.abrasion
        self._law = laws.make(p.friction_model, compound)
        self._excess = p.running_in * a.running_in_excess
        self._run_in_m = _RUNNING_IN_LASTS * a.running_in_distance if self._excess > 0.0 else 0.0
        self._wear_per_width = p.wear * a.wear_rate / (pi * p.wheel.width)

    def _build_sensors(self) -> None:
        """Make the sensors with the imperfections of this session."""
        s, noise, seed = self.parameters.sensors, self.parameters.noise, self._seed
        sign = -1.0 if self.parameters.mirrored else 1.0
        bias, wheel, belt = (sign * u for u in uniforms(3, seed, "session"))
        unused = NormalStream(seed, "unused")  # _key_streams gives each its own
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
        """Put a wheel of ambient temperature on, out of contact."""
        wheel = self.parameters.wheel
        self._flow.state.set_rubber(self.parameters.ambient)
        self._flow.restart()
        self.surface_c = self.parameters.ambient
        self.cold_mm = self.diameter_mm = self.size * diameter_mm
        self._touch_mm = self.parameters.contact.gap + 0.5 * (wheel.outer_diameter - self.diameter_mm)
        self._warm_c = inf  # whatever the heat has done to the last one
        if self._relaxation is not None:
            self._relaxation.forget()
        self.sliding_m = sliding_m
        self.wheel_angle_rev = 0.0
        self.slip_m_s = 0.0
        self.ir.reset(self.surface_c)
        self._release()

    def _release(self) -> None:
        """Take all force off; the next touch builds friction up anew."""
        self.mu = 0.0
        self.force_x_n = self.force_y_n = self.force_z_n = 0.0
        self.drive_torque_nm = 0.0
        self._deficit = self.parameters.friction.touch_deficit

    def install(
        self,
        specimen: int,
        wheel: int,
        compound: str,
        new_specimen: bool,
        diameter_mm: float | None = None,
        sliding_m: float = 0.0,
    ) -> None:
        """Put a wheel on: rubber at ambient temperature, out of contact.

        ``specimen`` and ``wheel`` (0 and up) key the wheel's scatter. ``new_specimen`` starts hub, belt and
        load cell at ambient temperature too; otherwise they keep theirs. A resumed run gives the
        ``diameter_mm`` (at ambient temperature) and the sliding distance in m that the wheel had; by default it is
        new. Raises UnknownCompoundError.
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
        self._scatter = self.wheel_factor * self._grip
        self._place = (specimen, wheel)
        self._key_streams()

    def begin_repeat(self, condition: int, repeat: int, attempt: int, setting: WheelSetting) -> None:
        """Draw the scatter of a setting and of a repeat, and start its streams of noise; all numbers 0 and up.

        Raises RuntimeError when no wheel is installed.
        """
        if not self._compound:
            raise RuntimeError("a repeat needs a wheel: install one first")
        specimen, wheel = self._place[:2]
        place = (specimen, wheel, condition, repeat, attempt)
        self.condition_factor = condition_factor(self.parameters, self._seed, self._compound, setting)
        self.run_factor = run_factor(self.parameters, self._seed, *place)
        self._scatter = self.wheel_factor * self.condition_factor * self.run_factor * self._grip
        self._place = place
        self._key_streams()

    def truth(self, temperature_c: float, load_n: float, slip_m_s: float, sideslip_deg: float) -> dict[str, float]:
        """Return what makes the coefficient of the repeat that has begun, and the state that it begins in.

        ``model``: of the compound at these setpoints; times ``condition`` and ``wheel`` it is this wheel's coefficient
        in this condition on the belt as it was at first, times ``belt`` on the belt as it is, times ``run`` this
        repeat's, before noise, running-in and wear.
        """
        model = self._law.mu(temperature_c, load_n, slip_m_s) * cornering_factor(self._compound, sideslip_deg)
        return {
            "model": model,
            "condition": self.condition_factor,
            "wheel": self.wheel_factor,
            "run": self.run_factor,
            "belt": self.belt_grip,
            "surface_c": self.surface_c,
            "diameter_mm": self.diameter_mm,
        }

    def set_grip(self, share: float) -> None:
        """Let the belt transmit this share of the friction from now on: 1 as at first, 0 torn, above 1 sharper."""
        self._grip = share
        self._scatter = self.wheel_factor * self.condition_factor * self.run_factor * share

    def travel(self, travel_m: float, surface_c: float) -> None:
        """Let the belt travel under load, m, below rubber of a surface temperature, degC: it goes blunt and clogs."""
        self.belt_grip *= self.parameters.counterface.grip_kept(travel_m, surface_c)

    def set_runout(self, runout_mm: float) -> None:
        """Let the tread swing by this much, peak to peak in mm, once a turn."""
        self._swing_mm = 0.5 * runout_mm

    def set_relaxation(self, share: float) -> None:
        """Let the contact lose this share of its load in a decade of time, 0 to 0.15, from now on."""
        if self._relaxation is not None and share > 0.0:
            self._relaxation.change(share)
            return
        self._relaxation = Relaxation(share) if share > 0.0 else None
        if self._relaxation is not None and self._dt > 0.0:
            self._relaxation.retime(self._dt)

    def set_size(self, share: float) -> None:
        """Have a wheel on of another diameter than it should be, and every one from now on; out of contact only."""
        self.cold_mm *= share / self.size
        self.size = share
        self._grow(self._flow.rubber_c)

    def _grow(self, rubber_c: float) -> None:
        """Take over what the wheel's temperatures do to its size and stiffness."""
        self._warm_c = rubber_c
        if not (self._warmth.matters or self.size != 1.0) or not self._compound:
            return
        warmth, contact = self._warmth, self.parameters.contact
        _, exponent, damping = self._stiffness
        self._stiffness = (self._cold_factor * warmth.stiffness_share(rubber_c), exponent, damping)
        grown_mm = warmth.growth_mm(rubber_c, self._flow.state.hub_c, self.cold_mm)
        self.diameter_mm = self.cold_mm + 2.0 * grown_mm
        self._touch_mm = contact.gap + 0.5 * (self.parameters.wheel.outer_diameter - self.diameter_mm)

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
        """Move on by ``dt`` s, 1 to 100 ms, with speeds and positions as at its end and the heater's mean power.

        ``press_mm`` is 0 when fully lifted and grows towards the wheel.
        """
        if not -SAME_STEP_S < dt - self._dt < SAME_STEP_S:
            self._retime(dt)
        if sideslip_deg != self._sideslip_deg:
            self._yaw(sideslip_deg)
        if not -_SAME_SIZE_K < self._flow.rubber_c - self._warm_c < _SAME_SIZE_K:
            self._grow(self._flow.rubber_c)
        self.wheel_angle_rev = turns = self.wheel_angle_rev + wheel_rad_s * dt / _TURN
        wheel_m_s = 0.0005 * self.diameter_mm * wheel_rad_s
        vx = wheel_m_s - belt_m_s * self._cos
        vy = belt_m_s * self._sin
        self.slip_m_s = sqrt(vx * vx + vy * vy)

        power_w = load_n = 0.0
        depth_mm, swing, relaxation = press_mm - self._touch_mm, self._swing_mm, self._relaxation
        if depth_mm > -swing:
            angle = _TURN * turns
            depth_mm += swing * sin(angle)
        if depth_mm > 0.0:
            factor, exponent, damping = self._stiffness
            load_n = factor * math.pow(depth_mm, exponent)
            if relaxation is not None:
                load_n = relaxation.load_n(load_n)
            load_n += damping * (press_mm_s + swing * wheel_rad_s * cos(_TURN * turns))
        elif relaxation is not None:
            relaxation.rest(dt)
        if load_n > 0.0:
            if self._blunts:
                self.travel(abs(belt_m_s * dt), self.surface_c)
            power_w = self._rub(dt, load_n, vx, vy)
        elif self.force_z_n > 0.0:
            self._release()

        above = self._rotating_above
        self.surface_c = surface_c = self._flow.advance(
            dt, heater_w, power_w, load_n > 0.0, wheel_m_s > above or wheel_m_s < -above
        )
        ir = self.ir
        ir.lagged_c += (surface_c - ir.lagged_c) * ir.gain  # as ``follow`` does

    def _retime(self, dt: float) -> None:
        """Prepare what depends on the length of a tick alone."""
        self._dt = dt
        if self._relaxation is not None:
            self._relaxation.retime(dt)
        self._within.retime(dt)
        self.ir.retime(dt)
        self._deficit_keep = exp(-dt / self.parameters.friction.touch_time)

    def _yaw(self, sideslip_deg: float) -> None:
        """Prepare what depends on the sideslip angle alone."""
        self._sideslip_deg = sideslip_deg
        angle = radians(sideslip_deg)
        self._cos, self._sin = cos(angle), sin(angle)
        self._cornering = cornering_factor(self._compound, sideslip_deg) if self._compound else 1.0

    def _rub(self, dt: float, load_n: float, vx: float, vy: float) -> float:
        """Set the forces of a loaded contact, wear the tread and return the friction power in W."""
        friction, slip_m_s = self._friction, self.slip_m_s
        floor_n = friction.load_floor
        mu = self._law.mu(self.surface_c, load_n if load_n > floor_n else floor_n, slip_m_s)
        within = self._within
        if within.kick:
            within.value = within.keep * within.value + within.kick * self._noise.next()
        mu *= self._cornering * self._scatter * (1.0 + within.value)
        sliding_m = self.sliding_m
        if sliding_m < self._run_in_m:
            mu *= 1.0 + self._excess * exp(-sliding_m / self._run_in_scale_m)
        if self._blunts:
            mu *= self.belt_grip
        if self._stick_slip is not None and slip_m_s > friction.creep:
            mu *= self._stick_slip.factor(dt)
        mu *= 1.0 - self._deficit
        self._deficit *= self._deficit_keep

        self.mu = mu
        friction_n = mu * load_n
        creep, reversal = friction.creep, friction.reversal_width
        if vy == 0.0:
            along = vx + creep / (1.0 + slip_m_s * slip_m_s / (creep * creep))
            cx, cy = 1.0 if along >= reversal else -1.0 if along <= -reversal else along / reversal, 0.0
        else:
            cx, cy = traction_direction(vx, vy, creep, reversal)
        self.force_x_n, self.force_y_n, self.force_z_n = friction_n * cx, friction_n * cy, load_n
        diameter_mm = self.diameter_mm
        self.drive_torque_nm = 0.0005 * diameter_mm * friction_n * cx

        slid_m = slip_m_s * dt
        self.sliding_m = sliding_m + slid_m
        worn_mm = self._wear_per_width * load_n * slid_m / diameter_mm
        self.diameter_mm = diameter_mm - 2.0 * worn_mm
        self.cold_mm -= 2.0 * worn_mm
        self._touch_mm += worn_mm
        return friction_n * slip_m_s

    def press_at_mm(self, load_n: float) -> float:
        """Return where the press would stand now under a load of at least 0 N, at rest, mm."""
        factor, exponent, _ = self._stiffness
        lost_n = self._relaxation.lost_n if self._relaxation is not None else 0.0
        depth_mm = math.pow((load_n + lost_n) / factor, 1.0 / exponent)
        return self._touch_mm + depth_mm - self._swing_mm * sin(_TURN * self.wheel_angle_rev)

    @property
    def heat(self) -> ThermalState:
        """True temperatures."""
        return self._flow.state

    @property
    def moment_z_nm(self) -> float:
        """True aligning moment in N m."""
        return self._arm_m * self.force_y_n

    @property
    def belt_force_n(self) -> float:
        """True force on the belt along its travel, in N."""
        return self.force_x_n * self._cos - self.force_y_n * self._sin

    @property
    def hub_c(self) -> float:
        """True temperature of the hub in degC."""
        return self.heat.hub_c

    @property
    def belt_c(self) -> float:
        """True temperature of the belt in degC."""
        return self.heat.belt_c

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return what the load cell reads now (Fx, Fy, Fz in N, moment in N m); ``t`` is the time of asking."""
        fy = self.force_y_n
        if self.hung is not None:
            x, y, z = self.hung
            return self.load_cell.measure(self.force_x_n + x, fy + y, self.force_z_n + z, self._arm_m * fy)
        return self.load_cell.measure(self.force_x_n, fy, self.force_z_n, self._arm_m * fy)

    def surface_measured_c(self, t: float) -> float:
        """Return what the infrared thermometer reads now, in degC; ``t`` is the time of asking."""
        return self.ir.measure()

    def controller_measured_c(self, t: float) -> float:
        """Return what the hub's sensor reads now, in degC; ``t`` is the time of asking."""
        return self.hub_sensor.measure()
