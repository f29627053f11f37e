"""What the fit of other conditions would have been: resamples of them, and fits without one cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from tester.fit.check import place_of
from tester.fit.problem import FitProblem
from tester.fit.solve import solve_many

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
    """Return fits to conditions drawn with replacement; errors common to a source are drawn from their priors.

    A resample that lacks what its parameters need, or whose search does not end, is left out.
    """
    random = np.random.default_rng(seed)
    n = len(problem.points)
    counts = random.multinomial(n, np.full(n, 1.0 / n), size=count).astype(np.float64)
    prior = random.standard_normal((count, problem.priors))
    able = _able(problem, counts)
    found, ended = solve_many(problem, fitted, problem.y, prior[able], counts[able])
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
