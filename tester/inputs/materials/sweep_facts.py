"""Facts that measured moduli give of themselves: transition, plateaus, kelvins a decade of frequency.

Intervals are expanded (95 %). What the points do not allow is left out, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, hypot, log, log10
from typing import Literal, NamedTuple

import numpy as np

from tester.analysis.quantiles import t_quantile
from tester.base.arrays import Array
from tester.inputs.materials.measured_moduli import ALIKE, FLANK_SHARE, GLASS_LEAST_PA, ModuliRow, ModuliTable

PEAK_SHARE = 0.7
"""The peak is fitted to the points around it at which tan delta is at least this share of its greatest value [A]."""
PEAK_POINTS = 8
"""Least number of points around a peak for its fit [A]: a polynomial of degree 4 and three to spare."""
PLATEAU_K = 10.0
"""Length of a sweep's end that is taken for a plateau [A]."""
PLATEAU_POINTS = 4
PLATEAU_DRIFT = 0.15
"""A modulus that changes by more than this share over the length of a plateau is still in its transition [A]."""
LEAST_SPAN = 0.5
"""Frequencies within fewer decades give no kelvins a decade [A]."""


class SweepValue(NamedTuple):
    """A value and half the length of its interval (95 %)."""

    value: float
    u: float


@dataclass(frozen=True, slots=True)
class TanPeak:
    """The peak of tan delta over the temperature at one frequency; a DMA's glass transition."""

    frequency_hz: float
    place_c: SweepValue
    height: SweepValue


@dataclass(frozen=True, slots=True)
class Plateau:
    """A modulus of tension at one end of a sweep, from lowest to highest temperature."""

    modulus_pa: SweepValue
    low_c: float
    high_c: float
    frequency_hz: float


@dataclass(frozen=True, slots=True)
class SweepFacts:
    """Facts of a table of moduli; ``silent``: reasons for those that are missing."""

    peaks: tuple[TanPeak, ...]
    rubber: Plateau | None
    """E0, on the warm side."""
    glass: Plateau | None
    """Einf, on the cold side."""
    decade_k: SweepValue | None
    """Kelvins that the peak moves by for a decade of frequency."""
    silent: tuple[str, ...]

    @property
    def ratio(self) -> SweepValue | None:
        """Return Einf / E0, None without both."""
        if self.glass is None or self.rubber is None:
            return None
        glass, rubber = self.glass.modulus_pa, self.rubber.modulus_pa
        value = glass.value / rubber.value
        return SweepValue(value, value * hypot(glass.u / glass.value, rubber.u / rubber.value))


class SilentError(ValueError):
    """A fact that the points do not allow; the message gives the reason."""


def sweep_facts(table: ModuliTable) -> SweepFacts:
    """Return the facts of a table."""
    sweeps = sweeps_of(table.rows)
    silent: list[str] = []
    peaks: list[TanPeak] = []
    for rows in sweeps:
        try:
            peaks.append(tan_peak(rows))
        except SilentError as error:
            silent.append(f"tan delta's peak at {rows[0].frequency_hz:g} Hz: {error}")
    rubber = glass = None
    try:
        rubber = plateau(sweeps[0], "rubber")
    except SilentError as error:
        silent.append(f"E0: {error}")
    try:
        glass = plateau(sweeps[0], "glass")
    except SilentError as error:
        silent.append(f"Einf: {error}")
    try:
        decade = kelvins_a_decade(peaks)
    except SilentError as error:
        decade = None
        silent.append(f"kelvins a decade: {error}")
    return SweepFacts(tuple(peaks), rubber, glass, decade, tuple(silent))


def sweeps_of(rows: Sequence[ModuliRow]) -> list[list[ModuliRow]]:
    """Return the rows of each frequency, rising in frequency and in temperature; noise makes no new frequency."""
    sweeps: list[list[ModuliRow]] = []
    for row in sorted(rows, key=lambda row: row.frequency_hz):
        if sweeps and row.frequency_hz <= ALIKE * sweeps[-1][-1].frequency_hz:
            sweeps[-1].append(row)
        else:
            sweeps.append([row])
    return [sorted(sweep, key=lambda row: row.temperature_c) for sweep in sweeps]


def tan_peak(rows: Sequence[ModuliRow]) -> TanPeak:
    """Return the peak of tan delta of one sweep, rising in temperature.

    A polynomial of degree 4 of ln tan delta over the temperature is fitted around the greatest value; the interval
    includes the distance to the peak of a cubic. Raises SilentError.
    """
    tan = np.array([row.loss_pa / row.storage_pa for row in rows])
    at = int(np.argmax(tan))
    low, high = at, at
    while low > 0 and tan[low - 1] >= PEAK_SHARE * tan[at]:
        low -= 1
    while high < len(rows) - 1 and tan[high + 1] >= PEAK_SHARE * tan[at]:
        high += 1
    if not (np.any(tan[:at] < FLANK_SHARE * tan[at]) and np.any(tan[at + 1 :] < FLANK_SHARE * tan[at])):
        span = f"{rows[0].temperature_c:g} to {rows[-1].temperature_c:g} degC"
        raise SilentError(f"{span} do not hold it: the greatest value, {tan[at]:.3g}, is at an end")
    count = high - low + 1
    if count < PEAK_POINTS:
        raise SilentError(f"{count} points around it are too few (expected {PEAK_POINTS} or more)")
    celsius = np.array([row.temperature_c for row in rows[low : high + 1]])
    middle, half_k = 0.5 * (celsius[0] + celsius[-1]), 0.5 * (celsius[-1] - celsius[0])
    x, y = (celsius - middle) / half_k, np.log(tan[low : high + 1])
    place, u_place, top, u_top = _maximum(x, y, 4)
    other, _, other_top, _ = _maximum(x, y, 3)
    place_u = half_k * hypot(u_place, other - place)
    if place_u > half_k:
        raise SilentError("the scatter of the points hides it")
    height = exp(top)
    return TanPeak(
        float(np.exp(np.mean([log(row.frequency_hz) for row in rows]))),
        SweepValue(float(middle + half_k * place), float(place_u)),
        SweepValue(height, height * hypot(u_top, other_top - top)),
    )


def _maximum(x: Array, y: Array, degree: int) -> tuple[float, float, float, float]:
    """Return place and value of the maximum of a polynomial fitted to points, each with its expanded uncertainty."""
    powers = np.vander(x, degree + 1, increasing=True)
    coefficients, *_ = np.linalg.lstsq(powers, y, rcond=None)
    freedom = len(x) - degree - 1
    left = y - powers @ coefficients
    covariance = np.linalg.inv(powers.T @ powers) * float(left @ left) / freedom
    fine = np.linspace(-1.0, 1.0, 2001)
    place = float(fine[np.argmax(np.vander(fine, degree + 1, increasing=True) @ coefficients)])
    orders = np.arange(degree + 1)
    slope = np.where(orders > 0, orders * place ** np.maximum(orders - 1, 0), 0.0)
    bend = float(np.where(orders > 1, orders * (orders - 1) * place ** np.maximum(orders - 2, 0), 0.0) @ coefficients)
    if abs(place) > 0.999 or not bend < 0.0:
        raise SilentError("the points around the greatest value have no maximum")
    k = t_quantile(0.975, freedom)
    value = place**orders
    return (
        place, k * float(np.sqrt(slope @ covariance @ slope)) / -bend,
        float(value @ coefficients), k * float(np.sqrt(value @ covariance @ value)),
    )  # fmt: skip


def plateau(rows: Sequence[ModuliRow], end: Literal["rubber", "glass"]) -> Plateau:
    """Return the modulus at the warm end (rubber) or the cold end (glass) of a sweep, rising in temperature.

    The interval has the scatter of the mean and half the change over the end. Raises SilentError.
    """
    edge = rows[-1].temperature_c if end == "rubber" else rows[0].temperature_c
    kept = [row for row in rows if abs(row.temperature_c - edge) <= PLATEAU_K]
    span = f"{kept[0].temperature_c:g} to {kept[-1].temperature_c:g} degC"
    if len(kept) < PLATEAU_POINTS:
        raise SilentError(f"{len(kept)} points over {span} are too few (expected {PLATEAU_POINTS} or more)")
    x = np.array([row.temperature_c for row in kept])
    y = np.log([row.storage_pa for row in kept])
    about = x - x.mean()
    slope, level = float(about @ y) / float(about @ about), float(y.mean())
    change = abs(slope) * float(x[-1] - x[0])
    if change > PLATEAU_DRIFT:
        raise SilentError(f"E' still changes by {100.0 * change:.0f} % over {span}: no plateau")
    value = exp(level)
    if (value < GLASS_LEAST_PA) == (end == "glass"):
        what = "a glass" if end == "glass" else "rubber"
        raise SilentError(f"E' of {value / 1e6:.3g} MPa over {span} is not that of {what}")
    scatter = float(np.std(y - slope * about, ddof=2)) / len(kept) ** 0.5
    u = hypot(t_quantile(0.975, len(kept) - 2) * scatter, 0.5 * change)
    return Plateau(SweepValue(value, value * u), kept[0].temperature_c, kept[-1].temperature_c, rows[0].frequency_hz)


def kelvins_a_decade(peaks: Sequence[TanPeak]) -> SweepValue:
    """Return by how many kelvins the peak moves for a decade of frequency: the slope of a straight line.

    Every frequency has the same weight, because the shift itself bends. Raises SilentError.
    """
    if len(peaks) < 2:
        raise SilentError(f"{len(peaks)} frequency with a peak (expected two or more)")
    x = np.array([log10(peak.frequency_hz) for peak in peaks])
    if x[-1] - x[0] < LEAST_SPAN:
        raise SilentError(f"peaks over {x[-1] - x[0]:.2f} decades (expected {LEAST_SPAN:g} or more)")
    share = (x - x.mean()) / float(np.sum((x - x.mean()) ** 2))
    slope = float(share @ [peak.place_c.value for peak in peaks])
    u = float(np.linalg.norm(share * [peak.place_c.u for peak in peaks]))
    if not u < slope:
        raise SilentError(f"{slope:.1f} ± {u:.1f} K: the peaks do not move in order of their frequencies")
    return SweepValue(slope, u)


def fact_words(facts: SweepFacts) -> Iterator[tuple[str, str]]:
    """Yield each fact in words, with its label."""
    for peak in facts.peaks:
        place, height = peak.place_c, peak.height
        yield (
            "tan peak",
            f"{_shown(height)} at {_shown(place)} degC, {peak.frequency_hz:.3g} Hz: the Tg of a DMA",
        )
    for label, end in (("E0", facts.rubber), ("Einf", facts.glass)):
        if end is not None:
            modulus = SweepValue(end.modulus_pa.value / 1e6, end.modulus_pa.u / 1e6)
            span = f"{end.low_c:g} to {end.high_c:g} degC, {end.frequency_hz:.3g} Hz"
            yield label, f"{_shown(modulus)} MPa, mean of {span}"
    if facts.ratio is not None:
        yield "Einf/E0", _shown(facts.ratio)
    if facts.decade_k is not None:
        hertz = f"{facts.peaks[0].frequency_hz:.3g} to {facts.peaks[-1].frequency_hz:.3g} Hz"
        yield "shift", f"{_shown(facts.decade_k)} K a decade of frequency, {hertz}"
    for reason in facts.silent:
        yield "unknown", reason


def _shown(measured: SweepValue) -> str:
    """Return a value to the first two digits of its interval."""
    u = max(measured.u, 1e-4 * abs(measured.value), 1e-12)
    digits = max(0, 1 - int(np.floor(log10(u))))
    return f"{measured.value:.{digits}f} ± {u:.{digits}f}"
