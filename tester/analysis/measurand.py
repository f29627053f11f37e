"""The two measurands of one coefficient, and their uncertainty.

**This piece in this condition** is the coefficient of the mounted piece. Its uncertainty has the repeatability, the
change during the measurement and the errors of the machine's chain. **The compound** is the coefficient of any piece of
it: its uncertainty has the difference from piece to piece as well, by the standard deviation between replicates, or as
stated, and the change of the counterface by the reference conditions.

The repeatability is pooled over the conditions of the run (ISO 5725-2, 7.4.4): a standard deviation from three values
has a coverage factor of 4.3, and may be half or twice the true one by chance. A condition that scatters by more than
the pool (F test, 1 %) keeps its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, sqrt
from typing import Final

from tester.analysis.kelvin import NO_WARMTH, Slope, SurfaceWarmth
from tester.analysis.quantiles import f_quantile
from tester.analysis.reference import CounterfaceDrift
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.terms import NO_SIZE, Acts, BudgetPoint, Size, Term, contributions_of
from tester.analysis.uncertainty import (
    NO_BUDGET,
    NOTHING_POOLED,
    Budget,
    Contribution,
    Pool,
    Unsteadiness,
    budget,
    contribution,
)

REPEATABILITY: Final = "repeatability"
"""Name of the contribution of repeatability."""
BETWEEN: Final = "between replicates"
"""Name of the contribution of the scatter between measured pieces."""
OWN_LEVEL: Final = 0.01
"""Level of the test that gives a condition with more scatter than the pool its own repeatability."""
STATED_DF: Final = 8
"""Weight of the stated difference from piece to piece beside that between replicates, degrees of freedom [A]."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Sources of a condition's uncertainty beside its repeats."""

    terms: tuple[Term, ...] = ()
    pool: Pool = NOTHING_POOLED
    """Repeatability over the conditions of the run, this one among them."""
    warmth: SurfaceWarmth = NO_WARMTH
    size: Size = NO_SIZE
    drift: CounterfaceDrift | None = None
    """Drift of the counterface, where the run has reference conditions."""
    travel_m: float = NAN
    """Travel of the counterface at the time of this measurement."""

    def counterface(self, mu: float) -> list[Contribution]:
        """Return the contribution of the counterface's change to the compound's coefficient."""
        known = self.drift is not None and isfinite(self.travel_m)
        return [self.drift.contribution(mu, self.travel_m)] if self.drift is not None and known else []


def pooled(results: Sequence[ConditionResult]) -> Pool:
    """Return the repeatability pooled over the conditions that have a value."""
    pool = NOTHING_POOLED
    for result in results:
        if result.ok and result.mu_resultant > 0.0 and isfinite(result.s):
            pool = pool.with_spread(result.s / result.mu_resultant, result.n_valid, result.repeats_each)
    return pool


def repeatability(result: ConditionResult, pool: Pool) -> Contribution:
    """Return the contribution of repeatability: s pooled over the run, or the condition's own where that is
    significantly greater."""
    mu, n = result.mu_resultant, result.n_valid
    share = result.type_a / result.s if result.s > 0.0 else 1.0 / sqrt(n)  # more where the mean leaves some out
    own_s = result.s / mu if mu > 0.0 else 0.0
    df, each = float(max(n - 1, 1)), "repeats" if result.both_ways is None else "pairs of repeats"
    if not pool.df or mu <= 0.0:
        return contribution(REPEATABILITY, result.s, share, unit="", df=df, source=f"s of {n} {each}")
    s = 0.01 * pool.s_percent / sqrt(result.repeats_each)
    if n >= 2 and pool.df > n - 1 and own_s > s * sqrt(f_quantile(1.0 - OWN_LEVEL, n - 1.0, float(pool.df))):
        source = f"own s of {n} {each}, more than the run's"
        return contribution(REPEATABILITY, own_s, mu * share, df=df, source=source)
    source = f"s pooled over the run, {n} {each}"
    return contribution(REPEATABILITY, s, mu * share, df=float(pool.df), source=source)


def _unsteady(mu: float, unsteady: Unsteadiness) -> list[Contribution]:
    """Return the contributions of a coefficient that changes during the measurement."""
    return [
        contribution(name, 0.01 * percent, mu, source=source, distribution="rectangular")
        for name, percent, source in (
            ("drift", unsteady.drift_percent, "fit over the repeats"),
            ("carry-over", unsteady.carry_over_percent, "trend over the repeats"),
        )
    ]


def _machine(result: ConditionResult, by: Surroundings) -> tuple[list[Contribution], list[Contribution]]:
    """Return the contributions of the machine's chain, and those that differ from piece to piece."""
    means, mu = result.measured, result.mu_resultant
    turning = result.both_ways.turning if result.both_ways is not None else None
    slope, rate_k_s = by.warmth.slope.per_kelvin, by.warmth.rate_k_s
    at = BudgetPoint(mu, means.normal, means.sliding, means, slope, rate_k_s, by.size, turning)
    chain = [term for term in by.terms if term.acts is not Acts.PIECE]
    contributions = contributions_of(chain, at)
    if any(term.acts is Acts.TEMPERATURE for term in chain):
        contributions.append(by.warmth.contribution(mu, chain))
    return contributions, contributions_of([term for term in by.terms if term.acts is Acts.PIECE], at)


def expected_budget(terms: Sequence[Term], at: BudgetPoint, slope: Slope) -> Budget:
    """Return the budget of an expected coefficient from a machine's terms, before a measurement."""
    chain = [term for term in terms if term.acts is not Acts.PIECE]
    return budget([*contributions_of(chain, at), SurfaceWarmth(slope=slope).contribution(at.mu, chain)])


def with_budget(result: ConditionResult, by: Surroundings) -> ConditionResult:
    """Return a condition's result with both budgets and its coefficient at the nominal temperature."""
    mu = result.mu_resultant
    if not isfinite(mu):
        return result
    chain, between = _machine(result, by)
    this = [*chain, *_unsteady(mu, result.unsteady), repeatability(result, by.pool)]
    return replace(
        result,
        correction=by.warmth.correction(by.terms),
        budget=budget(this),
        compound_budget=budget([*this, *between, *by.counterface(mu)]),
    )


def with_budget_of_replicates(
    result: ConditionResult, replicates: Sequence[ConditionResult], by: Surroundings
) -> ConditionResult:
    """Return the combined result of replicates, with budgets made from the replicates' budgets.

    The budget for the mean of the measured pieces has the repeatability of each piece. The budget for the compound has
    the scatter between pieces instead, which includes that of the repeats. This scatter is combined with the stated
    one, which counts as known to ``STATED_DF`` degrees of freedom.
    """
    kept = [replicate for replicate in replicates if replicate.ok and replicate.budget is not NO_BUDGET]
    mu, n = result.mu_resultant, len(kept)
    if not (isfinite(mu) and n):
        return result
    chain, stated = _machine(result, by)
    chain += _unsteady(mu, result.unsteady)
    each = [term for r in kept for term in r.budget.contributions if term.name == REPEATABILITY]
    repeats = budget(each)
    source = f"of {n} replicates"
    of_mean = Contribution(
        REPEATABILITY, repeats.standard / n, repeats.df, source, "normal", repeats.standard, "", 1.0 / n
    )
    if n >= 2 and stated:
        variance = sum(term.input_u**2 for term in stated)
        df = STATED_DF + n - 1
        s = sqrt((STATED_DF * variance + (n - 1) * (result.s / mu) ** 2) / df)
        basis = f"s between {n} replicates and {', '.join(term.source for term in stated)}"
        between = [contribution(BETWEEN, s, mu / sqrt(n), df=float(df), source=basis)]
    else:
        between = [of_mean, *stated]
    return replace(
        result,
        correction=sum(replicate.mu for replicate in kept) / (n * mu),
        budget=budget([*chain, of_mean]),
        compound_budget=budget([*chain, *between, *by.counterface(mu)]),
    )
