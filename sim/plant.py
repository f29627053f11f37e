"""The plant: wheel, belt, contact, heat, wear and what the sensors see of them.

``Plant.advance`` is called once a tick with where the drives are at its end; forces follow at once, heat in
steps of its own. Forces are those on the belt in the wheel's frame: Fx along the wheel's plane (above 0
when the wheel drives), Fy across it, Fz the load. Every public attribute is the truth; the ``measured``
methods are what instruments make of it.
"""

from __future__ import annotations

import math

from sim.contact import ContactModel
from sim.friction import FrictionModel
from sim.noise import Autoregressive, NormalStream, condition_factor, run_factor, uniforms, wheel_factor
from sim.parameters import SimParameters
from sim.sensors import LoadCellSensor, SpeedSensor, TemperatureSensor
from sim.slip import cornering_factor, traction_direction
from sim.thermal import ThermalModel
from sim.wear import radius_loss_mm, running_in_factor

_TURN = 2.0 * math.pi

_SAME_STEP_S = 1e-9
"""Ticks whose lengths differ by less share their step constants: a float clock's differences are never quite equal."""


class Plant:
    """The physics of one rig, with a wheel on it after ``install``. Deep-copyable; all randomness from one seed."""

    __slots__ = (
        "_compound",
        "_contact",
        "_cornering",
        "_cos",
        "_deficit",
        "_deficit_keep",
        "_dt",
        "_friction",
        "_friction_j",
        "_heater_j",
        "_noise",
        "_place",
        "_rotating_above",
        "_running_in",
        "_scatter",
        "_seed",
        "_sideslip_deg",
        "_sin",
        "_swing_mm",
        "_thermal",
        "_thermal_s",
        "_touch_mm",
        "_touch_s",
        "_wear_rate",
        "_within",
        "belt_force_n",
        "belt_speed",
        "camber_deg",
        "condition_factor",
        "diameter_mm",
        "drive_torque_nm",
        "force_x_n",
        "force_y_n",
        "force_z_n",
        "heat",
        "hub_sensor",
        "ir",
        "load_cell",
        "moment_z_nm",
        "mu",
        "parameters",
        "run_factor",
        "sliding_m",
        "slip_m_s",
        "surface_c",
        "wheel_angle_rev",
        "wheel_factor",
        "wheel_speed",
    )

    def __init__(self, parameters: SimParameters, seed: int) -> None:
        """Build a rig at ambient temperature without a wheel; draw what stays the same for the session."""
        p = parameters
        self.parameters = p
        self._seed = seed
        self._contact = ContactModel(p.contact)
        self._swing_mm = 0.5 * p.contact.runout
        self._thermal = ThermalModel(p.wheel, p.thermal, p.friction_heat_fraction, p.belt_conductance)
        self._rotating_above = p.thermal.rotating_above
        self._running_in = p.running_in * p.abrasion.running_in_excess
        self._wear_rate = p.wear * p.abrasion.wear_rate
        self._within = Autoregressive(p.scatter * p.variability.within, p.variability.within_time)
        self._dt, self._deficit_keep = 0.0, 1.0
        self._sideslip_deg, self._cos, self._sin, self._cornering = 0.0, 1.0, 0.0, 1.0
        self.camber_deg = 0.0
        self._build_sensors()
        self.heat = self._thermal.state(p.ambient)
        self._compound = ""
        self._friction = FrictionModel("1#", p.friction_model)
        self._place: tuple[int, ...] = ()
        self.wheel_factor = self.condition_factor = self.run_factor = self._scatter = 1.0
        self._mount(p.wheel.outer_diameter, 0.0)
        self._touch_mm = math.inf  # nothing to touch before a wheel is installed
        self._key_streams()

    def _build_sensors(self) -> None:
        """Make the sensors with the imperfections of this session."""
        s, noise, seed = self.parameters.sensors, self.parameters.noise, self._seed
        bias, wheel, belt = uniforms(3, seed, "session")
        unused = NormalStream(seed, "unused")  # _key_streams gives each its own
        self.load_cell = LoadCellSensor(s, noise, seed, self.parameters.ambient)
        self.ir = TemperatureSensor(s.ir_time, noise * s.ir_rms, noise * s.ir_bias * bias, unused)
        self.hub_sensor = TemperatureSensor(s.hub_time, noise * s.hub_rms, 0.0, unused)
        self.hub_sensor.retime(self._thermal.step_s)
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

    def _mount(self, diameter_mm: float, sliding_m: float) -> None:
        """Put a wheel of ambient temperature on, out of contact."""
        wheel = self.parameters.wheel
        self.heat.set_rubber(self.parameters.ambient)
        self.surface_c = self.parameters.ambient
        self.diameter_mm = diameter_mm
        self._touch_mm = self.parameters.contact.gap + 0.5 * (wheel.outer_diameter - diameter_mm)
        self.sliding_m = sliding_m
        self.wheel_angle_rev = 0.0
        self.slip_m_s = 0.0
        self._thermal_s = self._touch_s = self._heater_j = self._friction_j = 0.0
        self.ir.reset(self.surface_c)
        self.hub_sensor.reset(self.heat.hub_c)
        self._release()

    def _release(self) -> None:
        """Take all force off; the next touch builds friction up anew."""
        self.mu = 0.0
        self.force_x_n = self.force_y_n = self.force_z_n = 0.0
        self.moment_z_nm = self.drive_torque_nm = self.belt_force_n = 0.0
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
        ``diameter_mm`` and the sliding distance in m that the wheel had; by default it is new. Raises
        UnknownCompoundError.
        """
        p = self.parameters
        self._friction = FrictionModel(compound, p.friction_model)
        self._compound = compound
        self._yaw(self._sideslip_deg)
        if new_specimen:
            self.heat = self._thermal.state(p.ambient)
            self.load_cell.set_temperature(p.ambient)
        self._mount(p.wheel.outer_diameter if diameter_mm is None else diameter_mm, sliding_m)
        self.wheel_factor = self._scatter = wheel_factor(p, self._seed, specimen, wheel)
        self.condition_factor = self.run_factor = 1.0
        self._place = (specimen, wheel)
        self._key_streams()

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Draw the scatter of a repeat and start its streams of noise; all numbers 0 and up.

        Raises RuntimeError when no wheel is installed.
        """
        if not self._compound:
            raise RuntimeError("a repeat needs a wheel: install one first")
        specimen, wheel = self._place[:2]
        place = (specimen, wheel, condition, repeat, attempt)
        self.condition_factor = condition_factor(self.parameters, self._seed, self._compound, condition)
        self.run_factor = run_factor(self.parameters, self._seed, *place)
        self._scatter = self.wheel_factor * self.condition_factor * self.run_factor
        self._place = place
        self._key_streams()

    def advance(
        self,
        dt: float,
        wheel_rad_s: float,
        belt_m_s: float,
        press_mm: float,
        press_mm_s: float,
        sideslip_deg: float,
        camber_deg: float,
        heater_w: float,
    ) -> None:
        """Move on by ``dt`` s, 1 to 100 ms, with speeds and positions as at its end and the heater's mean power.

        ``press_mm`` is 0 when fully lifted and grows towards the wheel; camber has no effect (the paper has
        no data).
        """
        if abs(dt - self._dt) > _SAME_STEP_S:
            self._retime(dt)
        if sideslip_deg != self._sideslip_deg:
            self._yaw(sideslip_deg)
        self.camber_deg = camber_deg
        self.wheel_angle_rev = turns = self.wheel_angle_rev + wheel_rad_s * dt / _TURN
        wheel_m_s = 0.0005 * self.diameter_mm * wheel_rad_s
        vx = wheel_m_s - belt_m_s * self._cos
        vy = belt_m_s * self._sin
        self.slip_m_s = math.sqrt(vx * vx + vy * vy)

        power_w = 0.0
        depth_mm = press_mm - self._touch_mm
        if depth_mm > -self._swing_mm:
            swing, angle = self._swing_mm, _TURN * turns
            rate_mm_s = press_mm_s + swing * wheel_rad_s * math.cos(angle)
            load_n = self._contact.load_n(depth_mm + swing * math.sin(angle), rate_mm_s)
            if load_n > 0.0:
                power_w = self._rub(dt, load_n, vx, vy)
            elif self.force_z_n > 0.0:
                self._release()
        elif self.force_z_n > 0.0:
            self._release()

        thermal = self._thermal
        self._heater_j += heater_w * dt
        self._thermal_s = thermal_s = self._thermal_s + dt
        rotating = abs(wheel_m_s) > self._rotating_above
        if thermal_s >= thermal.step_s - _SAME_STEP_S:
            self._conduct(rotating)
        touching = 1.0 if self.force_z_n > 0.0 else 0.0
        self.surface_c = surface_c = thermal.surface_temperature(
            self.heat, power_w, self.parameters.ambient, touching, rotating
        )
        self.ir.follow(surface_c)

    def _retime(self, dt: float) -> None:
        """Prepare what depends on the length of a tick alone."""
        self._dt = dt
        self._within.retime(dt)
        self.ir.retime(dt)
        self._deficit_keep = math.exp(-dt / self.parameters.friction.touch_time)

    def _yaw(self, sideslip_deg: float) -> None:
        """Prepare what depends on the sideslip angle alone."""
        self._sideslip_deg = sideslip_deg
        angle = math.radians(sideslip_deg)
        self._cos, self._sin = math.cos(angle), math.sin(angle)
        self._cornering = cornering_factor(self._compound, sideslip_deg) if self._compound else 1.0

    def _rub(self, dt: float, load_n: float, vx: float, vy: float) -> float:
        """Set the forces of a loaded contact, wear the tread and return the friction power in W."""
        p = self.parameters
        f, a = p.friction, p.abrasion
        slip_m_s = self.slip_m_s
        mu = self._friction.mu(self.surface_c, load_n if load_n > f.load_floor else f.load_floor, slip_m_s)
        mu *= self._cornering * self._scatter * (1.0 + self._within.step(self._noise.next()))
        mu *= running_in_factor(self._running_in, a.running_in_distance, self.sliding_m)
        mu *= 1.0 - self._deficit
        self._deficit *= self._deficit_keep

        cx, cy = traction_direction(vx, vy, f.creep, f.reversal_width)
        friction_n = mu * load_n
        fx, fy = friction_n * cx, friction_n * cy
        self.mu = mu
        self.force_x_n, self.force_y_n, self.force_z_n = fx, fy, load_n
        self.moment_z_nm = 0.001 * f.aligning_arm * fy
        self.drive_torque_nm = 0.0005 * self.diameter_mm * fx
        self.belt_force_n = fx * self._cos - fy * self._sin

        sliding_m = slip_m_s * dt
        self.sliding_m += sliding_m
        worn_mm = radius_loss_mm(self._wear_rate, load_n, sliding_m, self.diameter_mm, p.wheel.width)
        self.diameter_mm -= 2.0 * worn_mm
        self._touch_mm += worn_mm
        power_w = friction_n * slip_m_s
        self._friction_j += power_w * dt
        self._touch_s += dt
        return power_w

    def _conduct(self, rotating: bool) -> None:
        """Let heat flow for the whole thermal steps that are due, with the mean powers since the last."""
        model, ambient_c, step_s = self._thermal, self.parameters.ambient, self._thermal.step_s
        heater_w = self._heater_j / self._thermal_s
        friction_w = self._friction_j / self._thermal_s
        contact = self._touch_s / self._thermal_s
        while self._thermal_s >= step_s - _SAME_STEP_S:
            model.step(self.heat, step_s, heater_w, friction_w, ambient_c, contact, rotating)
            self.hub_sensor.follow(self.heat.hub_c)
            self.load_cell.warm(step_s, self.heat.belt_c)
            self._thermal_s -= step_s
        self._heater_j = heater_w * self._thermal_s
        self._friction_j = friction_w * self._thermal_s
        self._touch_s = contact * self._thermal_s

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
        return self.load_cell.measure(self.force_x_n, self.force_y_n, self.force_z_n, self.moment_z_nm)

    def surface_measured_c(self, t: float) -> float:
        """Return what the infrared thermometer reads now, in degC; ``t`` is the time of asking."""
        return self.ir.measure()

    def hub_measured_c(self, t: float) -> float:
        """Return what the hub's sensor reads now, in degC; ``t`` is the time of asking."""
        return self.hub_sensor.measure()
