"""The sudden change of friction: within a repeat, and from one repeat to the next.

Within a repeat every block boundary is tried. Blocks before and after it have two levels, and the surface temperature
has a sensitivity with the prior of the drift's fit (``tester.analysis.drift``). The boundary that leaves the smallest
residual is where friction changed most. All blocks are examined, including the transient at the beginning, where a step
can hide.

Between repeats every boundary is tried as well. The means before and after it are compared with the repeatability: its
prior value, updated by the scatter of the repeats about those means.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from itertools import pairwise
from math import inf, isfinite, sqrt
from typing import Final

from tester.analysis.blocks import Block
from tester.analysis.drift import PER_KELVIN_PERCENT
from tester.analysis.left_out import REPEATABILITY
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN, RepeatResult
from tester.analysis.stability import MIN_BLOCKS, centred
from tester.base.quantities import temperatures

LIMIT_PERCENT: Final = 5.0
"""Friction that changes by more than this at once carries a doubt, per cent of the coefficient [A]: 2.5 times the
repeatability, and the largest allowed drift summed over 2.5 windows."""
LEVEL: Final = 0.001
"""Level of the test for a change from repeat to repeat, over all boundaries of a condition together."""
HISTORY_DF: Final = 8.0
"""Weight of the prior repeatability, degrees of freedom [A]."""


def change_within(blocks: Sequence[Block]) -> float:
    """Return the greatest change of level within a repeat, per cent of its coefficient, above 0 where friction rises.

    NaN for fewer than six blocks, or for a repeat without a coefficient.
    """
    n = len(blocks)
    mu = [block.mu for block in blocks]
    if n < MIN_BLOCKS or not all(map(isfinite, mu)) or sum(mu) <= 0.0:
        return NAN
    mean = sum(mu) / n
    y = [value / mean - 1.0 for value in mu]
    c = centred(temperatures(block.means for block in blocks))
    # Differences of neighbours estimate the noise: a step appears in only one of them.
    noise = sum((b - a) ** 2 for a, b in pairwise(y)) / (2.0 * (n - 1))
    information = sum(kelvin * kelvin for kelvin in c) + noise / (0.01 * PER_KELVIN_PERCENT) ** 2
    cy = sum(kelvin * value for kelvin, value in zip(c, y, strict=True))
    best, greatest_step = -inf, 0.0
    later_y = later_c = 0.0
    for k in range(n - 1, 0, -1):
        later_y += y[k]
        later_c += c[k]
        tt = k * (n - k) / n
        determinant = tt * information - later_c * later_c
        # A step here is collinear with the temperature: the fit cannot separate the two.
        if determinant <= 1e-9 * tt * information:
            continue
        step = (later_y * information - cy * later_c) / determinant
        explained = step * step * determinant / information if information > 0.0 else step * step * tt
        if explained > best:
            best, greatest_step = explained, step
    return 100.0 * greatest_step


def change_between(values: Sequence[float], repeatability: float) -> float:
    """Return the greatest significant change between repeats, per cent of their mean; 0 where none is significant.

    ``values``: in order of time. ``repeatability``: prior standard deviation between repeats, a share.
    """
    n = len(values)
    if n < 2:
        return 0.0
    mean = sum(values) / n
    y = [value / mean - 1.0 for value in values]
    t = t_quantile(1.0 - 0.5 * LEVEL / (n - 1), inf)
    significant = [0.0]
    for k in range(1, n):
        before, after = y[:k], y[k:]
        a, b = sum(before) / k, sum(after) / (n - k)
        rest = sum((value - a) ** 2 for value in before) + sum((value - b) ** 2 for value in after)
        s = sqrt((rest + HISTORY_DF * repeatability**2) / (n - 2 + HISTORY_DF))
        if abs(b - a) > t * s * sqrt(1.0 / k + 1.0 / (n - k)):
            significant.append(b - a)
    return 100.0 * max(significant, key=abs)


def greatest(values: Iterable[float]) -> float:
    """Return the value furthest from 0, NaN where none is known."""
    return max((value for value in values if isfinite(value)), key=abs, default=NAN)


def change_of(results: Sequence[RepeatResult], by_hand: Container[int] = ()) -> float:
    """Return the greatest change within a repeat or between the repeats of a condition, per cent; NaN if unknown.

    ``results``: in order of time, all of one direction. Those count that show friction: valid ones, and those refused
    for their drift. ``by_hand``: positions that a person has left out.
    """
    repeats = [result for i, result in enumerate(results) if (result.valid or result.drifts) and i not in by_hand]
    values = [repeat.mu_resultant for repeat in repeats]
    between = [change_between(values, REPEATABILITY)] if len(values) > 1 else []
    return greatest([*(repeat.change_percent for repeat in repeats), *between])
