"""Friction between wheel and belt: the law, its scatter, and the wear.

Forces are those on the belt in the wheel's frame: Fx along the wheel's plane (above 0 when the wheel drives), Fy across
it, Fz the load; ``belt_force_n`` is that along the belt's travel. ``diameter_mm`` is the wheel's present diameter,
grown by its heat; ``cold_mm`` is that at ambient temperature, for a calliper: wear reduces it.

Scatter multiplies the coefficient. A setting has one factor for each compound, the same for every repeat, wheel and
place in a recipe: it is the error of the model for this rubber at this setting. A wheel and a repeat have factors of
their own.
"""

from __future__ import annotations

import zlib
from math import cos, exp, inf, pi, radians, sin
from typing import Final, NamedTuple

from sim.noise import Autoregressive, NormalStream, StickSlip, normal, uniforms
from sim.physics.laws import NO_SETTING, LawSetting, OfMaterials, find
from sim.physics.parameters import SimParameters
from sim.physics.slip import traction_direction
from sim.physics.wheel_law import ASSUMED, WheelLaw, wheel_law

PAPERS_BELT: Final = "zirconia corundum belt"
"""The belt of the paper, on which the laws of its compounds were measured."""
BELT_SIGMA: Final = 0.1
"""Deviation of another belt's friction from that of the paper's, as a share, for a law that knows no surface [A]."""
BELT_MM: Final = 0.2
"""Greatest difference of another belt's thickness from the paper's, mm [A]."""
_RUNNING_IN_LASTS: Final = 37.0
"""Number of running-in distances after which its factor is 1 to the last bit: exp(-37) is less than 2^-53."""


class Rubbing:
    """A wheel that rubs on a belt: its forces, its wear, the belt's grip. ``Plant`` presses, heats and measures it."""

    # Slots: CPython 3.11 keeps more than 30 attributes in a dictionary, and every step of the twin gets slower.
    __slots__ = (
        "_arm_m", "_blunts", "_compound", "_cornering", "_cos", "_deficit", "_deficit_keep", "_excess", "_friction",
        "_grip", "_law", "_noise", "_rubber", "_run_in_m", "_run_in_scale_m", "_scatter", "_sideslip_deg", "_sin",
        "_stick_slip", "_touch_mm", "_wear_per_width", "_within", "belt", "belt_force_n", "belt_grip", "cold_mm",
        "condition_factor", "diameter_mm", "drive_torque_nm", "force_x_n", "force_y_n", "force_z_n", "mu", "parameters",
        "run_factor", "setting", "sliding_m", "slip_m_s", "surface_c", "wheel_factor",
    )  # fmt: skip

    def __init__(self, parameters: SimParameters, seed: int) -> None:
        """Begin with a new belt without contact."""
        p = parameters
        self.parameters = p
        self.surface_c = p.ambient
        self.cold_mm = self.diameter_mm = p.wheel.outer_diameter
        self._touch_mm = inf  # nothing to touch before a wheel is installed
        self.slip_m_s = self.sliding_m = 0.0
        self._arm_m = 0.001 * p.friction.aligning_arm
        self._within = Autoregressive(p.scatter * p.variability.within, p.variability.within_time)
        self._noise = NormalStream(seed, "unused")  # each place has its own stream
        self._stick_slip: StickSlip | None = None
        if p.stick_slip > 0.0:
            self._stick_slip = StickSlip(p.stick_slip, p.stick_slip_frequency, self._noise)
        self._grip = 1.0
        self._blunts = p.counterface.loss > 0.0
        self.belt_grip = 1.0
        """Share of its original grip that the belt has left; it is kept when wheels are changed."""
        self.belt = BELT
        """The belt that is on."""
        self._deficit_keep = 1.0
        self._sideslip_deg, self._cos, self._sin, self._cornering = 0.0, 1.0, 0.0, 1.0
        self._compound = ""
        self._friction, self._run_in_scale_m = p.friction, p.abrasion.running_in_distance
        self.wheel_factor = self.condition_factor = self.run_factor = self._scatter = 1.0
        self.setting: LawSetting = NO_SETTING
        """Source of the compounds' laws and moduli, and the belt's surface."""
        self._rubber: WheelLaw = wheel_law("paper", ASSUMED)  # without a wheel nothing rubs
        self._law = self._rubber.law
        a = p.abrasion
        self._excess = p.running_in * a.running_in_excess
        self._run_in_m = _RUNNING_IN_LASTS * a.running_in_distance if self._excess > 0.0 else 0.0
        self._wear_per_width = p.wear * a.wear_rate / (pi * p.wheel.width)
        self._release()

    def _take(self, compound: str) -> None:
        """Set the law of a compound."""
        p = self.parameters
        self._rubber = wheel_law(p.friction_model, compound, self.setting, p.friction.area, quick=True)
        self._law = self._rubber.law

    def _release(self) -> None:
        """Set all forces to 0; the next touch builds friction up anew."""
        self.mu = 0.0
        self.force_x_n = self.force_y_n = self.force_z_n = self.belt_force_n = 0.0
        self.drive_torque_nm = 0.0
        self._deficit = self.parameters.friction.touch_deficit

    def truth(self, temperature_c: float, load_n: float, slip_m_s: float, sideslip_deg: float) -> dict[str, float]:
        """Return the factors of the coefficient for the repeat that has begun, and the state at its begin.

        ``model`` is the compound's coefficient at these setpoints on the belt that is on. Times ``condition`` and
        ``wheel`` it is this wheel's coefficient in this condition on that belt in its original state; times ``belt``,
        on the belt as it is; times ``run``, this repeat's, before noise, running-in and wear.
        """
        model = self._law.mu(temperature_c, load_n, slip_m_s) * self._rubber.cornering_factor(sideslip_deg)
        model *= self.belt.factor
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
        """Set the share of the friction that the belt transmits from now on: 1 as new, 0 torn, above 1 sharper."""
        self._grip = share
        self._scatter = self.belt.factor * self.wheel_factor * self.condition_factor * self.run_factor * share

    def travel(self, travel_m: float, surface_c: float) -> None:
        """Let the belt travel under load, m, at a surface temperature of the rubber, degC: it goes blunt and clogs."""
        self.belt_grip *= self.parameters.counterface.grip_kept(travel_m, surface_c)

    def _yaw(self, sideslip_deg: float) -> None:
        """Prepare the values that depend on the sideslip angle alone."""
        self._sideslip_deg = sideslip_deg
        angle = radians(sideslip_deg)
        self._cos, self._sin = cos(angle), sin(angle)
        self._cornering = self._rubber.cornering_factor(sideslip_deg) if self._compound else 1.0

    def _rub(self, dt: float, load_n: float, vx: float, vy: float) -> float:
        """Set the forces of a loaded contact, wear the tread and return the friction power in W."""
        friction, slip_m_s = self._friction, self.slip_m_s
        floor_n = friction.load_floor
        mu = self._law.mu(self.surface_c, load_n if load_n > floor_n else floor_n, slip_m_s)
        within = self._within
        if within.kick:
            noise = self._noise
            for number in noise.numbers:  # noqa: B007 - saves a call: see NormalStream
                break
            else:
                number = noise.next()
            within.value = within.keep * within.value + within.kick * number
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
        self.force_x_n = fx = friction_n * cx
        self.force_y_n = fy = friction_n * cy
        self.force_z_n = load_n
        self.belt_force_n = fx * self._cos - fy * self._sin
        diameter_mm = self.diameter_mm
        self.drive_torque_nm = 0.0005 * diameter_mm * friction_n * cx

        slid_m = slip_m_s * dt
        self.sliding_m = sliding_m + slid_m
        worn_mm = self._wear_per_width * load_n * slid_m / diameter_mm
        self.diameter_mm = diameter_mm - 2.0 * worn_mm
        self.cold_mm -= 2.0 * worn_mm
        self._touch_mm += worn_mm
        return friction_n * slip_m_s

    @property
    def moment_z_nm(self) -> float:
        """True aligning moment in N m."""
        return self._arm_m * self.force_y_n


class Belt(NamedTuple):
    """A belt: its friction as a factor of the paper's belt, and how much thicker it is, mm."""

    name: str
    factor: float = 1.0
    thicker_mm: float = 0.0


BELT: Final = Belt("")
"""The belt of a rig whose recipe names none: it rubs as the paper's."""


def belt_named(parameters: SimParameters, seed: int, name: str) -> Belt:
    """Return the belt of a name: other belts than the paper's have their own friction and thickness.

    A law made of materials takes friction from the surface itself.
    """
    if name in ("", PAPERS_BELT):
        return Belt(name)
    key, scatter = zlib.crc32(name.encode()), parameters.scatter
    of_surface = isinstance(find(parameters.friction_model), OfMaterials)
    factor = 1.0 if of_surface else exp(scatter * BELT_SIGMA * normal(seed, "belt", key))
    return Belt(name, factor, scatter * BELT_MM * uniforms(1, seed, "belt", key)[0])


def wheel_factor(parameters: SimParameters, seed: int, specimen: int, wheel: int) -> float:
    """Return the friction factor of one wheel."""
    sigma = parameters.scatter * parameters.variability.wheel
    return 1.0 + sigma * normal(seed, "wheel", specimen, wheel)


class WheelSetting(NamedTuple):
    """Setpoints of a condition that friction depends on: slip m/s, load N, angles deg, surface degC."""

    slip_m_s: float
    load_n: float
    angles_deg: tuple[float, ...]
    """The driven angles, in the order of the machine's axes."""
    temperature_c: float

    @property
    def key(self) -> tuple[int, ...]:
        """Return whole numbers of at least 0 that are the same for the same setting.

        They count steps of 0.1 mm/s, 0.1 N, 0.01 deg and 0.1 K, finer than any rig holds. Slip and angles are without
        sign, as in the friction law.
        """
        return (
            round(1e4 * abs(self.slip_m_s)),
            round(10.0 * self.load_n),
            *(round(100.0 * abs(angle)) for angle in self.angles_deg),
            round(10.0 * (self.temperature_c + 273.0)),
        )


def condition_factor(parameters: SimParameters, seed: int, compound: str, setting: WheelSetting) -> float:
    """Return the friction factor of a compound at a setting: the error of the model there."""
    sigma = parameters.scatter * parameters.variability.condition(compound)
    return 1.0 + sigma * normal(seed, "condition", zlib.crc32(compound.encode()), *setting.key)


def run_factor(parameters: SimParameters, seed: int, *place: int) -> float:
    """Return the friction factor of one repeat (specimen, wheel, condition, repeat, attempt)."""
    return 1.0 + parameters.scatter * parameters.variability.run * normal(seed, "run", *place)
