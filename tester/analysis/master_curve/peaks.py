"""The maxima of a master curve, with their intervals."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Final

import numpy as np

from tester.analysis.master_curve.collapse import Collapse, Curve, curve_through, padded, shifts
from tester.base.arrays import Array

PROMINENT: Final = 0.02
"""A maximum of the curve counts where ln mu falls by more than this on both sides [A] ..."""
SCATTERS: Final = 3.0
"""... and by more than this many times the scatter about the curve [A]: a spline rings on flat ground."""
PLACES: Final = 1000
DRAWN: Final = 200
"""Resampled sets in which each maximum is searched again."""
FINER: Final = 4
"""Additional knots of the finer spline that shows how far smoothing moves a maximum [A]."""
SURE: Final = 0.95
"""Share of the resampled sets that must have the maximum."""
REACH_DECADES: Final = 1.0
"""Distance within which a maximum counts as the same, for a curve's only maximum [A]; for several, half their distance.
"""


@dataclass(frozen=True, slots=True)
class Peak:
    """A maximum of the master curve: its speed in m/s at the reference temperature with its 95 % interval, and mu."""

    speed_m_s: float
    mu: float
    interval_m_s: tuple[float, float] = (nan, nan)


def peaks_of(collapse: Collapse, reference_c: float) -> tuple[tuple[Peak, ...], int]:
    """Return the maxima of a master curve that are not due to its scatter, from slow to fast, and the number of the
    others; raises PoleError for the reference temperature.

    A maximum counts where a share ``SURE`` of the resampled sets has one as well. Its interval includes its place on a
    curve of ``FINER`` more knots: a spline that smooths detail away moves a maximum, and resampling does not show that.
    """
    back = _back(collapse.ts_c, reference_c)
    least = max(PROMINENT, SCATTERS * collapse.scatter)
    maxima = [(x - back, mu) for x, mu in _maxima(collapse.curve, collapse.x, least)]
    if not maxima or collapse.drawn is None:
        return tuple(Peak(float(10.0**x), mu) for x, mu in maxima), 0
    places = [x for x, _ in maxima]
    again = [_maxima_again(collapse, i, reference_c) for i in range(min(DRAWN, collapse.drawn.ts_c.size))]
    finer, _ = curve_through(
        collapse.of,
        collapse.x,
        min(collapse.interior + FINER, collapse.x.size // 3),
        padded(collapse.of, collapse.of.log_mu),
    )
    places_finer = [at - back for at, _ in _maxima(finer, collapse.x)]
    peaks: list[Peak] = []
    for x, mu in maxima:
        reach = min([0.5 * abs(x - other) for other in places if other != x], default=REACH_DECADES)
        near = [min(maxima_again, key=lambda at, x=x: abs(at - x)) for maxima_again in again if maxima_again]
        same = [at for at in near if abs(at - x) <= reach]
        if len(same) >= SURE * len(again):
            moved = min((at - x for at in places_finer if abs(at - x) <= reach), key=abs, default=0.0)
            low, high = np.quantile(same, [0.025, 0.975]) + np.array([min(moved, 0.0), max(moved, 0.0)])
            peaks.append(Peak(float(10.0**x), mu, (float(10.0**low), float(10.0**high))))
    return tuple(peaks), len(maxima) - len(peaks)


def _maxima_again(collapse: Collapse, i: int, reference_c: float) -> list[float]:
    """Return x, at the reference temperature, of each maximum of the curve fitted to resampled set ``i``."""
    assert collapse.drawn is not None
    ts_c = float(collapse.drawn.ts_c[i])
    x = collapse.of.log_v + shifts(collapse.of.celsius, ts_c)
    curve, _ = curve_through(collapse.of, x, collapse.interior, collapse.drawn.y[:, i])
    back = _back(ts_c, reference_c - float(collapse.drawn.thermometer_k[i]))
    return [at - back for at, _ in _maxima(curve, x)]


def _back(ts_c: float, reference_c: float) -> float:
    return float(shifts(np.array([reference_c]), ts_c)[0])


def _maxima(curve: Curve, over: Array, least: float = PROMINENT) -> list[tuple[float, float]]:
    """Return x and mu of the maxima of a curve within a range, where ln mu falls by more than ``least`` from them."""
    x = np.linspace(float(np.min(over)), float(np.max(over)), PLACES)
    y = curve.at(x)
    return [
        (float(x[i]), float(np.exp(y[i])))
        for i in np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
        if min(_falls(y[i::-1]), _falls(y[i:])) > least
    ]


def _falls(y: Array) -> float:
    """Return how far values fall from the first before they rise above it."""
    above = np.flatnonzero(y > y[0])
    return float(y[0] - np.min(y[: above[0]] if above.size else y))
