"""Whether two coefficients of compounds differ, by more than their uncertainties explain.

What both have in common drops out: on one rig, with one calibration, an error of the measuring chain moves both the
same way, and only what it moves them by differently is left. What is each one's own stays, in squares: the repeats, and
the difference from piece to piece, for the coefficients are those of compounds measured on different pieces.

    u_d^2 = sum over own terms (u_1^2 + u_2^2) + sum over common ones (c_1 u - c_2 u)^2

The two are told apart where their difference exceeds t(0.975) u_d, with the effective degrees of freedom of what is in
u_d (Welch-Satterthwaite).
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
"""Of terms whose error all has that is measured on one rig with one calibration (``Contribution.common``)."""
SURE: Final = 0.9
"""Chance with which a difference is to be found that is there."""
PIECES_AT_MOST: Final = 1000


@dataclass(frozen=True, slots=True)
class Difference:
    """Second coefficient less the first, its standard uncertainty and that one's degrees of freedom."""

    value: float = NAN
    standard: float = NAN
    df: float = NAN

    @property
    def coverage(self) -> float:
        """Return how many standard uncertainties chance explains, 95 %."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, self.df) if self.df > 0.0 else NAN

    @property
    def expanded(self) -> float:
        """Return its expanded uncertainty, 95 %."""
        return self.coverage * self.standard

    @property
    def told_apart(self) -> bool:
        """Return whether it is more than chance explains."""
        return abs(self.value) > self.expanded


def difference(first: ConditionResult, second: ConditionResult, *, same_rig: bool) -> Difference:
    """Return by how much the compound of one condition differs from that of another, at their nominal temperatures.

    ``same_rig``: measured on one rig, with one calibration. NaN where one has no coefficient or no budget.
    """
    value = second.mu - first.mu
    budgets = first.compound_budget.contributions, second.compound_budget.contributions
    if not (all(budgets) and isfinite(value)):
        return Difference(value)
    common = [{one.name: one for one in found if same_rig and one.common == RIG} for found in budgets]
    parts = [(one.standard, one.df) for found in budgets for one in found if not (same_rig and one.common == RIG)]
    for name in dict.fromkeys(name for found in common for name in found):
        one, other = (found.get(name) for found in common)
        parts.append((abs(_error(one) - _error(other)), min(_df(one), _df(other))))
    standard = sqrt(sum(u * u for u, _ in parts))
    return Difference(value, standard, effective_df(parts, standard) if isfinite(standard) else NAN)


def _error(one: Contribution | None) -> float:
    """Return by how much mu is off, with its sign, where the cause is off by its standard uncertainty."""
    return one.input_u * one.sensitivity if one is not None else 0.0


def _df(one: Contribution | None) -> float:
    return one.df if one is not None else inf


def pieces_needed(percent: float, between_percent: float, repeats_percent: float) -> int:
    """Return how many pieces of each of two compounds tell a difference of so many per cent, measured on one rig.

    ``between_percent``: standard deviation from piece to piece, ``repeats_percent`` that of a piece's mean. Found with
    a chance of 90 %, by a test at 5 %, both deviations taken as known.
    """
    reach = t_quantile(0.5 + 0.5 * CONFIDENCE, inf) + t_quantile(SURE, inf)
    wanted = 2.0 * (between_percent**2 + repeats_percent**2) * (reach / percent) ** 2
    return min(max(ceil(wanted), 1), PIECES_AT_MOST)
