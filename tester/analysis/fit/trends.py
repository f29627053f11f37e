"""Trends of a fitted law that do not depend on its form: peaks, exponents, whether it rises or falls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Final

import numpy as np

from tester.analysis.drift import PER_KELVIN_PERCENT
from tester.analysis.fit.check import levels
from tester.analysis.fit.fit_law import NAN, FitPoint, Law, Variable
from tester.analysis.fit.resample import Resamples
from tester.base.arrays import Array

_GRID: Final = 401
"""Points of the search for a peak, over the range of the data."""
_EDGE: Final = 0.01
"""Share of the range, at each end, in which a largest value is no peak."""
_SURE: Final = 0.95
"""Share of resamples that must agree."""
_LEAST_MU: Final = 1e-9
"""Floor of a law's value: a resample's law may yield 0 or less where it has no conditions."""
_NEARBY: Final = 1e-4
"""Relative step for a slope."""

Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Trend:
    """Trend of the coefficient with one variable, others as in ``Trends.at``.

    ``peak``: value of the variable at the largest coefficient, NaN at an end of the range; ``inside``: share of
    resamples with a peak inside. ``exponent``: d ln mu / d ln x at ``Trends.at``, or d ln mu / dx for a variable
    without a true zero. ``change``: ln of the coefficient at the upper end over the lower, ``agree``: share of
    resamples in which it has that sign. ``own_heat``: why the change cannot be separated from an effect of the
    contact's own heat, "" where it can.
    """

    variable: Variable
    low: float
    high: float
    peak: float
    peak_interval: Interval
    inside: float
    exponent: float
    exponent_interval: Interval
    change: float
    agree: float
    own_heat: str = ""

    @property
    def word(self) -> str:
        """Return the trend over the range of the data, in words."""
        if self.own_heat:
            return f"not resolved: {self.own_heat}"
        if self.inside > _SURE:
            return "rises to a peak, then falls"
        if self.inside >= 1.0 - _SURE:
            return "not resolved: a peak inside in some resamples, none in others"
        if self.agree < _SURE:
            return "not resolved from none"
        return "rises" if self.change > 0.0 else "falls"


@dataclass(frozen=True, slots=True)
class Trends:
    """Trends with each variable that was varied, at a point of the data."""

    at: tuple[float, ...]
    each: tuple[Trend, ...]


def trends_of(law: Law, points: Sequence[FitPoint], fitted: Sequence[float], resamples: Resamples) -> Trends:
    """Return the trends of a fit at the nominal values that most conditions share."""
    at = tuple(_usual(points, i) for i in range(len(law.variables)))
    varied = [i for i in range(len(at)) if len(levels(points, i)) > 1]
    return Trends(at, tuple(_trend(law, points, at, i, fitted, resamples) for i in varied))


def _usual(points: Sequence[FitPoint], variable: int) -> float:
    counted = Counter(point.nominal[variable] for point in points)
    most = max(counted.values())
    return min(value for value, count in counted.items() if count == most)


def _trend(
    law: Law, points: Sequence[FitPoint], at: Sequence[float], i: int, fitted: Sequence[float], resamples: Resamples
) -> Trend:
    nominal = levels(points, i)
    low, high = nominal[0], nominal[-1]
    parameters = np.concatenate([np.array([fitted]), resamples.parameters])

    margin = _EDGE * (high - low)
    grid = np.tile(np.array(at), (_GRID, 1))
    grid[:, i] = np.linspace(low, high, _GRID)
    curves = np.maximum(law.value(parameters, grid), _LEAST_MU)
    peaks = grid[np.argmax(curves, axis=-1), i]
    inside = [low < peak - margin and peak + margin < high for peak in map(float, peaks)]
    changes = [float(change) for change in np.log(curves[:, -1] / curves[:, 0])]
    agreeing = [change * changes[0] > 0.0 for change in changes[1:]]
    slopes = _slopes(law, at, i, parameters)
    return Trend(
        variable=law.variables[i],
        low=low,
        high=high,
        peak=float(peaks[0]) if inside[0] else NAN,
        peak_interval=resamples.interval(peaks[1:]) if inside[0] else (NAN, NAN),
        inside=fmean(inside[1:] or inside),
        exponent=float(slopes[0]),
        exponent_interval=resamples.interval(slopes[1:]),
        change=changes[0],
        agree=fmean(agreeing) if agreeing else NAN,
        own_heat=_own_heat(points, i, float(np.ptp(np.log(curves[0])))),
    )


def _own_heat(points: Sequence[FitPoint], variable: int, change: float) -> str:
    """Return why a change of ln mu along a variable may be due to the contact's own heat, "" where it cannot be."""
    nominal = levels(points, variable)
    warmed = [[point.own_heat_k for point in points if point.nominal[variable] == level] for level in nominal]
    means = [fmean(warming) for warming in warmed]
    more_k = max(means) - min(means)
    could = 0.01 * PER_KELVIN_PERCENT * more_k
    if not more_k > 0.0 or change > could:
        return ""
    return (
        f"friction warms the contact by up to {more_k:.1f} K more at some, which can change it by {100.0 * could:.0f} %"
        f" ({PER_KELVIN_PERCENT:g} %/K [A])"
    )


def _slopes(law: Law, at: Sequence[float], i: int, everyone: Array) -> Array:
    """Return d ln mu / d ln x of each set of parameters, or d ln mu / dx for a variable without a true zero."""
    near = np.tile(np.array(at), (2, 1))
    step = _NEARBY * abs(at[i]) if at[i] else _NEARBY
    near[:, i] = at[i] - step, at[i] + step
    values = np.log(np.maximum(law.value(everyone, near), _LEAST_MU))
    slopes = (values[:, 1] - values[:, 0]) / (2.0 * step)
    return slopes * at[i] if law.variables[i].ratio else slopes
