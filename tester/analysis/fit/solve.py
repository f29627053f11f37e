"""The least squares of one group, in residuals of ln mu at the measured conditions, and the search for the least.

SciPy searches for the fit itself, a batch of Levenberg-Marquardt steps for its hundreds of resamples. Both minimise the
same sum: soft L1 of the weighted residuals, ``2 f^2 (sqrt(1 + (r / f)^2) - 1)`` with f = ROBUST.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Any, Final, cast

import numpy as np

from tester.analysis.fit.fit_law import FitError, FitPoint, Law, Source
from tester.base.arrays import Array, Booleans
from tester.base.plugins import MissingExtraError, needs

ROBUST: Final = 0.05
"""Residual in ln mu above which a condition counts less than its square (soft L1): 5 % [A]."""
_LEAST_MU: Final = 1e-9
_MOST_MU: Final = 1e9
"""Limits of a law's value: an impossible coefficient, 0 or less or infinite, is clipped, so the search avoids it."""
_STEP: Final = 1e-6
"""Step of the differences for derivatives, in steps of the search."""
_WIDEST: Final = 50.0
"""Largest logarithm of a parameter: keeps a search that has gone astray finite."""


@dataclass(frozen=True, slots=True)
class _Shared:
    """An error common to some conditions: a further unknown with a prior of mean 0."""

    rows: Array
    standard: float
    variable: int | None


class FitProblem:
    """Conditions as arrays, weights, and the free parameters.

    The search vector ``z`` has shape (..., q): the free parameters (logarithms of those that are positive), then the
    errors common to a source, in units of their standard uncertainty. Everything is evaluated for many ``z`` at once.
    """

    def __init__(self, law: Law, points: Sequence[FitPoint], held: Mapping[str, float]) -> None:
        """``held``: parameters that are not fitted, by name. Raises FitError for an unknown name, or a value out of
        range."""
        self.law, self.points = law, tuple(points)
        unknown = sorted(set(held) - set(law.names))
        if unknown:
            raise FitError(f"no parameter {', '.join(unknown)} of the law {law.name} (it has {', '.join(law.names)})")
        self.free = tuple(i for i, parameter in enumerate(law.parameters) if parameter.name not in held)
        self._positive = np.array([parameter.positive for parameter in law.parameters])
        for parameter in law.parameters:
            if parameter.positive and parameter.name in held and not held[parameter.name] > 0.0:
                raise FitError(f"{parameter.name} is held at {held[parameter.name]:g} (expected above 0)")
        self._held = np.array([held.get(parameter.name, 1.0) for parameter in law.parameters])
        self.x: Array = np.array([point.measured for point in points], dtype=np.float64)
        self.y: Array = np.log(np.array([point.value for point in points], dtype=np.float64))
        self.sigma: Array = _sigmas(points)
        """Standard deviation of each condition's ln mu from independent scatter; 1 where unknown."""
        self.reference = sqrt(1.0 / float(np.mean(1.0 / self.sigma**2)))
        """The standard deviation that represents all conditions."""
        self.weight: Array = self.reference / self.sigma
        self._shared = _shared(points)
        self.steps: Array = np.array([*(law.parameters[i].step for i in self.free), *(1.0 for _ in self._shared)])

    @property
    def priors(self) -> int:
        """Return how many errors common to a source are unknowns of the fit."""
        return len(self._shared)

    def inward(self, natural: Sequence[float]) -> Array:
        """Return the search vector of a law's parameters, with the common errors at 0."""
        values = [log(natural[i]) if self._positive[i] else natural[i] for i in self.free]
        return np.array([*values, *(0.0 for _ in self._shared)])

    def natural(self, z: Array) -> Array:
        """Return the law's parameters, shape (..., p)."""
        parameters = np.broadcast_to(self._held, (*z.shape[:-1], len(self._held))).copy()
        for place, i in enumerate(self.free):
            searched = z[..., place]
            parameters[..., i] = np.exp(np.clip(searched, -_WIDEST, _WIDEST)) if self._positive[i] else searched
        return parameters

    def logarithms(self, z: Array) -> Array:
        """Return ln mu of the law for the conditions, with the common errors, shape (..., n)."""
        x, gain = self.x, np.zeros(())
        for j, one in enumerate(self._shared):
            error = one.standard * z[..., len(self.free) + j, None] * one.rows
            if one.variable is None:
                gain = gain + error
            else:
                moved = np.zeros((*error.shape, x.shape[-1]))
                moved[..., one.variable] = error
                x = x + moved
        with np.errstate(over="ignore", invalid="ignore"):  # a search that goes astray for a step
            value = np.nan_to_num(self.law.value(self.natural(z), x), nan=_LEAST_MU, posinf=_MOST_MU)
        return np.log(np.clip(value, _LEAST_MU, _MOST_MU)) + gain

    def residuals(self, z: Array, y: Array, prior: Array) -> Array:
        """Return weighted residuals, shape (..., n + priors): of ln mu against ``y``, of errors against ``prior``."""
        of_data = self.weight * (self.logarithms(z) - y)
        of_prior = self.reference * (z[..., len(self.free) :] - prior)
        return np.concatenate([of_data, of_prior], axis=-1)

    def jacobian(self, z: Array, y: Array, prior: Array) -> Array:
        """Return the derivatives of the residuals, shape (..., n + priors, q)."""
        columns: list[Array] = []
        for j, step in enumerate(_STEP * self.steps):
            away = np.zeros(z.shape[-1])
            away[j] = step
            ahead, behind = self.residuals(z + away, y, prior), self.residuals(z - away, y, prior)
            columns.append((ahead - behind) / (2.0 * step))
        return np.stack(columns, axis=-1)


def _sigmas(points: Sequence[FitPoint]) -> Array:
    """Return the standard deviation of each condition's ln mu.

    Conditions without repeats get the mean variance of those with repeats. Without any repeats all get 1.
    """
    known = [point.type_a**2 for point in points if point.type_a == point.type_a]
    if not known:
        return np.ones(len(points))
    mean = sum(known) / len(known)
    squares = [
        (point.type_a**2 if point.type_a == point.type_a else mean) + point.own**2 + point.between**2
        for point in points
    ]
    return np.sqrt(np.maximum(squares, 1e-12))


def _shared(points: Sequence[FitPoint]) -> tuple[_Shared, ...]:
    sources = dict.fromkeys(point.source for point in points)
    return tuple(
        _Shared(_rows(points, source, common.piece), common.standard, common.variable)
        for source in sources
        for common in source.common
        if common.standard > 0.0
    )


def _rows(points: Sequence[FitPoint], source: Source, piece: int) -> Array:
    """Return 1 for each condition of a source and a piece (0: any piece), and 0 for the others."""
    return np.array([float(point.source == source and piece in (0, point.piece)) for point in points])


MOST_EVALUATIONS: Final = 2000
MOST_STEPS: Final = 60
_SMALL: Final = 1e-9
"""A step of the search, in its units, that counts as converged."""
_DAMPING: Final = (1e-12, 1e8)
"""Range of the damping of the batch."""


def least_squares_of(residuals: Callable[[Array], Array], start: Sequence[float]) -> Array:
    """Return the minimum of the plain sum of squares of ``residuals``; raises MissingExtraError, FitError."""
    solution = _search()(residuals, np.array(start), x_scale="jac", xtol=1e-12, ftol=1e-12, max_nfev=MOST_EVALUATIONS)
    if not solution.success:
        raise FitError(f"a search does not end: {solution.message}")
    return np.asarray(solution.x, dtype=np.float64)


def _search() -> Any:
    """Return SciPy's search, imported at the first fit (docs/decisions/0031)."""
    try:
        from scipy.optimize import least_squares  # pyright: ignore
    except ImportError as error:
        raise MissingExtraError(needs("a fit", "scipy", "report")) from error
    return cast("Any", least_squares)


def solve(problem: FitProblem, starts: Iterable[Sequence[float]]) -> Array:
    """Return the best fit, ``z`` of shape (q,), of searches from several sets of a law's parameters.

    Raises MissingExtraError without SciPy, FitError where no search converges to parameters that are the law's.
    """
    search = _search()
    prior = np.zeros(problem.priors)
    best: Any = None
    reason = "the data leave its parameters open"
    for start in starts:
        solution = search(
            problem.residuals,
            problem.inward(start),
            jac=problem.jacobian,
            args=(problem.y, prior),
            x_scale=problem.steps,
            loss="soft_l1",
            f_scale=ROBUST,
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=MOST_EVALUATIONS,
        )
        if not solution.success or (best is not None and solution.cost >= best.cost):
            continue
        found = problem.natural(solution.x)
        improper = problem.law.improper(found.tolist()) if problem.law.improper is not None else ""
        if improper:
            reason = improper
        else:
            best = solution
    if best is None:
        raise FitError(f"the search for the law {problem.law.name} does not end: {reason}")
    return np.asarray(best.x, dtype=np.float64)


def cost(residuals: Array, counts: Array) -> Array:
    """Return the minimised sum for each of a batch of residuals."""
    z = (residuals / ROBUST) ** 2
    return np.sum(counts * 2.0 * ROBUST**2 * (np.sqrt(1.0 + z) - 1.0), axis=-1)


def solve_many(problem: FitProblem, start: Array, y: Array, prior: Array, counts: Array) -> tuple[Array, Booleans]:
    """Return the best fit of each of a batch, shape (B, q), and whether its search has converged, shape (B,).

    ``start``: (q,) or (B, q); ``y``: ln mu, (n,) or (B, n); ``prior``: (B, priors); ``counts``: how often a condition
    counts, (B, n).
    """
    batch = len(counts)
    z = np.broadcast_to(start, (batch, start.shape[-1])).copy()
    y = np.broadcast_to(y, (batch, problem.y.size))
    counted = np.concatenate([counts, np.ones((batch, problem.priors))], axis=-1)
    damping = np.full(batch, 1e-3)
    ended = np.zeros(batch, dtype=bool)
    residuals = problem.residuals(z, y, prior)
    costs = cost(residuals, counted)
    for _ in range(MOST_STEPS):
        at = np.flatnonzero(~ended)
        if not at.size:
            break
        jacobian = problem.jacobian(z[at], y[at], prior[at]) * problem.steps
        r, c = residuals[at], counted[at]
        weights = c / np.sqrt(1.0 + (r / ROBUST) ** 2)
        turned = np.swapaxes(jacobian * weights[..., None], -1, -2)
        squares, slope = turned @ jacobian, turned @ r[..., None]
        scale = np.einsum("bii->bi", squares)
        squares = squares + np.eye(squares.shape[-1]) * (damping[at, None] * scale + 1e-12)[..., None, :]
        step = -cast("Array", np.linalg.solve(squares, slope))[..., 0]
        tried = z[at] + step * problem.steps
        moved = problem.residuals(tried, y[at], prior[at])
        new = cost(moved, c)
        better = new <= costs[at]
        taken = at[better]
        z[taken], residuals[taken], costs[taken] = tried[better], moved[better], new[better]
        # A step that does not lower the cost is tried again with more damping.
        damping[at] = np.clip(np.where(better, 0.2, 5.0) * damping[at], *_DAMPING)
        small = np.max(np.abs(step), axis=-1) < _SMALL * (1.0 + 1e3 * better)
        ended[at] = small
    return z, ended
