"""Whether two coefficients of compounds differ by more than their uncertainties explain.

Common errors largely drop out: on one rig, with one calibration, an error of the measuring chain moves both the same
way, and only the difference of its effects remains. Independent errors add in squares: the repeats, and the difference
from piece to piece, because each compound was measured on its own pieces.

  u_d^2 = sum over own terms (u_1^2 + u_2^2) + sum over common ones (c_1 u - c_2 u)^2

The two differ significantly where their difference exceeds t(0.975) u_d, with the effective degrees of freedom of u_d
(Welch-Satterthwaite).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf, isfinite, sqrt
from typing import Final

from tester.analysis.quantiles import t_quantile
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.uncertainty import CONFIDENCE, Contribution, effective_df

RIG: Final = "rig"
"""Marks terms whose error is common to all measurements on one rig with one calibration (``Contribution.common``)."""
SURE: Final = 0.9
"""Probability of detecting a real difference."""
PIECES_AT_MOST: Final = 1000
_NO_ERROR: Final = Contribution("", 0.0, input_u=0.0, sensitivity=0.0)


@dataclass(frozen=True, slots=True)
class Difference:
    """Second coefficient less the first, its standard uncertainty and the degrees of freedom of that."""

    value: float = NAN
    standard: float = NAN
    df: float = NAN

    @property
    def coverage(self) -> float:
        """Return the coverage factor of 95 %."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, self.df) if self.df > 0.0 else NAN

    @property
    def expanded(self) -> float:
        """Return the expanded uncertainty, 95 %."""
        return self.coverage * self.standard

    @property
    def told_apart(self) -> bool:
        """Return whether the difference exceeds its expanded uncertainty."""
        return abs(self.value) > self.expanded


def difference(first: ConditionResult, second: ConditionResult, *, same_rig: bool) -> Difference:
    """Return the coefficient of one compound less that of another, at their nominal temperatures.

    ``same_rig``: measured on one rig, with one calibration. NaN where either has no coefficient or no budget.
    """
    value = second.mu - first.mu
    budgets = first.compound_budget.contributions, second.compound_budget.contributions
    if not (all(budgets) and isfinite(value)):
        return Difference(value)
    common = [
        {first_term.name: first_term for first_term in budget if same_rig and first_term.common == RIG}
        for budget in budgets
    ]
    parts = [
        (first_term.standard, first_term.df)
        for budget in budgets
        for first_term in budget
        if not (same_rig and first_term.common == RIG)
    ]
    for name in dict.fromkeys(name for found in common for name in found):
        first_term, second_term = (found.get(name, _NO_ERROR) for found in common)
        parts.append((abs(first_term.error - second_term.error), min(first_term.df, second_term.df)))
    standard = sqrt(sum(u * u for u, _ in parts))
    return Difference(value, standard, effective_df(parts, standard) if isfinite(standard) else NAN)


def pieces_needed(percent: float, between_percent: float, repeats_percent: float) -> int:
    """Return how many pieces of each of two compounds resolve a difference of ``percent``, measured on one rig.

    ``between_percent``: standard deviation from piece to piece, ``repeats_percent`` that of a piece's mean. The
    difference is detected with a probability of 90 %, by a test at 5 %, both deviations taken as known.
    """
    reach = t_quantile(0.5 + 0.5 * CONFIDENCE, inf) + t_quantile(SURE, inf)
    wanted = 2.0 * (between_percent**2 + repeats_percent**2) * (reach / percent) ** 2
    return min(max(ceil(wanted), 1), PIECES_AT_MOST)
