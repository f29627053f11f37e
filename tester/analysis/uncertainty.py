"""Uncertainty budget of a coefficient, after the GUM (JCGM 100:2008): contributions, standard, expanded, pooled.

Contributions are independent standard uncertainties in mu; they add in squares (GUM 5.1.2). The effective
degrees of freedom follow Welch-Satterthwaite (GUM G.4.1) and give the coverage factor for 95 %.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite, sqrt

from tester.analysis.flags import CARRY_OVER, flags_in
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN, Judgement

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Contribution:
    """One cause: its standard uncertainty in mu and its degrees of freedom (inf: taken as known).

    ``input_u`` is the standard uncertainty of the cause, in ``unit``, ``sensitivity`` the change of mu per unit of it:
    ``standard`` is the product of their sizes. ``common``: the measurements that share the error ("": none). It moves
    them together, and not a difference between them.
    """

    name: str
    standard: float
    df: float = inf
    source: str = ""
    distribution: str = "normal"
    input_u: float = NAN
    unit: str = ""
    sensitivity: float = NAN
    common: str = ""

    @property
    def error(self) -> float:
        """Return the error of mu, with its sign, when the cause is off by its standard uncertainty."""
        return self.input_u * self.sensitivity


def contribution(
    name: str,
    input_u: float,
    sensitivity: float,
    *,
    unit: str = "1",
    df: float = inf,
    source: str = "",
    distribution: str = "normal",
    common: str = "",
) -> Contribution:
    """Return the contribution of an input's standard uncertainty, in ``unit``, with mu's sensitivity to it."""
    standard = input_u * abs(sensitivity)
    return Contribution(name, standard, df, source, distribution, input_u, unit, sensitivity, common)


@dataclass(frozen=True, slots=True)
class Budget:
    """Contributions and their sum: standard uncertainty, effective df, coverage factor, expanded (95 %)."""

    contributions: tuple[Contribution, ...]
    standard: float
    df: float
    coverage: float
    expanded: float

    def share(self, one: Contribution) -> float:
        """Return a contribution's share of the variance, 0..1; NaN where there is no sum."""
        return (one.standard / self.standard) ** 2 if self.standard > 0.0 else NAN


NO_BUDGET = Budget((), NAN, NAN, NAN, NAN)


@dataclass(frozen=True, slots=True)
class Unsteadiness:
    """Additions to the budget for a coefficient that is not quite steady: standard uncertainties, per cent of it."""

    drift_percent: float = 0.0
    carry_over_percent: float = 0.0


STEADY = Unsteadiness()

_SPREAD = 1.0 / sqrt(12.0)
"""Standard deviation of a uniform distribution over a range of 1."""


def unsteadiness(judged: Judgement) -> Unsteadiness:
    """Return the additions from a condition's judgement: its drift always, with its error; its trend where it carries
    over.

    The coefficient moves by (abs(d) + se(d)) times the windows of a repeat during the measurement, and by the trend
    over the repeats; a mean from somewhere in that range is off by 1 / sqrt(12) of it (GUM 4.3.7).
    """
    drift = (abs(judged.drift_percent) + judged.drift_error_percent) * judged.repeat_windows * _SPREAD
    carried = abs(judged.trend_percent) * _SPREAD if CARRY_OVER in flags_in(judged.flags) else 0.0
    return Unsteadiness(drift if isfinite(drift) else 0.0, carried if isfinite(carried) else 0.0)


def effective_df(parts: Iterable[tuple[float, float]], standard: float) -> float:
    """Return the degrees of freedom of a sum (Welch-Satterthwaite) from its parts: standard uncertainty and df each."""
    limited = sum(u**4 / df for u, df in parts)
    return standard**4 / limited if limited > 0.0 else inf


def budget(contributions: Sequence[Contribution]) -> Budget:
    """Return the budget of contributions; NaN in any of them makes the sums NaN."""
    standard = sqrt(sum(c.standard**2 for c in contributions))
    if not isfinite(standard):
        return Budget(tuple(contributions), NAN, NAN, NAN, NAN)
    df = effective_df(((c.standard, c.df) for c in contributions), standard)
    coverage = t_quantile(0.5 + 0.5 * CONFIDENCE, df)
    return Budget(tuple(contributions), standard, df, coverage, coverage * standard)


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
