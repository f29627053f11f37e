"""Whether a law describes conditions: the size of its residuals against independent scatter, and their order.

An F test compares the residuals with the repeatability and the scatter between conditions. For each variable, runs
tests examine every line of conditions that differ in it alone: residuals of a law of the wrong form keep their sign
along it. All tests are judged together, at ``LEVEL`` in total (Holm, Scand. J. Statist. 6 (1979) 65). Their
distributions are simulated: errors of the right law, less the part that the fit absorbs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite, sqrt
from statistics import fmean
from typing import Final

import numpy as np

from tester.analysis.fit.fit_law import NAN, FitPoint, Source
from tester.analysis.fit.solve import FitProblem
from tester.base.arrays import Array, Places

LEVEL: Final = 0.01
"""Level of all tests together: one in a hundred right laws is refused."""
DRAWS: Final = 9999
SEED: Final = 0
SEEN: Final = 0.95
"""Detection rate that defines ``Lack.visible``."""
NEGLIGIBLE: Final = 1e-3
"""Residual of ln mu too small for its sign to count: a law within 0.1 % is right for any use [A]."""
_SIZE: Final = "size of the residuals"
_LONGEST: Final = 1e3
"""Longest departure that is searched, in standard deviations."""


@dataclass(frozen=True, slots=True)
class Denominator:
    """Scatter that is independent between conditions: standard deviations of ln mu, root mean squares over the
    conditions.

    ``repeats``: scatter of the means of repeats. ``own``: further terms that differ between conditions. ``between``:
    scatter of conditions about any smooth law. ``df``: degrees of freedom of the three together.
    """

    repeats: float
    own: float
    between: float
    df: float
    sources: tuple[Source, ...]

    @property
    def standard(self) -> float:
        """Return the combined standard deviation."""
        return sqrt(self.repeats**2 + self.own**2 + self.between**2)


def denominator_of(points: Sequence[FitPoint]) -> Denominator | None:
    """Return the scatter that is independent between conditions; None if no condition has a known repeatability."""
    known = [point for point in points if isfinite(point.type_a) and point.type_a > 0.0]
    if not known:
        return None
    repeats = fmean(point.type_a**2 for point in known)
    own_variance, between_variance = (
        fmean(point.own**2 for point in points),
        fmean(point.between**2 for point in points),
    )
    sources = tuple(dict.fromkeys(point.source for point in points))
    squares = 0.0  # Welch and Satterthwaite: conditions of a source share one estimate of their repeatability
    for source in sources:
        of_source = [point for point in known if point.source == source]
        df = max((point.df for point in of_source), default=inf)
        squares += (sum(point.type_a**2 for point in of_source) / len(known)) ** 2 / df
    df = (repeats + own_variance + between_variance) ** 2 / squares if squares else inf
    return Denominator(sqrt(repeats), sqrt(own_variance), sqrt(between_variance), df, sources)


@dataclass(frozen=True, slots=True)
class LackTest:
    """One test: its subject, the share of right laws whose residuals look as bad or worse, and the verdict."""

    name: str
    p: float
    failed: bool


@dataclass(frozen=True, slots=True)
class Lack:
    """Whether a law describes the conditions. ``residual``: standard deviation of the residuals of ln mu.

    ``visible``: root mean square of a departure of ln mu that the parameters do not absorb and the F test detects in
    ``SEEN`` of cases.
    """

    residual: float
    denominator: Denominator | None = None
    tests: tuple[LackTest, ...] = ()
    visible: float = NAN

    @property
    def shown(self) -> bool | None:
        """Return whether the law fails to describe the conditions; None where that cannot be decided."""
        return any(test.failed for test in self.tests) if self.denominator is not None else None


def lack_of(problem: FitProblem, fitted: Array, draws: int = DRAWS) -> Lack:
    """Return how well a fit describes its conditions."""
    df = len(problem.points) - len(problem.free)
    residual = problem.y - problem.logarithms(fitted)
    spread = sqrt(float(residual @ residual) / df)
    denominator = denominator_of(problem.points)
    if denominator is None:
        return Lack(spread)
    chance = Chance(problem, fitted, denominator, draws)
    tests = chance.judge(problem.residuals(fitted, problem.y, np.zeros(problem.priors)) / problem.reference)
    visible = denominator.standard * chance.visible(len(tests)) / sqrt(len(problem.points))
    return Lack(spread, denominator, tests, visible)


class Chance:
    """Simulated residuals of the right law, in standard deviations, and their test statistics."""

    def __init__(self, problem: FitProblem, fitted: Array, denominator: Denominator, draws: int) -> None:
        """Draw errors and fit them, with the law linearised near ``fitted``."""
        random = np.random.default_rng(SEED)
        self._n, size = len(problem.points), len(problem.points) + problem.priors
        self._negligible: Array = NEGLIGIBLE / problem.sigma
        jacobian = problem.jacobian(fitted, problem.y, np.zeros(problem.priors)) / problem.reference
        u, s, _ = np.linalg.svd(jacobian * problem.steps, full_matrices=False)
        self._taken: Array = u[:, s > 1e-12 * s[0]]
        self._df = size - self._taken.shape[1]
        finite = isfinite(denominator.df)
        self._scale = random.chisquare(denominator.df, draws) / denominator.df if finite else np.ones(draws)
        self._errors: Array = random.standard_normal((draws, size))
        self._pairs = {
            variable.name: pairs
            for i, variable in enumerate(problem.law.variables)
            if (pairs := neighbours(problem.points, i)).size
        }
        self._f, self._runs = self._figures(self._without(self._errors), self._scale)

    def judge(self, residuals: Array) -> tuple[LackTest, ...]:
        """Return the tests of residuals, shape (n + priors,)."""
        f, runs = self._figures(residuals[None, :], np.ones(1))
        p = {_SIZE: self._share(int(np.sum(self._f >= f[0])))}
        p |= {name: self._share(int(np.sum(self._runs[name] <= runs_of[0]))) for name, runs_of in runs.items()}
        failed = _holm([*p.values()])
        names = {name: name if name == _SIZE else f"signs along {name}" for name in p}
        return tuple(
            LackTest(names[name], p_value, bad) for (name, p_value), bad in zip(p.items(), failed, strict=True)
        )

    def visible(self, tests: int) -> float:
        """Return how far, in standard deviations, data must depart for the F test to detect it in ``SEEN`` of cases."""
        critical = float(np.quantile(self._f, 1.0 - LEVEL / tests))
        random = np.random.default_rng(SEED)
        along, across = random.standard_normal(self._f.size), random.chisquare(max(self._df - 1, 1), self._f.size)
        low, high = 0.0, _LONGEST
        for _ in range(40):
            middle = 0.5 * (low + high)
            f: Array = (across + (along + middle) ** 2) / self._df / self._scale
            seen = float(np.mean(f > critical))
            low, high = (middle, high) if seen < SEEN else (low, middle)
        return high

    def _without(self, errors: Array) -> Array:
        """Return the residuals of a fit to errors, shape (draws, n + priors)."""
        return errors - (errors @ self._taken) @ self._taken.T

    def _figures(self, residuals: Array, scale: Array) -> tuple[Array, dict[str, Array]]:
        """Return, for each row, F and how often neighbours along each variable differ in sign."""
        f = np.sum(residuals**2, axis=-1) / self._df / scale
        signs = np.sign(residuals[:, : self._n]) * (np.abs(residuals[:, : self._n]) > self._negligible)
        return f, {
            name: np.sum(signs[:, pairs[:, 0]] * signs[:, pairs[:, 1]] <= 0.0, axis=-1).astype(np.float64)
            for name, pairs in self._pairs.items()
        }

    def _share(self, count: int) -> float:
        return (count + 1) / (self._f.size + 1)


def neighbours(points: Sequence[FitPoint], variable: int) -> Places:
    """Return the places of conditions next to each other along a variable, all else equal, shape (pairs, 2)."""
    lines: dict[tuple[float, ...], list[int]] = {}
    for place, point in enumerate(points):
        rest = (value for i, value in enumerate(point.nominal) if i != variable)
        lines.setdefault(tuple(rest), []).append(place)
    pairs: list[tuple[int, int]] = []
    for line in lines.values():
        line.sort(key=lambda place: points[place].nominal[variable])
        pairs += [(a, b) for a, b in pairwise(line) if points[a].nominal[variable] != points[b].nominal[variable]]
    return np.array(pairs, dtype=np.intp).reshape(-1, 2)


def _holm(p: Sequence[float]) -> list[bool]:
    """Return which tests fail, at ``LEVEL`` for all of them together (Holm's method)."""
    failed = [False] * len(p)
    for rank, place in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        if p[place] > LEVEL / (len(p) - rank):
            break
        failed[place] = True
    return failed
