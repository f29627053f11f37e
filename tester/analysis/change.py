"""By how much friction changed at once: within a repeat, and from one repeat to the next.

Within a repeat every block boundary is tried. Blocks before and after it have two levels, and the surface temperature
has a sensitivity with the prior of the drift's fit (``tester.analysis.drift``); the boundary that leaves the least is
where friction changed most. All blocks are looked at, those left out as a transient too: that is where a step hides.

From repeat to repeat every boundary is tried, too: the means before and after it are held against each other with the
repeatability, which is known beforehand and told more of by what the repeats leave.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import inf, isfinite, sqrt
from typing import Final

from tester.analysis.blocks import Block
from tester.analysis.drift import PER_KELVIN_PERCENT
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN, RepeatResult
from tester.analysis.stability import MIN_BLOCKS
from tester.base.quantities import temperatures

LIMIT_PERCENT: Final = 5.0
"""Friction that changes by more than this at once carries a doubt, per cent of the coefficient [A]: two and a half
times the repeatability, and what a drift of the greatest allowed makes in two and a half windows."""
LEVEL: Final = 0.001
"""Level of the test for a change from repeat to repeat, of all boundaries of a condition together."""
HISTORY_DF: Final = 8.0
"""Weight of the repeatability that is known beforehand, degrees of freedom [A]."""


def change_within(blocks: Sequence[Block]) -> float:
    """Return the greatest change of level within a repeat, per cent of its coefficient, above 0 where friction rises.

    NaN of fewer than six blocks, or of a repeat without a coefficient.
    """
    n = len(blocks)
    mu = [block.mu for block in blocks]
    if n < MIN_BLOCKS or not all(map(isfinite, mu)) or sum(mu) <= 0.0:
        return NAN
    mean = sum(mu) / n
    y = [value / mean - 1.0 for value in mu]
    surface = temperatures(block.means for block in blocks)
    middle = sum(surface) / n
    c = [celsius - middle for celsius in surface]
    # Neighbours tell the noise: a step is in one of their differences alone.
    noise = sum((b - a) ** 2 for a, b in pairwise(y)) / (2.0 * (n - 1))
    held = sum(kelvin * kelvin for kelvin in c) + noise / (0.01 * PER_KELVIN_PERCENT) ** 2
    cy = sum(kelvin * value for kelvin, value in zip(c, y, strict=True))
    best, found = -inf, 0.0
    later_y = later_c = 0.0
    for k in range(n - 1, 0, -1):
        later_y += y[k]
        later_c += c[k]
        tt = k * (n - k) / n
        determinant = tt * held - later_c * later_c
        if determinant <= 1e-9 * tt * held:
            continue
        step = (later_y * held - cy * later_c) / determinant
        explained = step * step * determinant / held if held > 0.0 else step * step * tt
        if explained > best:
            best, found = explained, step
    return 100.0 * found


def change_between(values: Sequence[float], repeatability: float) -> float:
    """Return the greatest change between repeats, in order, that is shown to be one; 0 where none is.

    Per cent of their mean; ``repeatability``: standard deviation between repeats as it is known beforehand, a share.
    """
    n = len(values)
    if n < 2:
        return 0.0
    mean = sum(values) / n
    y = [value / mean - 1.0 for value in values]
    t = t_quantile(1.0 - 0.5 * LEVEL / (n - 1), inf)
    shown = [0.0]
    for k in range(1, n):
        before, after = y[:k], y[k:]
        a, b = sum(before) / k, sum(after) / (n - k)
        rest = sum((value - a) ** 2 for value in before) + sum((value - b) ** 2 for value in after)
        s = sqrt((rest + HISTORY_DF * repeatability**2) / (n - 2 + HISTORY_DF))
        if abs(b - a) > t * s * sqrt(1.0 / k + 1.0 / (n - k)):
            shown.append(b - a)
    return 100.0 * max(shown, key=abs)


def greatest(values: Iterable[float]) -> float:
    """Return the value that is furthest from 0, NaN where none is known."""
    return max((value for value in values if isfinite(value)), key=abs, default=NAN)


def change_of(repeats: Sequence[RepeatResult], repeatability: float) -> float:
    """Return the greatest change within one or between any of the repeats of a condition, per cent; NaN if unknown.

    ``repeats``: those that have a coefficient, in order of time, all of one direction.
    """
    values = [one.mu_resultant for one in repeats]
    between = [change_between(values, repeatability)] if len(values) > 1 else []
    return greatest([*(one.change_percent for one in repeats), *between])
