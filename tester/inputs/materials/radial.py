"""The radial power spectrum of a map of heights, by a fast Fourier transform under a Hann window.

C(q) = (2 pi)^-2 int <h h> exp(-iqx) d2x in m^4, so that <h^2> = 2 pi int q C dq, averaged over directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tester.base.arrays import Array

Detrend = Literal["mean", "plane"]
PER_DECADE = 20
"""Rings of the table in a decade of q [A]; none is thinner than the map resolves."""
LEAST_POINTS = 16
"""Least number of points along each side of a map [A]: with fewer there are no decades of waves."""


@dataclass(frozen=True, slots=True)
class RadialSpectrum:
    """C at ascending wave numbers: 1/m and m^4."""

    q_1_m: Array
    power_m4: Array

    @property
    def rms_height_m(self) -> float:
        """Return the root of 2 pi int q C dq over the table, m; linear in logarithms between points."""
        return self._root(1)

    @property
    def rms_slope(self) -> float:
        """Return the root of 2 pi int q^3 C dq over the table."""
        return self._root(3)

    def _root(self, order: int) -> float:
        x = np.log(self.q_1_m)
        y = (order + 1) * x + np.log(self.power_m4)
        steps, rises = np.diff(x), np.diff(y)
        flat = np.abs(rises) < 1e-9
        # The integral of exp(y) over a step with straight y; where y is constant, the value times the step.
        share = np.where(flat, 1.0, np.expm1(rises) / np.where(flat, 1.0, rises))
        return float(np.sqrt(2.0 * np.pi * np.sum(np.exp(y[:-1]) * share * steps)))


def detrended(heights_m: Array, pixel_m: tuple[float, float], detrend: Detrend) -> Array:
    """Return heights without their mean, or without their plane of least squares; heights (rows, columns) in m."""
    flat = heights_m - heights_m.mean()
    if detrend == "mean":
        return flat
    # Even grids about their middle: the two slopes are independent.
    for axis in (0, 1):
        x = _places(flat.shape[axis], pixel_m[axis])
        slope = float(np.mean(flat, axis=1 - axis) @ x / (x @ x))
        flat = flat - slope * (x[:, None] if axis == 0 else x[None, :])
    return flat


def _places(points: int, apart_m: float) -> Array:
    return apart_m * (np.arange(points, dtype=np.float64) - (points - 1) / 2.0)


def radial_spectrum(heights_m: Array, pixel_m: tuple[float, float]) -> RadialSpectrum:
    """Return the spectrum of detrended heights (rows, columns) in m; ``pixel_m``: from row to row, column to column.

    Rings of wave numbers are averaged, from the longest wave that fits the shorter side to the shortest that two points
    resolve. The table is scaled to the mean square in its rings, a few per cent for a rough surface. Raises ValueError
    for a map that is too small, or flat.
    """
    rows, columns = heights_m.shape
    if min(rows, columns) < LEAST_POINTS:
        raise ValueError(f"{rows} x {columns} heights are too few (expected {LEAST_POINTS} x {LEAST_POINTS} or more)")
    window = np.outer(_hann(rows), _hann(columns))
    weighted = heights_m * window
    # The window would turn a remaining mean into a long wave.
    weighted -= window * (weighted.sum() / window.sum())
    amplitude = np.fft.rfft2(weighted) / (rows * columns)
    area_m2 = rows * pixel_m[0] * columns * pixel_m[1]
    power = area_m2 / (4.0 * np.pi**2) * np.abs(amplitude) ** 2 / np.mean(window**2)
    q = 2.0 * np.pi * np.hypot(np.fft.fftfreq(rows, pixel_m[0])[:, None], np.fft.rfftfreq(columns, pixel_m[1])[None, :])
    # A real map's transform has each wave twice; this half counts double except at its two edges.
    counted = np.full(q.shape, 2.0)
    counted[:, 0] = 1.0
    if columns % 2 == 0:
        counted[:, -1] = 1.0
    edges = _edges(2.0 * np.pi / min(rows * pixel_m[0], columns * pixel_m[1]), np.pi / max(pixel_m))
    ring = np.digitize(q.ravel(), edges)
    total = np.bincount(ring, counted.ravel(), len(edges) + 1)[1:-1]
    mean_power = np.bincount(ring, (counted * power).ravel(), len(edges) + 1)[1:-1]
    mean_q = np.bincount(ring, (counted * q).ravel(), len(edges) + 1)[1:-1]
    kept = (total > 0.0) & (mean_power > 0.0)
    if np.count_nonzero(kept) < 2:
        raise ValueError("the heights are all alike: there is no spectrum")
    spectrum = RadialSpectrum(mean_q[kept] / total[kept], mean_power[kept] / total[kept])
    # Lines between the points miss part of a narrow ring's power; the table must have the mean square of the rings.
    mean_square = mean_power.sum() * 4.0 * np.pi**2 / area_m2
    return RadialSpectrum(spectrum.q_1_m, spectrum.power_m4 * mean_square / spectrum.rms_height_m**2)


def _hann(points: int) -> Array:
    """Return the periodic Hann window."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(points) / points)


def _edges(step_1_m: float, last_1_m: float) -> Array:
    """Return the edges of the rings from half a step on: one step apart, further out evenly spaced in logarithms."""
    edges = [0.5 * step_1_m]
    while edges[-1] < last_1_m:
        edges.append(max(edges[-1] + step_1_m, edges[-1] * 10.0 ** (1.0 / PER_DECADE)))
    edges[-1] = last_1_m * (1.0 + 1e-9)
    return np.array(edges)
