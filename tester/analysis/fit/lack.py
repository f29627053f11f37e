"""Whether a law describes conditions: its residuals beside what is independent between conditions, and their order.

An F test compares the residuals with the repeatability and the scatter between conditions. Runs tests look, for each
variable, along every line of conditions that differ in it alone: residuals of a law of the wrong form keep their sign.
All tests are judged together, at ``LEVEL`` in all (Holm, Scand. J. Statist. 6 (1979) 65). What chance does is drawn:
errors of the right law, less what the fit takes up of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite, sqrt
from statistics import fmean
from typing import TYPE_CHECKING, Final

import numpy as np

from tester.analysis.fit.law import NAN, FitPoint, Source
from tester.analysis.fit.problem import FitProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]

LEVEL: Final = 0.01
"""Of all tests together: of a hundred right laws one is refused."""
DRAWS: Final = 9999
SEED: Final = 0
SEEN: Final = 0.95
"""Share of cases in which a departure is seen that is said to be seen."""
NEGLIGIBLE: Final = 1e-3
"""Residual of ln mu whose sign says nothing: a law that is right within 0.1 % is right for any use [A]."""
_SIZE: Final = "size of the residuals"
_LONGEST: Final = 1e3
"""Length of a departure, in standard deviations, beyond which none is looked for."""


@dataclass(frozen=True, slots=True)
class Denominator:
    """What is independent between conditions: standard deviations of ln mu, root mean squares over the conditions.

    ``repeats`` of means of repeats, ``own`` of what else differs from condition to condition, ``between`` of what
    conditions scatter beyond any smooth law; ``df``: degrees of freedom of all together.
    """

    repeats: float
    own: float
    between: float
    df: float
    sources: tuple[Source, ...]

    @property
    def standard(self) -> float:
        """Return all together."""
        return sqrt(self.repeats**2 + self.own**2 + self.between**2)


def denominator_of(points: Sequence[FitPoint]) -> Denominator | None:
    """Return what is independent between conditions; None where nothing is known of their repeats."""
    known = [one for one in points if isfinite(one.type_a) and one.type_a > 0.0]
    if not known:
        return None
    repeats = fmean(one.type_a**2 for one in known)
    own, between = fmean(one.own**2 for one in points), fmean(one.between**2 for one in points)
    sources = tuple(dict.fromkeys(one.source for one in points))
    squares = 0.0  # Welch and Satterthwaite: conditions of a source share one estimate of their repeatability
    for source in sources:
        of_source = [one for one in known if one.source == source]
        df = max((one.df for one in of_source), default=inf)
        squares += (sum(one.type_a**2 for one in of_source) / len(known)) ** 2 / df
    df = (repeats + own + between) ** 2 / squares if squares else inf
    return Denominator(sqrt(repeats), sqrt(own), sqrt(between), df, sources)


@dataclass(frozen=True, slots=True)
class LackTest:
    """One test: what it looks at, the share of right laws whose residuals look as bad or worse, and the verdict."""

    name: str
    p: float
    failed: bool


@dataclass(frozen=True, slots=True)
class Lack:
    """Whether a law describes the conditions. ``residual``: standard deviation of what it leaves of ln mu.

    ``visible``: root mean square of a departure of ln mu, beyond what the parameters take up, that the F test sees in
    ``SEEN`` of cases.
    """

    residual: float
    denominator: Denominator | None = None
    tests: tuple[LackTest, ...] = ()
    visible: float = NAN

    @property
    def shown(self) -> bool | None:
        """Return whether the law does not describe the conditions; None where that cannot be told."""
        return any(test.failed for test in self.tests) if self.denominator is not None else None


def lack_of(problem: FitProblem, fitted: Array, draws: int = DRAWS) -> Lack:
    """Return how well a fit describes its conditions."""
    df = len(problem.points) - len(problem.free)
    residual = problem.y - problem.logarithms(fitted)
    spread = sqrt(float(residual @ residual) / df)
    denominator = denominator_of(problem.points)
    if denominator is None:
        return Lack(spread)
    chance = _Chance(problem, fitted, denominator, draws)
    tests = chance.judge(problem.residuals(fitted, problem.y, np.zeros(problem.priors)) / problem.reference)
    visible = denominator.standard * chance.visible(len(tests)) / sqrt(len(problem.points))
    return Lack(spread, denominator, tests, visible)


def power_of(problem: FitProblem, fitted: Array, departure: Array, draws: int = DRAWS) -> float:
    """Return the share of records in which a departure of ln mu from the law, shape (n,), is refused; NaN without a
    denominator.

    It is that of the linearised law: what the parameters take up of the departure near the fit is not seen.
    """
    denominator = denominator_of(problem.points)
    if denominator is None:
        return NAN
    chance = _Chance(problem, fitted, denominator, draws)
    moved = np.concatenate([departure / problem.sigma, np.zeros(problem.priors)])
    return chance.refused(moved)


class _Chance:
    """Residuals of the right law as they are drawn, in standard deviations, and what tests make of them."""

    def __init__(self, problem: FitProblem, fitted: Array, denominator: Denominator, draws: int) -> None:
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
        p |= {name: self._share(int(np.sum(self._runs[name] <= own[0]))) for name, own in runs.items()}
        failed = _holm([*p.values()])
        names = {name: name if name == _SIZE else f"signs along {name}" for name in p}
        return tuple(LackTest(names[name], one, bad) for (name, one), bad in zip(p.items(), failed, strict=True))

    def refused(self, departure: Array) -> float:
        """Return the share of draws that are refused with a departure added, shape (n + priors,)."""
        f, runs = self._figures(self._without(self._errors + departure), self._scale)
        sorted_f = np.sort(self._f)
        p: list[Array] = [(sorted_f.size - np.searchsorted(sorted_f, f, side="left") + 1) / (sorted_f.size + 1)]
        for name, own in runs.items():
            known = np.sort(self._runs[name])
            p.append((np.searchsorted(known, own, side="right") + 1) / (known.size + 1))
        smallest: Array = np.min(np.stack(p), axis=0)  # Holm refuses just where the smallest passes its level
        return float(np.mean(smallest <= LEVEL / len(p)))

    def visible(self, tests: int) -> float:
        """Return the length of a departure, in standard deviations, that the F test sees in ``SEEN`` of cases."""
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
        """Return what a fit leaves of errors, shape (draws, n + priors)."""
        return errors - (errors @ self._taken) @ self._taken.T

    def _figures(self, residuals: Array, scale: Array) -> tuple[Array, dict[str, Array]]:
        """Return F and, by variable, how often neighbours differ in sign, of each row."""
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
    for place, one in enumerate(points):
        rest = (value for i, value in enumerate(one.nominal) if i != variable)
        lines.setdefault(tuple(rest), []).append(place)
    found: list[tuple[int, int]] = []
    for line in lines.values():
        line.sort(key=lambda place: points[place].nominal[variable])
        found += [(a, b) for a, b in pairwise(line) if points[a].nominal[variable] != points[b].nominal[variable]]
    return np.array(found, dtype=np.intp).reshape(-1, 2)


def _holm(p: Sequence[float]) -> list[bool]:
    """Return which of several tests fail at ``LEVEL`` in all."""
    failed = [False] * len(p)
    for rank, place in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        if p[place] > LEVEL / (len(p) - rank):
            break
        failed[place] = True
    return failed
