"""What is measured, and how uncertain that is: one coefficient, two measurands.

**This piece in this condition** is the coefficient of what was mounted. It comes with the repeatability, with what
moved meanwhile and with what the machine's chain is off by. **The compound** is what any piece of it would show: it
comes with the difference from piece to piece as well, by the standard deviation between replicates, or as stated, and
with what reference conditions say the counterface has changed.

The repeatability is pooled over the conditions of the run (ISO 5725-2, 7.4.4): a standard deviation from three values
has a coverage factor of 4.3, and is half or twice the true one by luck. A condition that scatters by more than the pool
(F test, 1 %) has its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, sqrt
from typing import Final

from tester.analysis.kelvin import NO_WARMTH, Slope, SurfaceWarmth
from tester.analysis.quantiles import f_quantile
from tester.analysis.reference import CounterfaceDrift
from tester.analysis.repeatability import NOTHING_POOLED, Pool
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.terms import NO_SIZE, Acts, BudgetPoint, Size, Term, contributions_of
from tester.analysis.uncertainty import NO_BUDGET, Budget, Contribution, Unsteadiness, budget, contribution

REPEATABILITY: Final = "repeatability"
"""Name of the contribution of what repeating showed."""
BETWEEN: Final = "between replicates"
"""Name of the contribution of the scatter between pieces that were measured."""
OWN_LEVEL: Final = 0.01
"""Level of the test by which a condition that scatters by more than the pool has its own repeatability."""
STATED_DF: Final = 8
"""Weight of the stated difference from piece to piece beside that between replicates, degrees of freedom [A]."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What a condition's uncertainty comes from beside its repeats."""

    terms: tuple[Term, ...] = ()
    pool: Pool = NOTHING_POOLED
    """Repeatability over the conditions of the run, this one among them."""
    warmth: SurfaceWarmth = NO_WARMTH
    size: Size = NO_SIZE
    drift: CounterfaceDrift | None = None
    """Of the counterface, where the run has reference conditions."""
    travel_m: float = NAN
    """Of the counterface, when this was measured."""

    def counterface(self, mu: float) -> list[Contribution]:
        """Return what the counterface's change contributes to the compound's coefficient."""
        known = self.drift is not None and isfinite(self.travel_m)
        return [self.drift.contribution(mu, self.travel_m)] if self.drift is not None and known else []


def pooled(results: Sequence[ConditionResult]) -> Pool:
    """Return the repeatability pooled over the conditions that have a value."""
    pool = NOTHING_POOLED
    for one in results:
        if one.ok and one.mu_resultant > 0.0 and isfinite(one.s):
            pool = pool.with_spread(one.s / one.mu_resultant, one.n_valid, one.repeats_each)
    return pool


def repeatability(result: ConditionResult, pool: Pool) -> Contribution:
    """Return what repeating contributes: s pooled over the run, or the condition's own where it scatters by more."""
    mu, n = result.mu_resultant, result.n_valid
    share = result.type_a / result.s if result.s > 0.0 else 1.0 / sqrt(n)  # more where not all are in the mean
    own = result.s / mu if mu > 0.0 else 0.0
    df, each = float(max(n - 1, 1)), "repeats" if result.both_ways is None else "pairs of repeats"
    if not pool.df or mu <= 0.0:
        return contribution(REPEATABILITY, result.s, share, unit="", df=df, source=f"s of {n} {each}")
    s = 0.01 * pool.s_percent / sqrt(result.repeats_each)
    if n >= 2 and pool.df > n - 1 and own > s * sqrt(f_quantile(1.0 - OWN_LEVEL, n - 1.0, float(pool.df))):
        source = f"own s of {n} {each}, more than the run's"
        return contribution(REPEATABILITY, own, mu * share, df=df, source=source)
    source = f"s pooled over the run, {n} {each}"
    return contribution(REPEATABILITY, s, mu * share, df=float(pool.df), source=source)


def _unsteady(mu: float, unsteady: Unsteadiness) -> list[Contribution]:
    """Return what a coefficient that moves contributes."""
    return [
        contribution(name, 0.01 * percent, mu, source=source, distribution="rectangular")
        for name, percent, source in (
            ("drift", unsteady.drift_percent, "fit over the repeats"),
            ("carry-over", unsteady.carry_over_percent, "trend over the repeats"),
        )
    ]


def _machine(result: ConditionResult, by: Surroundings) -> tuple[list[Contribution], list[Contribution]]:
    """Return what the machine's chain contributes, and what differs from piece to piece."""
    means, mu = result.measured, result.mu_resultant
    turning = result.both_ways.turning if result.both_ways is not None else None
    slope, rate_k_s = by.warmth.slope.per_kelvin, by.warmth.rate_k_s
    at = BudgetPoint(mu, means.normal, means.sliding, means, slope, rate_k_s, by.size, turning)
    chain = [one for one in by.terms if one.acts is not Acts.PIECE]
    found = contributions_of(chain, at)
    if any(one.acts is Acts.TEMPERATURE for one in chain):
        found.append(by.warmth.contribution(mu, chain))
    return found, contributions_of([one for one in by.terms if one.acts is Acts.PIECE], at)


def expected_budget(terms: Sequence[Term], at: BudgetPoint, slope: Slope) -> Budget:
    """Return what a machine's terms add to the uncertainty of a coefficient that is expected, before it is measured."""
    chain = [one for one in terms if one.acts is not Acts.PIECE]
    return budget([*contributions_of(chain, at), SurfaceWarmth(slope=slope).contribution(at.mu, chain)])


def with_budget(result: ConditionResult, by: Surroundings) -> ConditionResult:
    """Return a condition's result with both budgets and its coefficient at the temperature that was asked for."""
    mu = result.mu_resultant
    if not isfinite(mu):
        return result
    found, between = _machine(result, by)
    this = [*found, *_unsteady(mu, result.unsteady), repeatability(result, by.pool)]
    return replace(
        result,
        correction=by.warmth.correction(by.terms),
        budget=budget(this),
        compound_budget=budget([*this, *between, *by.counterface(mu)]),
    )


def with_budget_of_replicates(
    result: ConditionResult, replicates: Sequence[ConditionResult], by: Surroundings
) -> ConditionResult:
    """Return the result that stands for replicates, each with its budget, with budgets of its own.

    Of the pieces that were measured: their mean, with the repeatability of each. Of the compound: with the scatter
    between them, the stated one weighed in with ``STATED_DF`` degrees of freedom; that has the repeats in it.
    """
    kept = [one for one in replicates if one.ok and one.budget is not NO_BUDGET]
    mu, n = result.mu_resultant, len(kept)
    if not (isfinite(mu) and n):
        return result
    found, stated = _machine(result, by)
    found += _unsteady(mu, result.unsteady)
    each = [one for r in kept for one in r.budget.contributions if one.name == REPEATABILITY]
    repeats = budget(each)
    source = f"of {n} replicates"
    own = Contribution(REPEATABILITY, repeats.standard / n, repeats.df, source, "normal", repeats.standard, "", 1.0 / n)
    if n >= 2 and stated:
        variance = sum(one.input_u**2 for one in stated)
        df = STATED_DF + n - 1
        s = sqrt((STATED_DF * variance + (n - 1) * (result.s / mu) ** 2) / df)
        told = f"s between {n} replicates and {', '.join(one.source for one in stated)}"
        between = [contribution(BETWEEN, s, mu / sqrt(n), df=float(df), source=told)]
    else:
        between = [own, *stated]
    return replace(
        result,
        correction=sum(one.mu for one in kept) / (n * mu),
        budget=budget([*found, own]),
        compound_budget=budget([*found, *between, *by.counterface(mu)]),
    )
