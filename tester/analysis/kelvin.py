"""Sensitivity of the coefficient to temperature, and its value at the requested temperature.

The relative sensitivity c = d ln(mu) / dT of a condition comes from the run's own pairs first: conditions that differ
only in temperature. Without such pairs it is the compound's known sensitivity, and without that 0 +- 2.6 %/K (the range
over the three compounds of doi 10.3390/polym16050596 at 25 to 85 degC), with no correction.

  mu(T0) = mu exp(-c (T + lag dT/dt - T0)),

T the mean of the thermometer's readings, which lag behind a surface that warms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, hypot, isfinite, log, sqrt
from typing import Final

from tester.analysis.drift import PER_KELVIN_PERCENT
from tester.analysis.results import NAN
from tester.analysis.terms import Acts, Term
from tester.analysis.uncertainty import Contribution, contribution

CONDITION_SCATTER: Final = 0.044
"""Relative scatter of a condition about any smooth law of temperature: the middle of 3.2, 4.2 and 5.9 %, residual
standard deviations of the best separable law for the three compounds of doi 10.3390/polym16050596 [A]."""
TEMPERATURE_SENSITIVITY: Final = "temperature sensitivity"
"""Name of the contribution of the uncertainty of the sensitivity."""
LEAST_STEP_K: Final = 5.0
"""Differences of closer temperatures are dominated by scatter [A]."""


@dataclass(frozen=True, slots=True)
class Slope:
    """Relative sensitivity to temperature and its standard uncertainty, 1/K; ``known``: it is more than a prior."""

    per_kelvin: float
    u_per_kelvin: float
    source: str
    known: bool = True


UNKNOWN: Final = Slope(0.0, 0.01 * PER_KELVIN_PERCENT, f"unknown: 0 +- {PER_KELVIN_PERCENT:g} %/K [A]", known=False)


@dataclass(frozen=True, slots=True)
class KnownSlope:
    """A compound's known sensitivity near a temperature (degC), as a run's record keeps it; %/K."""

    compound: str
    temperature_c: float
    per_kelvin_percent: float
    u_per_kelvin_percent: float
    source: str

    @property
    def slope(self) -> Slope:
        """Return this sensitivity as a slope."""
        return Slope(0.01 * self.per_kelvin_percent, 0.01 * self.u_per_kelvin_percent, self.source)


def slope_of_pairs(at_c: float, points: Sequence[tuple[float, float]]) -> Slope | None:
    """Return the sensitivity at a temperature from conditions that differ in temperature alone; None without a pair.

    ``points``: temperature in degC and coefficient (> 0) of each, including the condition itself. The sensitivity is
    the slope at ``at_c`` of a parabola through the three nearest temperatures, or of the chord through two. Its
    uncertainty: the scatter of conditions, and for curvature the difference between parabola and chord (half the slope
    of a mere chord).
    """
    apart: list[tuple[float, float]] = []
    for point in sorted(points, key=lambda candidate: abs(candidate[0] - at_c)):
        # Of temperatures close together only the one nearest to the condition counts.
        if all(abs(point[0] - other) >= LEAST_STEP_K for other, _ in apart):
            apart.append(point)
    near = sorted(apart[:3])
    if len(near) < 2:
        return None
    x, y = [t for t, _ in near], [log(mu) for _, mu in near]
    if len(near) == 2:
        weights = [-1.0 / (x[1] - x[0]), 1.0 / (x[1] - x[0])]
        chord = parabola = sum(w * v for w, v in zip(weights, y, strict=True))
        curved = 0.5 * abs(chord)
    else:
        weights = [
            (2.0 * at_c - x[1] - x[2]) / ((x[0] - x[1]) * (x[0] - x[2])),
            (2.0 * at_c - x[0] - x[2]) / ((x[1] - x[0]) * (x[1] - x[2])),
            (2.0 * at_c - x[0] - x[1]) / ((x[2] - x[0]) * (x[2] - x[1])),
        ]
        parabola = sum(w * v for w, v in zip(weights, y, strict=True))
        chord = (y[2] - y[0]) / (x[2] - x[0])
        curved = abs(parabola - chord) / sqrt(3.0)
    scattered = CONDITION_SCATTER * sqrt(sum(w * w for w in weights))
    nearby = ", ".join(f"{t:.0f}" for t in x)
    return Slope(parabola, hypot(scattered, curved), f"the run's own conditions at {nearby} degC")


@dataclass(frozen=True, slots=True)
class SurfaceWarmth:
    """A condition's temperatures, degC: nominal, shown by the thermometer, and the rate of the latter (K/s)."""

    nominal_c: float = NAN
    shown_c: float = NAN
    rate_k_s: float = 0.0
    slope: Slope = UNKNOWN

    def offset_k(self, terms: Sequence[Term]) -> float:
        """Return the surface's temperature less the nominal one, K, including the thermometer's lag; 0 if unknown."""
        lag_s = sum(term.factor for term in terms if term.acts is Acts.LAG)
        offset = self.shown_c + lag_s * self.rate_k_s - self.nominal_c
        return offset if isfinite(offset) else 0.0

    def correction(self, terms: Sequence[Term]) -> float:
        """Return the factor that takes a coefficient as measured to the nominal temperature; 1 where no sensitivity is
        known."""
        return exp(-self.slope.per_kelvin * self.offset_k(terms)) if self.slope.known else 1.0

    def contribution(self, mu: float, terms: Sequence[Term]) -> Contribution:
        """Return the contribution of the sensitivity's uncertainty, over the offset and the thermometer's error."""
        thermometer_k = sqrt(sum(term.standard**2 for term in terms if term.acts is Acts.TEMPERATURE))
        over_k = hypot(self.offset_k(terms), thermometer_k)
        return contribution(TEMPERATURE_SENSITIVITY, self.slope.u_per_kelvin, mu * over_k, unit="1/K",
                            source=self.slope.source)  # fmt: skip


NO_WARMTH: Final = SurfaceWarmth()
