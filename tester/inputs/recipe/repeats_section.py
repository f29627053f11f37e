"""Expected number of repeats of a condition: refused ones are replaced, ``until`` adds repeats up to a precision."""

from __future__ import annotations

from functools import lru_cache
from math import inf, sqrt
from typing import Final

from tester.analysis.judge import ALONE
from tester.analysis.quantiles import t_quantile
from tester.analysis.uncertainty import CONFIDENCE
from tester.inputs.recipe.grid_settings import LEAST_REPEATS
from tester.inputs.recipe.plan import Settings
from tester.inputs.recipe.recipe_schema import MAX_REPEATS

MADE_UP: Final = 0.01
"""Share of good repeats that is refused and replaced, for a steady coefficient [A]; show it with `python -m
tests.campaigns.repeats`."""
POOLED_DF: Final = 30
"""Degrees of freedom above which a run's pooled standard deviation counts as known: t is within 5 % of its limit."""
SURE: Final = (0.75, 1.3)
"""A run's own standard deviation over the expected one, 95 % of runs: chi-square with the degrees of freedom above."""


def s_of_values(how: Settings, s_percent: float) -> float:
    """Return the standard deviation between values from that between repeats, per cent."""
    return s_percent / sqrt(how.scheme.repeats_each)


@lru_cache(maxsize=1024)
def needed(until_percent: float, s_percent: float, df: int = POOLED_DF) -> int:
    """Return the repeats after which the expanded repeatability (95 %) is reached, at most MAX_REPEATS.

    ``s_percent``: standard deviation between repeats, per cent; ``df``: its degrees of freedom before this condition.
    The mean of n repeats has t(0.975, df + n - 1) s / sqrt(n); fewer than LEAST_REPEATS never count.
    """
    for n in range(LEAST_REPEATS, MAX_REPEATS):
        if t_quantile(0.5 + 0.5 * CONFIDENCE, float(df + n - 1)) * s_percent <= until_percent * sqrt(n):
            return n
    return MAX_REPEATS


def expected(how: Settings, s_percent: float, df: int = POOLED_DF) -> float:
    """Return the expected number of measured values, up to ``at_most``: repeats, or pairs of them.

    ``s_percent``: standard deviation between repeats, per cent.
    """
    n = float(how.repeats)
    if how.until_percent is not None:
        n = max(n, float(needed(how.until_percent, s_of_values(how, s_percent), df)))
    if how.repeats > ALONE:
        n *= 1.0 + MADE_UP
    return min(n, float(how.at_most))


def reached_percent(how: Settings, s_percent: float) -> float:
    """Return the expanded repeatability (95 %) expected of ``at_most`` repeats, per cent; inf for a single one."""
    n = how.at_most
    t = t_quantile(0.5 + 0.5 * CONFIDENCE, float(POOLED_DF))
    return t * s_of_values(how, s_percent) / sqrt(n) if n > 1 else inf
