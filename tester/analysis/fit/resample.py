"""Fits of resampled conditions, and fits with each cell left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tester.analysis.fit.check import place_of
from tester.analysis.fit.solve import FitProblem, solve_many
from tester.base.arrays import Array, Booleans

RESAMPLES: Final = 999
SEED: Final = 0
"""Fixed, so the same conditions give the same intervals."""
TAILS: Final = (0.025, 0.975)
"""Tails of the intervals, 95 %."""


@dataclass(frozen=True, slots=True)
class Resamples:
    """Parameters of the resamples that could be fitted, shape (b, p), of ``drawn``."""

    parameters: Array
    drawn: int

    @property
    def share(self) -> float:
        """Return the share of the resamples that could be fitted."""
        return len(self.parameters) / self.drawn

    def interval(self, values: Array) -> tuple[float, float]:
        """Return the 95 % interval of a quantity computed for each resample; NaN where there are none."""
        if not values.size:
            return float("nan"), float("nan")
        low, high = np.quantile(values, TAILS)
        return float(low), float(high)


def resample(problem: FitProblem, fitted: Array, count: int = RESAMPLES, seed: int = SEED) -> Resamples:
    """Return fits to conditions drawn anew from the fit: each with an error of its own, and errors in common.

    Own errors are normal, in proportion to ``problem.sigma`` and as large as the residuals. The uncertainty of that
    size from so few residuals is drawn as well. It widens percentiles as Student's t widens standard deviations.
    Resamples whose search does not converge are left out.
    """
    random = np.random.default_rng(seed)
    n, free = len(problem.points), len(problem.free)
    df = n - free
    residuals = problem.residuals(fitted, problem.y, np.zeros(problem.priors)) / problem.reference
    spread = np.sqrt(residuals @ residuals / random.chisquare(df, (count, 1)))
    y = problem.logarithms(fitted) + spread * problem.sigma * random.standard_normal((count, n))
    prior = fitted[free:] + random.standard_normal((count, problem.priors))
    solutions, ended = solve_many(problem, fitted, y, prior, np.ones((count, n)))
    return Resamples(problem.natural(solutions[ended]), count)


def covariance(problem: FitProblem, fitted: Array) -> Array:
    """Return the covariance of the free parameters, as searched (logarithms of those that are positive), shape (q, q).

    Of the law linearised at the fit, with the errors of ``resample``: own ones as large as the residuals, and those in
    common.
    """
    prior = np.zeros(problem.priors)
    residuals = problem.residuals(fitted, problem.y, prior) / problem.reference
    jacobian = problem.jacobian(fitted, problem.y, prior) / problem.reference * problem.steps
    df = len(problem.points) - len(problem.free)
    errors = np.concatenate([np.full(len(problem.points), residuals @ residuals / df), np.ones(problem.priors)])
    inverse = np.linalg.pinv(jacobian) * problem.steps[:, None]
    found: Array = (inverse * errors) @ inverse.T
    free = len(problem.free)
    return 0.5 * (found + found.T)[:free, :free]


def without_cells(problem: FitProblem, fitted: Array, cells: Sequence[int]) -> tuple[list[tuple[int, float]], int]:
    """Return place and predicted coefficient of each condition from a fit without its cell, and how many cells stay in.

    A cell is the set of conditions with equal nominal values of the variables ``cells``. It stays in where the other
    conditions do not determine the parameters.
    """
    of = [tuple(point.nominal[i] for i in cells) for point in problem.points]
    keys = sorted(set(of))
    counts = np.array([[float(cell != key) for cell in of] for key in keys])
    able = _able(problem, counts)
    prior = np.zeros((int(able.sum()), problem.priors))
    solutions, ended = solve_many(problem, fitted, problem.y, prior, counts[able])
    left_out = [key for key, fine in zip(keys, able, strict=True) if fine]
    predicted: list[tuple[int, float]] = []
    for key, parameters, fine in zip(left_out, problem.natural(solutions), ended, strict=True):
        values = problem.law.value(parameters, problem.x)
        predicted += [(i, float(values[i])) for i, cell in enumerate(of) if fine and cell == key]
    return predicted, len(keys) - int(ended.sum())


def _able(problem: FitProblem, counts: Array) -> Booleans:
    """Return, for each row of ``counts``, whether its conditions determine the free parameters."""
    able = (counts > 0.0).sum(axis=-1) >= len(problem.free)
    for i in problem.free:
        needed = problem.law.parameters[i].levels
        if needed is None:
            continue
        nominal = [point.nominal[place_of(problem.law, needed[0])] for point in problem.points]
        kinds = sorted(set(nominal))
        member = np.array([[float(value == kind) for kind in kinds] for value in nominal])
        able &= ((counts @ member) > 0.0).sum(axis=-1) >= needed[1]
    return able
