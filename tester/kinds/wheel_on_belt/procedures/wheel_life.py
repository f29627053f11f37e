"""The wheel on the rig, and its two diameters.

*Cold* is the diameter at ``wear.reference``, as a calliper measures it there. The rig file, all records and all checks
use it; only wear changes it. *Warm* is the running diameter, grown by heat: rim speed, slip, distance slid and place of
touch follow from it. ``Readings`` has them as ``cold_mm`` and ``diameter_mm``, updated here in every scan.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot, inf, isfinite, nan, pi
from typing import Final

from tester.analysis.wear_rate import WearCheck
from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.procedures.wear_estimate import LoadMemory, WearEstimate, loss_per_n_m
from tester.kinds.wheel_on_belt.rig.sections import GeometryConfig, WearConfig

_INF: Final = inf
SAME_SIZE_K: Final = 0.25
"""Least change of the rubber's temperature that updates the diameter, K [A]: 2 um, 0.02 mm/s at 0.8 m/s. Otherwise the
thermometer's noise would change the drives' commands in every scan."""
SURE_U: Final = 2.0
"""Coverage factor of the diameter's uncertainty where a wheel is near its least diameter."""
AGREES_U: Final = 3.0
AGREES_MM: Final = 0.25
"""The believed loss stands while the touches differ from it by at most so many of their standard uncertainties, and by
at most this, mm [A]: 2.2 mm/s of slip at 0.8 m/s. The scatter of single touches then moves no drive."""


def rubber_c(hub_c: float, surface_c: float) -> float:
    """Return the rubber's mean temperature, degC: half hub and half surface.

    In steady heat flow temperature falls nearly evenly through the layer. Friction warms the surface first, and the
    jacket the hub; still, over the recipe ``wear`` on the simulated rig this mean explains the loaded wheel's growth
    to 0.009 mm (rms; 0.03 mm at most). Weights of 0.4 or 0.6 leave 0.02 mm; a lag of half a minute helps little.
    """
    return 0.5 * (hub_c + surface_c)


@dataclass(frozen=True, slots=True)
class CheckReference:
    """The first roll check of a wheel: its time, the press's position, and the diameter lost until then (estimate)."""

    at_s: float
    press_mm: float
    """The press's position, corrected to the nominal load and a cold wheel."""
    loss_mm: float


@dataclass(slots=True)
class WheelLife:
    """The wheel on the rig: its identity, its loss of diameter, and its growth by heat.

    The loss between touches follows the wear law dR = k F v dt / (2 pi R w), with the rig file's k until touches
    contradict it (physics: load, wear, transients).
    """

    specimen: int = 0
    replicate: int = 0
    wheel: int = 0
    compound: str = ""
    installed_mm: float = nan
    """Cold diameter of the wheel when new."""
    width_mm: float = 30.0
    loss_mm: float = 0.0
    """Estimated loss of diameter since installation, mm."""
    grown_mm: float = 0.0
    """Growth of the diameter by heat, mm; below 0 under the reference temperature; 0 until a temperature is known
    (nothing starts before that)."""
    rubber_c: float = nan
    """Mean temperature of the rubber for this growth."""
    sliding_m: float = 0.0
    rate_mm3_per_n_m: float = 0.0
    """Wear rate from touches or checks of this wheel; 0: none yet, the rig file's rate is used."""
    exposure_n_m: float = 0.0
    """Normal force times distance slid since installation; wear is proportional to it."""
    condition: int = 0
    """The last condition measured with this wheel; 0: none yet."""
    reference: CheckReference | None = None
    """The first roll check since the wheel was mounted: the reference for later checks."""
    by_hand_s: float = nan
    """Time of a person's first measurement."""
    last_check: WearCheck | None = None
    estimate: WearEstimate = field(default_factory=WearEstimate)
    """What its touches show."""
    loads: LoadMemory = field(default_factory=LoadMemory)
    followed: bool = False
    """The touches have contradicted the believed loss: it follows them."""
    reported: bool = False
    """People know that the wheel wears at another rate than believed."""
    touched: WearCheck | None = None
    """Its last touch, for the record."""

    @property
    def cold_mm(self) -> float:
        """Current diameter at the reference temperature, mm."""
        return self.installed_mm - self.loss_mm

    def slide(self, force_n: float, slip_m_s: float, dt: float, rate_mm3_per_n_m: float) -> None:
        """Account for ``dt`` seconds of sliding at a normal force in N and a slip speed in m/s."""
        distance = slip_m_s * dt
        self.sliding_m += distance
        self.exposure_n_m += force_n * distance
        rate_mm3_per_n_m = self.rate_mm3_per_n_m or rate_mm3_per_n_m
        cold_mm = self.installed_mm - self.loss_mm
        self.loss_mm += 2.0 * rate_mm3_per_n_m * force_n * distance / (pi * cold_mm * self.width_mm)

    def loss_of(self, exposure_n_m: float, believed_mm3_per_n_m: float) -> float:
        """Return the loss of diameter, mm, by a load times distance, at the learnt rate or else the believed one."""
        rate_mm3_per_n_m = self.rate_mm3_per_n_m or believed_mm3_per_n_m
        return rate_mm3_per_n_m * exposure_n_m * loss_per_n_m(self.cold_mm, self.width_mm)

    def follow(self) -> float:
        """Take the loss and the rate from the touches where they contradict the belief; return the change, mm."""
        estimate = self.estimate
        off_mm = estimate.loss_mm - self.loss_mm
        if not self.followed and abs(off_mm) <= min(AGREES_U * estimate.u_mm, AGREES_MM):
            return 0.0
        self.loss_mm = max(estimate.loss_mm, 0.0)
        self.rate_mm3_per_n_m = estimate.rate_mm3_per_n_m
        return off_mm

    @property
    def u_mm(self) -> float:
        """Standard uncertainty of the loss in use, mm: that of the touches, and the distance from them."""
        estimate = self.estimate
        return hypot(estimate.u_mm, 0.0 if self.followed else estimate.loss_mm - self.loss_mm)

    def growth_u_mm_per_k(self, wear: WearConfig, layer_mm: float) -> float:
        """Return the growth's uncertainty, mm/K of diameter: the stated one, and more where rubber is worn off.

        ``layer_mm``: thickness of the rubber when new; less rubber grows less, and no key states the rubber's part.
        """
        return wear.growth_uncertainty_mm_per_k + wear.growth_mm_per_k * max(self.loss_mm, 0.0) / (2.0 * layer_mm)

    def show(self, r: Readings, wear: WearConfig) -> None:
        """Write both diameters, from the newest temperatures, to the process image.

        While hub or surface is unknown, the wheel keeps its growth: rubber cools slowly.
        """
        if r.surface_valid and r.jacket_valid:
            mean_c = rubber_c(r.hub_c, r.surface_c)
            if not -SAME_SIZE_K < mean_c - self.rubber_c < SAME_SIZE_K and -_INF < mean_c < _INF:
                self._grow(mean_c, wear)
        r.cold_mm = cold_mm = self.installed_mm - self.loss_mm
        r.diameter_mm = cold_mm + self.grown_mm

    def size_up(self, r: Readings, wear: WearConfig) -> None:
        """Let the diameters follow even a small change of temperature, after a rest: how it came about has no part in
        them.
        """
        mean_c = rubber_c(r.hub_c, r.surface_c)
        if r.surface_valid and r.jacket_valid and -_INF < mean_c < _INF:
            self._grow(mean_c, wear)

    def _grow(self, mean_c: float, wear: WearConfig) -> None:
        self.rubber_c = mean_c
        self.grown_mm = wear.growth_mm(mean_c)


def wheel_of(
    geometry: GeometryConfig, specimen: int = 0, replicate: int = 0, wheel: int = 0, compound: str = "",
    diameter_mm: float = nan,
) -> WheelLife:  # fmt: skip
    """Return a wheel of a rig's size; ``diameter_mm``: the cold diameter of a worn wheel."""
    new_mm = geometry.wheel_diameter_mm
    loss_mm = new_mm - diameter_mm if isfinite(diameter_mm) else 0.0
    return WheelLife(specimen, replicate, wheel, compound, new_mm, geometry.wheel_width_mm, loss_mm)
