"""Neighbouring temperatures by themselves: the shift that lays one on the other, independent of any law.

A cubic in log10 v goes through the ln mu of each temperature. The shift minimises the mean square difference of two
neighbours' cubics, over the decades that they have in common after it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan, sqrt
from typing import Final

import numpy as np

from tester.analysis.master_curve.collapse import Collapse, shifts
from tester.analysis.master_curve.points import MasterSet
from tester.base.arrays import Array

CUBIC_SPEEDS: Final = 5
"""Least number of speeds for a cubic of a temperature's own: one more than the cubic has coefficients."""
THIN_DECADES: Final = 1.0
"""A shorter overlap is thin [A]: a curve bends within a decade, and less shows no bend."""
THIN_SHIFT: Final = 0.3
"""A free shift with a larger standard uncertainty carries little information, decades [A]."""
_COARSE, _FINE = 0.05, 0.005
"""Steps of the search, decades."""
_PLACES: Final = 40


@dataclass(frozen=True, slots=True)
class TemperaturePair:
    """Two neighbouring temperatures, degC; shifts of the warmer against the colder, decades.

    ``overlap``: decades of x that both cover at the shift by WLF; ``rows``: conditions within it, of the temperature
    with fewer. ``free`` and its standard uncertainty ``u``: NaN and infinite where either lacks a cubic or spans too
    few decades.
    """

    colder_c: float
    warmer_c: float
    wlf: float
    overlap: float
    rows: int
    free: float = nan
    u: float = inf

    @property
    def difference(self) -> float:
        """Return the free shift less that by WLF, decades."""
        return self.free - self.wlf

    @property
    def tied(self) -> bool:
        """Return whether the two overlap at all."""
        return self.overlap > 0.0 and self.rows >= 2

    @property
    def thin(self) -> bool:
        """Return whether the overlap is too thin for a useful shift."""
        return not (self.overlap >= THIN_DECADES and self.u <= THIN_SHIFT)


def pairs_of(collapse: Collapse) -> tuple[TemperaturePair, ...]:
    """Return every two neighbouring temperatures of a collapsed set, from cold to warm."""
    of = collapse.of
    at = np.array([float(np.mean(of.celsius[of.block == i])) for i in range(len(of.blocks_c))])
    by_wlf = shifts(at, collapse.ts_c)
    pairs: list[TemperaturePair] = []
    for i in range(len(of.blocks_c) - 1):
        cold, warm = collapse.x[of.block == i], collapse.x[of.block == i + 1]
        low, high = max(cold.min(), warm.min()), min(cold.max(), warm.max())
        rows = min(int(np.sum((x >= low - 1e-9) & (x <= high + 1e-9))) for x in (cold, warm)) if high > low else 0
        free, u = _free(of, i, collapse.scatter)
        pairs.append(
            TemperaturePair(
                of.blocks_c[i], of.blocks_c[i + 1], float(by_wlf[i + 1] - by_wlf[i]), float(high - low), rows, free, u
            )
        )
    return tuple(pairs)


def _free(of: MasterSet, i: int, scatter: float) -> tuple[float, float]:
    """Return the free shift of temperature i + 1 against temperature i, and its standard uncertainty, decades."""
    colder, warmer = ((of.log_v[of.block == k], of.log_mu[of.block == k]) for k in (i, i + 1))
    if min(np.unique(np.round(v, 6)).size for v, _ in (colder, warmer)) < CUBIC_SPEEDS:
        return nan, inf
    cubics = [np.polynomial.Polynomial.fit(v, y, 3).convert() for v, y in (colder, warmer)]
    ends = [(float(v.min()), float(v.max())) for v, _ in (colder, warmer)]
    span = min(high - low for low, high in ends)
    reach = span - THIN_DECADES
    if reach <= 0.0:
        return nan, inf

    def common(shift: float) -> Array:
        low, high = max(ends[0][0], ends[1][0] + shift), min(ends[0][1], ends[1][1] + shift)
        return np.linspace(low, high, _PLACES)

    def off(shift: float) -> float:
        x = common(shift)
        return float(np.mean((cubics[0](x) - cubics[1](x - shift)) ** 2))

    best = min((float(trial) for trial in np.arange(-reach, reach, _COARSE)), key=off)
    close = best + np.arange(-_COARSE, _COARSE, _FINE)
    shift = min((float(trial) for trial in close if abs(trial) <= reach), key=off)
    x = common(shift)
    slope = sqrt(float(np.mean(cubics[0].deriv()(x) ** 2)))
    rows = (x[-1] - x[0]) / span * min(colder[0].size, warmer[0].size)
    return shift, scatter * sqrt(2.0 / rows) / slope if slope > 0.0 and rows > 0.0 else inf
