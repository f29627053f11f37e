"""The plant: a specimen on an arm, loaded by weights, on a track that moves under it.

The arm holds the specimen back through a spring (arm, cell, rubber). While the contact sticks, the track's movement
extends the spring; at the force limit the contact slides. The limit is the load times the law's coefficient at the
track's speed and the specimen's temperature. After a rest it is higher by the share ``static_excess``, which vanishes
with the sliding distance. Air and specimen are one lump of heat each; flashes of temperature at the asperities are not
modelled. Below some mm/s friction heats nothing: 20 N at 10 mm/s and mu = 2 are 0.4 W, and the specimen's share of that
warms it by 0.2 K.
The arm is free of its lift below the touch: it rests on the specimen, or without one on its holder, which grinds.
Every public attribute is the truth.
"""

from __future__ import annotations

from dataclasses import replace
from math import copysign, exp, radians, sin
from typing import Final

from sim.noise import NormalStream, StickSlip, normal, uniforms
from sim.physics.laws import NO_SETTING, FrictionLaw, LawSetting
from sim.physics.track import Interface, TrackParameters
from sim.sensors import TemperatureSensor

IN_HOLDER: Final = -1.0
"""In place of a holder's coefficient: the specimen has not left it."""
DISC_RADIUS_MM: Final = 60.0
"""Radius of the track on a disc, mm [A]."""
SPECIMEN_SIGMA: Final = 0.03
REPEAT_SIGMA: Final = 0.02
"""Relative standard deviation of the friction from specimen to specimen, and of one repeat [A]."""
CUBIC: Final = 6.0 * 3.0**0.5
"""Makes the largest value of x (1 - x) (1 - 2 x) between 0 and 1 one."""
_SHEDDING_OVER: Final = 37.0
"""Static lengths after which the static excess is 0 to the last bit: exp(-37) is less than 2^-53."""


class TrackPlant:
    """The physics of one rig, with a specimen on its arm after ``install``. All randomness from one seed.

    ``force_n`` is the tangential force on the specimen, above 0 where the track moves forward; ``load_n`` the load on
    the contact; ``slip_m_s`` the speed of sliding; ``slid_m`` its distance since the specimen was put in.
    """

    __slots__ = (
        "_air", "_curve_n", "_drift_n_k", "_dry", "_height_drift_mm_k", "_height_noise", "_height_zero_mm", "_law",
        "_noise", "_place", "_pyrometer", "_repeat", "_seed", "_since_rest_m", "_specimen", "_stick_slip", "_tilt",
        "_weights", "_zero_n", "air_c", "arm_n", "block_mm", "compound", "deaf", "force_n", "grip", "ground_m",
        "height_mm", "holder_mu", "hung_n", "interface", "load_n", "mu", "parameters", "power_w", "setting", "slid_m",
        "slip_m_s", "specimen_c", "way_m", "weights_n", "worn_mm",
    )  # fmt: skip

    def __init__(self, parameters: TrackParameters, seed: int) -> None:
        """Build a rig at ambient temperature without a specimen; draw the numbers that stay for the session."""
        p = parameters
        self.parameters = p
        self._seed = seed
        bias, zero, drift, air_bias = uniforms(4, seed, "session track")
        s, noise = p.sensors, p.noise
        unused = NormalStream(seed, "unused")
        self._pyrometer = TemperatureSensor(
            s.pyrometer_time, noise * s.pyrometer_rms, noise * s.pyrometer_bias * bias, unused
        )
        self._air = TemperatureSensor(s.air_time, noise * s.air_rms, noise * s.air_bias * air_bias, unused)
        self._zero_n, self._drift_n_k = noise * s.force_zero * zero, noise * s.force_drift * drift
        tilt, weights, size, cubic = uniforms(4, seed, "session force")
        self._tilt = noise * radians(s.misalignment) * tilt
        self._weights = 1.0 + noise * p.contact.weights * weights
        linearity_n = noise * s.force_linearity * size
        self._curve_n = (1.0 - abs(cubic)) * linearity_n, cubic * linearity_n
        height_zero, height_drift = uniforms(2, seed, "session height")
        self._height_zero_mm = noise * s.height_zero * height_zero
        self._height_drift_mm_k = noise * s.height_drift * height_drift
        self.air_c = self.specimen_c = p.ambient
        self._pyrometer.reset(p.ambient)
        self._air.reset(p.ambient)
        self.setting: LawSetting = NO_SETTING
        """Source of the materials for a law that is made of materials."""
        self._dry: FrictionLaw | None = None
        self._law: FrictionLaw | None = None
        self._specimen = self._repeat = 1.0
        self.grip = 1.0
        """Share of its original friction that the track has."""
        self._stick_slip: StickSlip | None = None
        if p.stick_slip > 0.0:
            self._stick_slip = StickSlip(p.stick_slip, p.stick_slip_frequency, unused)
        self.compound = ""
        """Of the specimen on the arm; "" before the first."""
        self.interface: Interface = "dry"
        self.weights_n = 0.0
        self.arm_n = 0.0
        """Load of an arm that is not balanced, N, besides the weights."""
        self.hung_n = 0.0
        """Force of a weight that pulls the arm over a pulley, N, above 0 in the direction of the track."""
        self.block_mm: float | None = None
        """Gauge block on which the arm is held down, mm; None: the arm is where its lift is."""
        self.slid_m = 0.0
        self.way_m = 0.0
        """Way of the track."""
        self.worn_mm = 0.0
        """Height that the specimen has lost by wear."""
        self.holder_mu = IN_HOLDER
        """Coefficient of the bare holder on the track; IN_HOLDER while the specimen is in the holder."""
        self.deaf = False
        """Whether the cell has no part in the force: it shows its zero, drift and noise."""
        self.ground_m = 0.0
        """Way that the bare holder has slid under load."""
        self.height_mm = p.contact.lift_travel - p.contact.touch
        """Height of the arm over that with a new specimen on the track, without load."""
        self.force_n = self.load_n = self.slip_m_s = self.power_w = self.mu = 0.0
        self._since_rest_m = 0.0
        self._place: tuple[int, ...] = ()
        self._key_streams()

    # the attendant's hands -----------------------------------------------------------------------------------

    def install(self, specimen: int, compound: str) -> None:
        """Put a specimen in (``specimen`` keys its scatter), at ambient temperature.

        Raises ValueError for a rubber that is missing in the parameters, or in the setting's materials.
        """
        self._take(compound, self.setting, self.interface)
        self._specimen = 1.0 + self.parameters.scatter * SPECIMEN_SIGMA * normal(self._seed, "specimen", specimen)
        self._repeat = 1.0
        self.specimen_c = self.parameters.ambient
        self.slid_m = self.worn_mm = self.ground_m = 0.0
        self.holder_mu = IN_HOLDER
        self._release()
        self._place = (specimen,)
        self._key_streams()

    def put_on(self, weights_n: float) -> None:
        """Put weights on the arm, N (including the arm's own weight if it is not balanced). Raises ValueError."""
        if not 0.0 <= weights_n < float("inf"):
            raise ValueError(f"weights must be finite and at least 0 N, not {weights_n!r}")
        self.weights_n = self._weights * weights_n

    def cover(self, surface: str) -> None:
        """Cover the track with a surface, clean and dry; it matters to laws of materials.

        Raises ValueError for a surface that is missing in the setting's materials.
        """
        self._take(self.compound, replace(self.setting, surface=surface), "dry")

    def _take(self, compound: str, setting: LawSetting, interface: Interface) -> None:
        """Take the law of a rubber on a surface, or change nothing and raise.

        There is none without a rubber, or before the track is covered where the law needs a surface.
        """
        p = self.parameters
        bare = p.of_materials and setting.materials is not None and not (p.surface or setting.surface)
        dry = p.friction_of(compound, setting) if compound and not bare else None
        self._law = p.contact.through(dry, interface) if dry is not None else None
        self._dry, self.compound, self.setting, self.interface = dry, compound, setting, interface

    def prepare(self, interface: Interface) -> None:
        """Dry, wet or powder the track. Raises ValueError for a bare track whose law needs a surface."""
        if self.compound and self._dry is None:
            raise ValueError(f"law {self.parameters.law!r} needs a surface: cover the track first")
        self.interface = interface
        if self._dry is not None:
            self._law = self.parameters.contact.through(self._dry, interface)

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Draw the scatter of a repeat and start its streams of noise; all numbers 0 and up."""
        place = (*self._place[:1], condition, repeat, attempt)
        self._repeat = 1.0 + self.parameters.scatter * REPEAT_SIGMA * normal(self._seed, "repeat", *place)
        self._place = place
        self._key_streams()

    def _key_streams(self) -> None:
        """Start every stream of noise anew at the present place."""
        self._noise = NormalStream(self._seed, "track cell", *self._place)
        self._height_noise = NormalStream(self._seed, "track height", *self._place)
        self._pyrometer.noise = NormalStream(self._seed, "track pyrometer", *self._place)
        self._air.noise = NormalStream(self._seed, "track air", *self._place)
        if self._stick_slip is not None:
            self._stick_slip.restart(NormalStream(self._seed, "track stick-slip", *self._place))

    # time ----------------------------------------------------------------------------------------------------

    def advance(self, dt: float, track_m_s: float, lift_mm: float, chamber_percent: float) -> None:
        """Advance by ``dt`` s; the track's speed and the arm's position are those at the end.

        ``lift_mm`` is 0 when lowered; ``chamber_percent`` is the chamber's output, -100 (cooling) to 100, without
        meaning if the specimen is not enclosed.
        """
        contact = self.parameters.contact
        pressed = (contact.touch - lift_mm) / contact.touch
        self.load_n = (self.weights_n + self.arm_n) * (1.0 if pressed > 1.0 else pressed)
        if pressed > 0.0 and self.weights_n > 0.0 and self._law is not None:
            self._rub(dt, track_m_s, self._law)
        elif self.force_n != 0.0 or self.load_n != 0.0 or self._since_rest_m != 0.0:
            self._release()
        self.way_m += track_m_s * dt
        self.height_mm = self._height(lift_mm)
        self._warm(dt, chamber_percent)

    def lose(self, holder_mu: float) -> None:
        """Let the specimen come out of its holder, which then grinds with this coefficient; IN_HOLDER puts it back."""
        self.holder_mu = holder_mu

    def _height(self, lift_mm: float) -> float:
        """Return the height of the arm, mm, at a position of its lift."""
        p, contact = self.parameters, self.parameters.contact
        carried_mm = lift_mm - contact.touch
        block_mm = self.block_mm
        if carried_mm >= 0.0 and block_mm is None:
            return carried_mm
        rests_mm = -contact.protrusion
        if self.holder_mu == IN_HOLDER and self.compound:
            grown_mm = contact.expansion * (self.specimen_c - p.ambient) - self.load_n / contact.squeeze
            rests_mm = max(rests_mm, grown_mm - self.worn_mm)
        if p.motion == "disc":
            rests_mm += contact.runout * sin(1e3 * self.way_m / DISC_RADIUS_MM)
        return rests_mm if block_mm is None else rests_mm + block_mm

    def _rub(self, dt: float, track_m_s: float, law: FrictionLaw) -> None:
        """Extend the spring, or slide at the limit."""
        self.slip_m_s = self.power_w = 0.0
        if track_m_s == 0.0:
            self._since_rest_m = 0.0
            limit_n = self.load_n * self.mu * (1.0 + self.parameters.contact.static_excess)
            if abs(self.force_n) > limit_n:
                self.force_n = copysign(limit_n, self.force_n)  # the load has decreased
            return
        contact, speed = self.parameters.contact, abs(track_m_s)
        mu = law.mu(self.specimen_c, self.load_n, speed) * self._specimen * self._repeat * self.grip
        bare = self.holder_mu != IN_HOLDER
        if bare:
            mu = self.holder_mu
        if self._stick_slip is not None:
            mu *= self._stick_slip.factor(dt)
        stiffness_n_m = 1e3 * contact.stiffness
        moved_m = track_m_s * dt
        drawn_n = self.force_n + stiffness_n_m * moved_m
        length_m = 1e-3 * contact.static_length
        if self._since_rest_m > 0.0 and drawn_n * track_m_s < 0.0:
            self._since_rest_m = 0.0  # reversal: the contact holds until the spring is extended the other way
        excess = 0.0
        if self._since_rest_m < _SHEDDING_OVER * length_m:
            excess = contact.static_excess * exp(-self._since_rest_m / length_m)
        self.mu = mu
        limit_n = self.load_n * mu * (1.0 + excess)
        if abs(drawn_n) <= limit_n:
            self.force_n = drawn_n
            return
        self.force_n = copysign(limit_n, drawn_n)
        slid_m = min(speed * dt, (abs(drawn_n) - limit_n) / stiffness_n_m)
        self._since_rest_m += slid_m
        if bare:
            self.ground_m += slid_m
        else:
            self.slid_m += slid_m
            self.worn_mm += contact.wear * slid_m
        self.slip_m_s = slid_m / dt
        self.power_w = limit_n * self.slip_m_s

    def _release(self) -> None:
        """Set all forces to 0; the next touch begins as after a rest."""
        self.force_n = self.load_n = self.slip_m_s = self.power_w = self.mu = 0.0
        self._since_rest_m = 0.0

    def _warm(self, dt: float, chamber_percent: float) -> None:
        """Advance the temperatures of air and specimen by ``dt`` s, exactly for constant powers."""
        p, h = self.parameters, self.parameters.heat
        if p.enclosed:
            goal_c = p.ambient + 0.01 * chamber_percent * h.chamber_rate * h.chamber_time
            self.air_c = goal_c + (self.air_c - goal_c) * exp(-dt / h.chamber_time)
        into_w = h.friction_share * self.power_w
        goal_c = self.air_c + h.specimen_rise * into_w
        self.specimen_c = goal_c + (self.specimen_c - goal_c) * exp(-dt / h.specimen_time)
        self._air.retime(dt)
        self._air.follow(self.air_c)
        self._pyrometer.retime(dt)
        self._pyrometer.follow(self.exit_c)

    @property
    def exit_c(self) -> float:
        """Temperature of the track's surface at the exit edge of the contact, degC."""
        return self.specimen_c + self.parameters.heat.exit_rise * self.power_w

    # readings of the sensors ---------------------------------------------------------------------------------

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return the cell's present readings: the tangential force in N as the first of four channels."""
        s = self.parameters.sensors
        seen_n = 0.0 if self.deaf else self.force_n + self._tilt * self.load_n
        if s.force_linearity:
            seen_n += self._bent((seen_n + self.hung_n) / s.force_range)
        seen_n += self.hung_n + self._zero_n + self._drift_n_k * (self.air_c - self.parameters.ambient)
        rms_n = self.parameters.noise * s.force_rms
        if rms_n > 0.0:
            seen_n += rms_n * self._noise.next()
        return min(max(seen_n, -s.force_range), s.force_range), 0.0, 0.0, 0.0

    def _bent(self, share: float) -> float:
        """Return by how much the cell is off its line, N, at a share of its range: a quadratic and a cubic curve."""
        x = min(abs(share), 1.0)
        quadratic_n, cubic_n = self._curve_n
        off_n = x * (1.0 - x) * (4.0 * quadratic_n + CUBIC * (1.0 - 2.0 * x) * cubic_n)
        return copysign(1.0, share) * off_n

    def height_measured(self) -> float:
        """Return the present reading of the arm's height, mm."""
        off_mm = self._height_zero_mm + self._height_drift_mm_k * (self.air_c - self.parameters.ambient)
        rms_mm = self.parameters.noise * self.parameters.sensors.height_rms
        if rms_mm > 0.0:
            off_mm += rms_mm * self._height_noise.next()
        return self.height_mm + off_mm

    def controller_measured_c(self, t: float) -> float:
        """Return the present reading of the chamber's sensor, degC."""
        return self._air.measure()

    def surface_measured_c(self, t: float) -> float:
        """Return the present reading of the pyrometer at the contact's exit edge, degC."""
        return self._pyrometer.measure()
