"""What the fit of the same conditions measured again would have been, and fits without one cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from tester.analysis.fit.check import place_of
from tester.analysis.fit.problem import FitProblem
from tester.analysis.fit.solve import solve_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Truths = NDArray[np.bool_]

RESAMPLES: Final = 999
SEED: Final = 0
"""Of the resamples: the same conditions give the same intervals."""
TAILS: Final = (0.025, 0.975)
"""Of the intervals, 95 %."""


@dataclass(frozen=True, slots=True)
class Resamples:
    """Parameters of the resamples that could be fitted, shape (b, p), of ``drawn``."""

    parameters: Array
    drawn: int

    @property
    def share(self) -> float:
        """Share of the resamples that could be fitted."""
        return len(self.parameters) / self.drawn

    def interval(self, values: Array) -> tuple[float, float]:
        """Return the 95 % interval of something worked out of each resample; NaN where there are none."""
        if not values.size:
            return float("nan"), float("nan")
        low, high = np.quantile(values, TAILS)
        return float(low), float(high)


def resample(problem: FitProblem, fitted: Array, count: int = RESAMPLES, seed: int = SEED) -> Resamples:
    """Return fits to conditions drawn anew from the fit: each with an error of its own, and errors in common.

    Own errors are normal, in proportion to ``problem.sigma`` and as large as the residuals are; how well so many
    residuals tell that is drawn, too, which makes of percentiles what Student's t makes of standard deviations.
    Resamples whose search does not end are left out.
    """
    random = np.random.default_rng(seed)
    n, free = len(problem.points), len(problem.free)
    df = n - free
    residuals = problem.residuals(fitted, problem.y, np.zeros(problem.priors)) / problem.reference
    spread = np.sqrt(residuals @ residuals / random.chisquare(df, (count, 1)))
    y = problem.logarithms(fitted) + spread * problem.sigma * random.standard_normal((count, n))
    prior = fitted[free:] + random.standard_normal((count, problem.priors))
    found, ended = solve_many(problem, fitted, y, prior, np.ones((count, n)))
    return Resamples(problem.natural(found[ended]), count)


def without_cells(problem: FitProblem, fitted: Array, cells: Sequence[int]) -> tuple[list[tuple[int, float]], int]:
    """Return place and predicted coefficient of each condition from a fit without its cell, and cells left out.

    A cell: the conditions with equal nominal values of the variables ``cells``. Left out are those without which the
    parameters could not be told.
    """
    of = [tuple(one.nominal[i] for i in cells) for one in problem.points]
    keys = sorted(set(of))
    counts = np.array([[float(one != key) for one in of] for key in keys])
    able = _able(problem, counts)
    prior = np.zeros((int(able.sum()), problem.priors))
    found, ended = solve_many(problem, fitted, problem.y, prior, counts[able])
    kept = [key for key, fine in zip(keys, able, strict=True) if fine]
    predicted: list[tuple[int, float]] = []
    for key, parameters, fine in zip(kept, problem.natural(found), ended, strict=True):
        values = problem.law.value(parameters, problem.x)
        predicted += [(i, float(values[i])) for i, one in enumerate(of) if fine and one == key]
    return predicted, len(keys) - int(ended.sum())


def _able(problem: FitProblem, counts: Array) -> Truths:
    """Tell of each row of ``counts`` whether its conditions can tell the free parameters."""
    able = (counts > 0.0).sum(axis=-1) >= len(problem.free)
    for i in problem.free:
        needed = problem.law.parameters[i].levels
        if needed is None:
            continue
        nominal = [one.nominal[place_of(problem.law, needed[0])] for one in problem.points]
        kinds = sorted(set(nominal))
        member = np.array([[float(one == kind) for kind in kinds] for one in nominal])
        able &= ((counts @ member) > 0.0).sum(axis=-1) >= needed[1]
    return able
