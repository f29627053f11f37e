"""Complex shear moduli: one that does not depend on frequency, a fractional Zener solid, and tables of measurements.

G* = G' + i G''; E* = 2 (1 + nu) G*. Angular frequencies in rad/s, temperatures in degC, moduli in Pa. Small strain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from sim.physics.materials import OutsideError
from sim.physics.wlf import C1, C2_K, GLASS_TO_REFERENCE_K, log10_shift

if TYPE_CHECKING:
    from sim.physics.materials import Array, Complex

MERGED_DECADES: Final = 0.1
"""Points of a master curve within a bin of this width are averaged, decades."""


@dataclass(frozen=True, slots=True)
class ConstantModulus:
    """G* = G0 (1 + i tan delta) at every frequency and temperature: no real rubber, but it gives closed forms."""

    storage_pa: float
    """G0"""
    tan_delta: float

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        _above_zero(self, "storage_pa")
        if not (math.isfinite(self.tan_delta) and self.tan_delta >= 0.0):
            raise ValueError(f"ConstantModulus.tan_delta must be finite and at least 0, not {self.tan_delta!r}")

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G* in Pa, of the shape of the frequencies."""
        return np.full(np.shape(rate_rad_s), complex(self.storage_pa, self.storage_pa * self.tan_delta))


@dataclass(frozen=True, slots=True)
class FractionalZener:
    """G* = Gr + (Gg - Gr) z / (1 + z), z = (i omega tau aT(T) / aT(t_ref))^b, with the WLF shift about ``shift_c``."""

    relaxed_pa: float
    """Gr, of the rubber at rest."""
    glassy_pa: float
    """Gg, of the glass."""
    tau_s: float
    """Relaxation time at t_ref_c."""
    exponent: float
    """b, above 0 to 1; 1 is a standard linear solid."""
    shift_c: float
    """Ts = Tg + 50 K of the WLF shift, degC."""
    t_ref_c: float = 20.0
    c1: float = C1
    c2_k: float = C2_K

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range, PoleError where t_ref_c has no shift."""
        _above_zero(self, "relaxed_pa", "glassy_pa", "tau_s", "exponent", "c1", "c2_k")
        if self.glassy_pa <= self.relaxed_pa:
            raise ValueError(f"FractionalZener.glassy_pa must be above relaxed_pa ({self.relaxed_pa:g} Pa)")
        if self.exponent > 1.0:
            raise ValueError(f"FractionalZener.exponent must be at most 1, not {self.exponent!r}")
        log10_shift(self.t_ref_c, self.shift_c, self.c1, self.c2_k)

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G* in Pa, of the shape of the frequencies. Raises PoleError."""
        decades = self.log10_shift(temperature_c)
        z = (1j ** self.exponent) * (np.asarray(rate_rad_s) * (self.tau_s * 10.0**decades)) ** self.exponent
        return self.glassy_pa - (self.glassy_pa - self.relaxed_pa) / (1.0 + z)

    def log10_shift(self, temperature_c: float) -> float:
        """Return log10 of aT(T) / aT(t_ref). Raises PoleError."""
        of_reference = log10_shift(self.t_ref_c, self.shift_c, self.c1, self.c2_k)
        return log10_shift(temperature_c, self.shift_c, self.c1, self.c2_k) - of_reference


class DmaRow(NamedTuple):
    """One row of a dynamic mechanical analysis in tension or bending."""

    temperature_c: float
    frequency_hz: float
    storage_pa: float
    """E'"""
    loss_pa: float
    """E''"""


@dataclass(frozen=True, slots=True)
class EvenShift:
    """The same shift in kelvin per decade at every temperature (paper G, Eq 9)."""

    decade_k: float

    def __call__(self, temperature_c: float) -> float:
        """Return the addition to log10(f / Hz) for a temperature."""
        return -temperature_c / self.decade_k


@dataclass(frozen=True, slots=True)
class WlfShift:
    """The shift of Williams, Landel and Ferry about a temperature."""

    t_ref_c: float

    def __call__(self, temperature_c: float) -> float:
        """Return the addition to log10(f / Hz) for a temperature. Raises PoleError."""
        return log10_shift(temperature_c, self.t_ref_c)


class TabulatedModulus:
    """A measured modulus: log E' and log E'' by a monotone cubic over one abscissa, in decades of frequency.

    Made by ``of_sweep`` or ``of_grid``. Outside the measured range ``OutsideError`` is raised; with ``hold_ends``
    the end values continue instead, and ``beyond_decades`` is the greatest distance from the range so far.
    """

    def __init__(
        self,
        decades: Array,
        rows: Sequence[DmaRow],
        poisson: float,
        decade_of: Callable[[float], float],
        hold_ends: bool = False,
    ) -> None:
        """Take the rows with their abscissas, ascending; ``decade_of``: addition to log10(f / Hz) for a temperature."""
        self._decade_of = decade_of
        self._rows = tuple(rows)
        self._to_shear = 0.5 / (1.0 + poisson)
        self._least, self._most = float(decades[0]), float(decades[-1])
        self._log_storage = MonotoneCubic(decades, np.log10([row.storage_pa for row in rows]))
        self._log_loss = MonotoneCubic(decades, np.log10([row.loss_pa for row in rows]))
        self.hold_ends = hold_ends
        self.beyond_decades = 0.0
        """Greatest distance from the measured range in a call so far, decades of frequency; 0: no call outside yet."""

    def __repr__(self) -> str:
        """Return its content: two moduli of the same text are equal."""
        ends = f"{self._least!r} to {self._most!r}, {'held' if self.hold_ends else 'not held'}"
        return f"TabulatedModulus({self._decade_of!r}, {self._to_shear!r}, {ends}, {self._rows!r})"

    @classmethod
    def of_sweep(
        cls, rows: Iterable[DmaRow], poisson: float = 0.5, decade_k: float = 8.0, hold_ends: bool = False
    ) -> TabulatedModulus:
        """Return the modulus of a sweep of temperature at one frequency f0 (paper G, Eq 9).

        E(f, T) = E(f0, T - decade_k log10(f / f0)). Raises ValueError for unsuitable rows.
        """
        ordered = sorted(_checked(rows, poisson), key=lambda row: -row.temperature_c)
        if not (math.isfinite(decade_k) and decade_k > 0.0):
            raise ValueError(f"a decade of frequency corresponds to more than 0 K, not {decade_k!r}")
        if len({row.frequency_hz for row in ordered}) > 1:
            raise ValueError("a sweep of temperature has one frequency; a table of several is a grid")
        log_f0 = math.log10(ordered[0].frequency_hz)
        decade_of = EvenShift(decade_k)
        decades = np.array([log_f0 + decade_of(row.temperature_c) for row in ordered])
        if not np.all(np.diff(decades) > 0.0):
            raise ValueError("a sweep has every temperature once")
        return cls(decades, ordered, poisson, decade_of, hold_ends)

    @classmethod
    def of_grid(
        cls, rows: Iterable[DmaRow], glass_c: float, poisson: float = 0.5, hold_ends: bool = False
    ) -> TabulatedModulus:
        """Return the modulus of sweeps of frequency at several temperatures: one master curve by WLF, Ts = Tg + 50 K.

        Points within 0.1 decade are averaged (in logarithms). Raises ValueError for rows that give no curve,
        PoleError for a temperature without a shift.
        """
        decade_of = WlfShift(glass_c + GLASS_TO_REFERENCE_K)
        bins: dict[int, list[tuple[float, DmaRow]]] = {}
        for row in _checked(rows, poisson):
            decade = math.log10(row.frequency_hz) + decade_of(row.temperature_c)
            bins.setdefault(round(decade / MERGED_DECADES), []).append((decade, row))
        if len(bins) < 2:
            raise ValueError("all rows of the grid fall within a tenth of a decade: no master curve")
        places = [bins[number] for number in sorted(bins)]
        decades = np.array([float(np.mean([decade for decade, _ in place])) for place in places])
        merged = [_mean([row for _, row in place]) for place in places]
        return cls(decades, merged, poisson, decade_of, hold_ends)

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G* in Pa, of the shape of the frequencies. Raises OutsideError, PoleError."""
        offset = self._decade_of(temperature_c)
        x = np.log10(np.asarray(rate_rad_s) / (2.0 * math.pi)) + offset
        beyond = max(self._least - float(np.min(x)), float(np.max(x)) - self._most)
        if beyond > 0.0:
            # The ends themselves may fall outside by rounding alone.
            if beyond > 1e-9 and not self.hold_ends:
                low_hz, high_hz = self.limits_hz(temperature_c)
                asked = " to ".join(f"{10.0 ** (float(end) - offset):.3g}" for end in (np.min(x), np.max(x)))
                raise OutsideError(
                    f"the modulus at {temperature_c:g} degC is known from {low_hz:.3g} to {high_hz:.3g} Hz, "
                    f"not over {asked} Hz"
                )
            self.beyond_decades = max(self.beyond_decades, beyond if beyond > 1e-9 else 0.0)
            x = np.clip(x, self._least, self._most)
        return self._to_shear * (10.0 ** self._log_storage(x) + 1j * 10.0 ** self._log_loss(x))

    def reduced_hz(self, frequency_hz: float, temperature_c: float, at_c: float) -> float:
        """Return the frequency at ``at_c`` at which the modulus is that of another temperature. Raises PoleError."""
        return frequency_hz * 10.0 ** (self._decade_of(temperature_c) - self._decade_of(at_c))

    def limits_hz(self, temperature_c: float) -> tuple[float, float]:
        """Return the least and the greatest known frequency of the modulus at a temperature, Hz. Raises PoleError."""
        offset = self._decade_of(temperature_c)
        return 10.0 ** (self._least - offset), 10.0 ** (self._most - offset)


def _checked(rows: Iterable[DmaRow], poisson: float) -> list[DmaRow]:
    """Return the rows. Raises ValueError for fewer than two, or values that have no logarithm."""
    taken = list(rows)
    if len(taken) < 2:
        raise ValueError(f"a table of moduli has at least 2 rows, not {len(taken)}")
    if not 0.0 <= poisson <= 0.5:
        raise ValueError(f"Poisson's ratio is 0 to 0.5, not {poisson!r}")
    for number, row in enumerate(taken, start=1):
        if not math.isfinite(row.temperature_c):
            raise ValueError(f"row {number}: temperature_c must be finite, not {row.temperature_c!r}")
        for name, value in zip(row._fields[1:], row[1:], strict=True):
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"row {number}: {name} must be finite and above 0, not {value!r}")
    return taken


def _mean(rows: Sequence[DmaRow]) -> DmaRow:
    """Return the first row with the geometric means of the moduli."""
    storage = float(np.mean(np.log10([row.storage_pa for row in rows])))
    loss = float(np.mean(np.log10([row.loss_pa for row in rows])))
    return rows[0]._replace(storage_pa=10.0**storage, loss_pa=10.0**loss)


def _above_zero(group: ConstantModulus | FractionalZener, *names: str) -> None:
    """Raise ValueError unless these numbers are finite and above 0."""
    for name in names:
        value: float = getattr(group, name)
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{type(group).__name__}.{name} must be finite and above 0, not {value!r}")


class MonotoneCubic:
    """A cubic through points without overshoot (Fritsch and Carlson's, slopes of Fritsch and Butland).

    y(x) is once differentiable; between two points it stays between their values. Outside it is not defined."""

    def __init__(self, x: Array, y: Array) -> None:
        """Take at least two points, x strictly ascending."""
        self._x, self._y = x, y
        step = np.diff(x)
        rise = np.diff(y) / step
        slope = np.empty_like(y)
        if len(x) == 2:
            slope[:] = rise[0]
        else:
            slope[1:-1] = _inner(step, rise)
            slope[0] = _end(step[0], step[1], rise[0], rise[1])
            slope[-1] = _end(step[-1], step[-2], rise[-1], rise[-2])
        self._slope, self._step = slope, step

    def __call__(self, at: Array) -> Array:
        """Return y, of the shape of ``at``."""
        i = np.clip(np.searchsorted(self._x, at, side="right") - 1, 0, len(self._x) - 2)
        h = self._step[i]
        t = (at - self._x[i]) / h
        s = 1.0 - t
        return (
            self._y[i] * (s * s * (1.0 + 2.0 * t))
            + self._y[i + 1] * (t * t * (3.0 - 2.0 * t))
            + h * (self._slope[i] * (t * s * s) - self._slope[i + 1] * (t * t * s))
        )


def _inner(step: Array, rise: Array) -> Array:
    """Return the slopes at inner points: weighted harmonic means, 0 where the rise changes its sign."""
    left, right = rise[:-1], rise[1:]
    same = left * right > 0.0
    weight, other = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    safe_left, safe_right = np.where(same, left, 1.0), np.where(same, right, 1.0)
    return np.where(same, (weight + other) / (weight / safe_left + other / safe_right), 0.0)


def _end(step: float, next_step: float, rise: float, next_rise: float) -> float:
    """Return the slope at an end from three points, limited so that the curve does not overshoot."""
    slope = ((2.0 * step + next_step) * rise - step * next_rise) / (step + next_step)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
