"""Counts evidence against any shift: a coefficient that rises with speed and with temperature.

On a master curve mu depends on aT v alone, and aT falls with temperature. Warming therefore acts as slowing does: where
mu rises with v it falls with T, and the other way round.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log
from typing import Final

from tester.analysis.master_curve.points import MasterPoint

CLEAR: Final = 0.02
"""Smallest change of ln mu that counts: 2 % [A]."""


@dataclass(frozen=True, slots=True)
class Signs:
    """Cells of two neighbouring speeds and temperatures in which mu changes clearly with both.

    ``same``: cells in which it changes the same way with both, which no master curve allows.
    """

    cells: int
    same: int


def signs_of(points: Sequence[MasterPoint]) -> Signs:
    """Return how often mu rises, or falls, with both speed and temperature; other axes and compounds are kept apart."""
    grids: defaultdict[tuple[object, ...], dict[tuple[float, float], float]] = defaultdict(dict)
    for point in points:
        key = (point.compound, point.source.name, *sorted(point.held.items()))
        grids[key][point.block_c, round(log(point.speed_m_s), 2)] = log(point.mu)
    cells = same = 0
    for grid in grids.values():
        celsius, speeds = (sorted({place[i] for place in grid}) for i in (0, 1))
        for cold, warm in pairwise(celsius):
            for slow, fast in pairwise(speeds):
                four = [grid.get((t, v)) for t in (cold, warm) for v in (slow, fast)]
                if any(value is None for value in four):
                    continue
                a, b, c, d = (value for value in four if value is not None)
                with_speed, with_warmth = 0.5 * (b - a + d - c), 0.5 * (c - a + d - b)
                if min(abs(with_speed), abs(with_warmth)) >= CLEAR:
                    cells += 1
                    same += (with_speed > 0.0) == (with_warmth > 0.0)
    return Signs(cells, same)
