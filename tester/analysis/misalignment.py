"""Apparent misalignment of the load cell's axes, from conditions measured in both directions.

Half the sum of a pair's signed coefficients is theta (1 + mu^2) (``tester.analysis.directions``). One condition of
three pairs resolves it to some 0.2 degrees, because repeats differ by 2 %; so it is pooled over the session, in which
the cell is not moved. Each condition weighs by its uncertainty, for which the relative scatter between pairs is pooled:

  u_i = s mu_i / ((1 + mu_i^2) sqrt(n_i)),      theta = sum(theta_i / u_i^2) / sum(1 / u_i^2),      u^-2 = sum u_i^-2

Crosstalk between load and friction looks the same, and is part of it: the angle is the budget's misalignment and
crosstalk together. It corrects nothing; the coefficients from both directions are free of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import degrees, isfinite, sqrt

from tester.analysis.quantiles import t_quantile
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.uncertainty import CONFIDENCE


@dataclass(frozen=True, slots=True)
class Misalignment:
    """An apparent angle and its standard uncertainty, degrees, the degrees of freedom, and the number of pairs."""

    deg: float = NAN
    standard_deg: float = NAN
    df: int = 0
    pairs: int = 0

    @property
    def expanded_deg(self) -> float:
        """Return the expanded uncertainty (95 %), degrees; NaN where no scatter is known."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, float(self.df)) * self.standard_deg if self.df else NAN


NOT_KNOWN = Misalignment()


def misalignment(results: Iterable[ConditionResult]) -> Misalignment:
    """Return the angle pooled over conditions; those without a value, or of one direction, are ignored."""
    valued = [
        (result.mu_resultant, result.both_ways) for result in results if result.ok and result.both_ways is not None
    ]
    valued = [(mu, ways) for mu, ways in valued if mu > 0.0]
    if not valued:
        return NOT_KNOWN
    df = sum(ways.pairs - 1 for _, ways in valued)
    squares = sum((ways.pairs - 1) * (ways.half_sum_s / mu) ** 2 for mu, ways in valued if isfinite(ways.half_sum_s))
    weights = [ways.pairs * ((1.0 + mu * mu) / mu) ** 2 for mu, ways in valued]
    angles = [ways.half_sum / (1.0 + mu * mu) for mu, ways in valued]
    angle = sum(w * a for w, a in zip(weights, angles, strict=True)) / sum(weights)
    standard = sqrt(squares / df / sum(weights)) if df else NAN
    return Misalignment(degrees(angle), degrees(standard), df, sum(ways.pairs for _, ways in valued))
