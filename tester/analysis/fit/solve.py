"""The search: SciPy's for the fit itself, and a batch of Levenberg-Marquardt steps for its hundreds of resamples.

Both minimise the same sum: soft L1 of the weighted residuals, ``2 f^2 (sqrt(1 + (r / f)^2) - 1)`` with f = ROBUST.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, cast

import numpy as np

from tester.analysis.fit.fit_law import FitError
from tester.analysis.fit.problem import ROBUST, FitProblem
from tester.base.arrays import Array, Booleans
from tester.base.plugins import MissingExtraError, needs

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


def solve(problem: FitProblem, starts: Sequence[Sequence[float]]) -> Array:
    """Return the best fit, ``z`` of shape (q,), of searches from several sets of a law's parameters.

    Raises MissingExtraError without SciPy, FitError where no search converges.
    """
    search = _search()
    prior = np.zeros(problem.priors)
    best: Any = None
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
        if solution.success and (best is None or solution.cost < best.cost):
            best = solution
    if best is None:
        raise FitError(f"the search for the law {problem.law.name} does not end: the data leave its parameters open")
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
