"""The reference temperature of the shift that brings conditions closest to one curve, with its interval.

For a trial Ts, x = log10 v + log10 aT(T; Ts), and ln mu(x) is a cubic spline by least squares with knots at quantiles
of x; Akaike's criterion (corrected for few data) sets their number. Ts minimises the residual: a grid, then a golden
section. The interval is that of resampled residuals (and of the common residual of each temperature), with the
thermometer's bias drawn as well: an error common to all temperatures moves Ts by as much.

Several runs have a factor each, held near 1 by its standard uncertainty.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, log, sqrt
from typing import Final, NamedTuple

import numpy as np

from sim.physics.wlf import C2_K, log10_shift
from tester.analysis.master_curve.points import MasterError, MasterSet
from tester.analysis.master_curve.spline import basis, left_over, orthonormal, quantile_knots, slopes
from tester.base.arrays import Array, Places

BELOW_K: Final = 100.0
"""Lower end of the search for Ts, K below the lowest temperature [A]; the constants are stated to hold to Ts + 50 K."""
POLE_K: Final = 1.0
"""Upper end: distance from the Ts that puts the lowest temperature at the pole of the shift, K."""
GRID_K: Final = 4.0
MOST_KNOTS: Final = 20
"""Interior knots: two peaks 1.9 decades apart, over twelve decades, take 15 to 19."""
ROWS_A_KNOT: Final = 5
"""Least number of conditions for each knot [A]."""
LEAST_ROWS: Final = 12
"""Least number of conditions of a curve [A]."""
_LEAST_LN: Final = 1e-4
"""A residual of ln mu below which a further knot improves nothing."""
PILOT: Final = 0.02
"""Scatter of ln mu that weighs the factors of several runs against their uncertainty [A]."""
RESAMPLES: Final = 400
_REACH: Final = 6.0
"""Range of the search for Ts in resamples, standard uncertainties."""
_GOLDEN: Final = 0.5 * (sqrt(5.0) - 1.0)
_STEP_K: Final = 0.01


@dataclass(frozen=True, slots=True)
class Curve:
    """A spline through a collapsed set: ``knots`` over x at Ts, ``weights`` of its B-splines, ``factors`` of runs."""

    knots: Array
    weights: Array
    factors: Array

    def at(self, x: Array) -> Array:
        """Return ln mu at x (at Ts), clipped to the knots."""
        return np.asarray(basis(np.clip(x, self.knots[0], self.knots[-1]), self.knots) @ self.weights)

    def slope(self, x: Array) -> Array:
        """Return d ln mu / dx."""
        return np.asarray(slopes(np.clip(x, self.knots[0], self.knots[-1]), self.knots) @ self.weights)


class Drawn(NamedTuple):
    """Sets resampled from a curve: ``y`` is ln mu, followed by the prior of the factors, shape (n + factors, B),
    ``ts_c`` the Ts of each set, ``thermometer_k`` the error of its thermometer, both (B,)."""

    y: Array
    ts_c: Array
    thermometer_k: Array


@dataclass(frozen=True, slots=True)
class Collapse:
    """A set on one curve: ``x`` at Ts, ``residual`` of ln mu, shape (n,).

    ``interval``: 95 % of Ts, degC, equal to Ts where the caller fixed it. ``u_fit_k``: its standard uncertainty without
    the thermometer; ``u_factors_k``: the same if every temperature had a factor of its own, infinite where any Ts then
    fits as well. ``at_end``: the search ended at an end of its range.
    """

    ts_c: float
    searched: bool
    interval: tuple[float, float]
    u_fit_k: float
    u_factors_k: float
    at_end: bool
    interior: int
    x: Array
    residual: Array
    curve: Curve
    of: MasterSet
    drawn: Drawn | None = None

    @property
    def parameters(self) -> int:
        """Return the number of fitted parameters: of the spline, and Ts."""
        return self.interior + 4 + self.searched

    @property
    def scatter(self) -> float:
        """Return the standard deviation of ln mu about the curve."""
        return sqrt(float(np.sum(self.residual**2)) / max(self.residual.size - self.parameters, 1))

    @property
    def scatter_rms(self) -> float:
        """Return the root mean square of the residuals of ln mu."""
        return sqrt(float(np.mean(self.residual**2)))

    @property
    def scatter_mu(self) -> float:
        """Return the root mean square distance of the coefficients from the curve."""
        mu = np.exp(self.of.log_mu)
        return sqrt(float(np.mean((mu - mu * np.exp(-self.residual)) ** 2)))

    def design(self) -> Array:
        """Return the columns of the curve and of the sources' factors; the rows match ``padded`` values."""
        return _columns(self.of, self.x, self.interior)

    def moved_by_ts(self) -> Array:
        """Return d ln mu / d Ts at each condition, 1/K, by the curve's slope."""
        step = _STEP_K
        ahead, behind = shifts(self.of.celsius, self.ts_c + step), shifts(self.of.celsius, self.ts_c - step)
        return self.curve.slope(self.x) * (ahead - behind) / (2.0 * step)


def shifts(celsius: Array, ts_c: float) -> Array:
    """Return log10 aT at temperatures, shape (n,). Raises PoleError."""
    return np.array([log10_shift(float(temperature), ts_c) for temperature in celsius])


def padded(of: MasterSet, values: Array) -> Array:
    """Return values (n, ...) with a zero for the prior of each source's factor, where there are several sources."""
    more = of.gains.size if of.gains.size > 1 else 0
    return np.concatenate([values, np.zeros((more, *values.shape[1:]))])


def _columns(of: MasterSet, x: Array, interior: int) -> Array:
    splines = basis(x, quantile_knots(x, interior))
    sources = of.gains.size
    if sources == 1:
        return splines
    of_source = np.asarray(of.source[:, None] == np.arange(sources), dtype=np.float64)
    priors = np.diag(PILOT / np.maximum(of.gains, 1e-6))
    return np.block([[splines, of_source], [np.zeros((sources, splines.shape[1])), priors]])


def collapse(of: MasterSet, ts_c: float | None = None, resamples: int = RESAMPLES, seed: int = 0) -> Collapse:
    """Return a set on one curve; ``ts_c``: Ts of the shift, degC, None: it is searched.

    Raises MasterError for too few conditions, PoleError for a Ts that puts a temperature at the pole.
    """
    n = of.log_v.size
    if n < LEAST_ROWS:
        raise MasterError(f"{n} conditions are too few for a curve (expected at least {LEAST_ROWS})")
    y = padded(of, of.log_mu)
    coldest_c = float(np.min(of.celsius))
    low, high = coldest_c - BELOW_K, coldest_c + C2_K - POLE_K

    def left(trial_c: float, interior: int) -> float:
        return left_of(of, of.log_v + shifts(of.celsius, trial_c), interior, y)

    trials = np.arange(low, high, GRID_K) if ts_c is None else np.array([ts_c])
    candidates = [
        (criterion(min_left, n, k), k, at)
        for k in numbers_of_knots(n)
        for min_left, at in [_least(left, trials, k)]
    ]
    _, interior, nearest_c = min(candidates)
    best_c = nearest_c
    if ts_c is None:
        within = max(low, nearest_c - GRID_K), min(high, nearest_c + GRID_K)
        best_c = golden(lambda at: left(at, interior), *within)
    x = of.log_v + shifts(of.celsius, best_c)
    curve, residual = curve_through(of, x, interior, y)
    ends = min(best_c - low, high - best_c) < GRID_K
    at_best = Collapse(
        best_c, ts_c is None, (best_c, best_c), 0.0, inf, ts_c is None and ends, interior, x, residual, curve, of
    )
    return _with_interval(at_best, (low, high), resamples, seed)


def curve_through(of: MasterSet, x: Array, interior: int, y: Array) -> tuple[Curve, Array]:
    """Return the spline through ``y`` (``padded``) at x with ``interior`` knots, and its residuals, shape (n,)."""
    columns = _columns(of, x, interior)
    weights: Array = np.asarray(np.linalg.lstsq(columns, y, rcond=None)[0], dtype=np.float64)
    knots = quantile_knots(x, interior)
    splines = knots.size - 4
    return Curve(knots, weights[:splines], weights[splines:]), (y - columns @ weights)[: x.size]


def _least(left: Callable[[float, int], float], trials: Array, interior: int) -> tuple[float, float]:
    return min((left(float(at), interior), float(at)) for at in trials)


def numbers_of_knots(n: int) -> range:
    """Return the numbers of interior knots to try for n conditions; every other one, to save time."""
    return range(0, min(MOST_KNOTS, n // ROWS_A_KNOT) + 1, 2)


def left_of(of: MasterSet, x: Array, interior: int, y: Array) -> float:
    """Return the sum of squares of ``y`` (``padded``) about its spline over x with ``interior`` knots."""
    return float(np.sum(left_over(orthonormal(_columns(of, x, interior)), y) ** 2))


def criterion(left: float, n: int, interior: int) -> float:
    """Return Akaike's criterion, corrected for few data, of a spline and a shift: -2 ln likelihood with a penalty."""
    p = interior + 5
    return n * log(max(left / n, _LEAST_LN**2)) + 2.0 * p + 2.0 * p * (p + 1) / max(n - p - 1, 1)


def golden(value: Callable[[float], float], low: float, high: float, within: float = 1e-3) -> float:
    """Return the place of a function's minimum between two places, within a distance."""
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_a, at_b = value(a), value(b)
    while high - low > within:
        if at_a <= at_b:
            high, b, at_b = b, a, at_a
            a = high - _GOLDEN * (high - low)
            at_a = value(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + _GOLDEN * (high - low)
            at_b = value(b)
    return 0.5 * (low + high)


def _with_interval(point_estimate: Collapse, bounds: tuple[float, float], resamples: int, seed: int) -> Collapse:
    """Return a collapse with the uncertainty of its Ts."""
    of, n = point_estimate.of, point_estimate.residual.size
    moved = padded(of, point_estimate.moved_by_ts())
    columns = point_estimate.design()
    u_k = point_estimate.scatter / _length(left_over(orthonormal(columns), moved))
    factors = np.column_stack([columns, padded(of, of.in_block)])
    u_factors_k = point_estimate.scatter / _length(left_over(orthonormal(factors), moved))
    random = np.random.default_rng(seed)
    spread = point_estimate.residual * sqrt(n / max(n - point_estimate.parameters, 1))
    drawn_alone = random.choice(spread - np.mean(spread), (n, resamples))
    in_common = _between(point_estimate.residual, of) * random.standard_normal((len(of.blocks_c), resamples))
    y = padded(of, (of.log_mu - point_estimate.residual)[:, None] + drawn_alone + in_common[of.block])
    thermometer_k = of.thermometer_k * random.standard_normal(resamples)
    # A Ts that the caller fixed has no interval.
    if not point_estimate.searched:
        drawn = Drawn(y, np.full(resamples, point_estimate.ts_c), thermometer_k)
        return replace(point_estimate, u_factors_k=u_factors_k, drawn=drawn)
    reach = min(max(_REACH * u_k, 0.2), BELOW_K)
    trials = np.linspace(max(bounds[0], point_estimate.ts_c - reach), min(bounds[1], point_estimate.ts_c + reach), 49)
    left = np.array([_left_at(of, float(at), point_estimate.interior, y) for at in trials])
    ts_drawn = _lowest(trials, left)
    low, high = np.quantile(ts_drawn + thermometer_k, [0.025, 0.975])
    return replace(
        point_estimate, interval=(float(low), float(high)), u_fit_k=float(np.std(ts_drawn)), u_factors_k=u_factors_k,
        drawn=Drawn(y, ts_drawn, thermometer_k),
    )  # fmt: skip


def _length(values: Array) -> float:
    return max(sqrt(float(np.sum(values**2))), 1e-12)


def _between(residual: Array, of: MasterSet) -> float:
    """Return the standard deviation of ln mu common to the conditions of a temperature (analysis of variance)."""
    inside = of.in_block
    counts = np.sum(inside, axis=0)
    blocks, n = counts.size, residual.size
    if blocks < 2 or n <= blocks:
        return 0.0
    means = (inside.T @ residual) / counts
    within = float(np.sum((residual - inside @ means) ** 2)) / (n - blocks)
    between = float(np.sum(counts * means**2)) / (blocks - 1)
    return sqrt(max(between - within, 0.0) * blocks / n)


def _left_at(of: MasterSet, ts_c: float, interior: int, y: Array) -> Array:
    q = orthonormal(_columns(of, of.log_v + shifts(of.celsius, ts_c), interior))
    return np.asarray(np.sum(y**2, axis=0) - np.sum((q.T @ y) ** 2, axis=0))


def _lowest(at: Array, values: Array) -> Array:
    """Return the minimum of each column of ``values`` (m, B), by a parabola through three of the places ``at`` (m,)."""
    place = np.clip(np.argmin(values, axis=0), 1, at.size - 2)
    column: Places = np.arange(values.shape[1], dtype=np.intp)
    before, here, after = values[place - 1, column], values[place, column], values[place + 1, column]
    bend = before - 2.0 * here + after
    share = np.where(bend > 0.0, 0.5 * (before - after) / np.where(bend > 0.0, bend, 1.0), 0.0)
    return np.asarray(at[place] + np.clip(share, -1.0, 1.0) * (at[1] - at[0]))
