"""Repeatability pooled over conditions (ISO 5725-2, 7.4.4), which the few repeats of one condition cannot estimate.

The expanded repeatability of a mean of n repeats is t(0.975, df) s / sqrt(n), per cent of the coefficient, with s
pooled over the conditions of the run so far. Stopping on a condition's own s at n = 3 would cover 71 % instead of 95 %:
it stops where s happens to be small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, sqrt

from tester.analysis.quantiles import t_quantile
from tester.analysis.uncertainty import CONFIDENCE


@dataclass(frozen=True, slots=True)
class Pool:
    """Sum of squared deviations from the conditions' means, as shares of them, and its degrees of freedom."""

    squares: float = 0.0
    df: int = 0

    def with_condition(self, values: Sequence[float], repeats_each: int = 1) -> Pool:
        """Return the pool with the coefficients of one more condition; fewer than two are ignored.

        ``repeats_each``: number of repeats behind each value; the pool is that of single repeats.
        """
        n = len(values)
        mean = sum(values) / n if n else 0.0
        if n < 2 or mean <= 0.0:
            return self
        squares = sum((value / mean - 1.0) ** 2 for value in values)
        return Pool(self.squares + repeats_each * squares, self.df + n - 1)

    def with_spread(self, spread: float, n: int, repeats_each: int = 1) -> Pool:
        """Return the pool with one more condition of ``n`` values with this relative standard deviation."""
        if n < 2 or not spread >= 0.0:
            return self
        return Pool(self.squares + repeats_each * ((n - 1) * spread * spread), self.df + n - 1)

    @property
    def s_percent(self) -> float:
        """Return the pooled standard deviation between repeats, per cent; inf where unknown."""
        return 100.0 * sqrt(self.squares / self.df) if self.df else inf

    def expanded_percent(self, n: int) -> float:
        """Return the expanded repeatability (95 %) of a mean of ``n`` >= 1 repeats, per cent; inf where unknown."""
        if not self.df:
            return inf
        return t_quantile(0.5 + 0.5 * CONFIDENCE, float(self.df)) * self.s_percent / sqrt(n)


NOTHING_POOLED = Pool()
