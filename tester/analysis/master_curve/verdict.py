"""Whether conditions lie on one curve: a verdict, and the tests behind it.

Each test adds columns to the curve and compares, by Fisher's F, the reduction of the residual with chance: a factor for
each temperature; a shift of its own for each; a shape that changes with temperature. Chance is the residual of the
wider model, and at least ``FLOOR``: a set that is 0.1 % off everywhere lies on one curve for any practical use.

First comes a check whether the conditions can decide at all. On a straight curve a shift along x equals a factor on mu,
so any law of aT fits.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from math import log
from typing import Final

import numpy as np

from tester.analysis.master_curve.collapse import Collapse, padded
from tester.analysis.master_curve.overlap import TemperaturePair
from tester.analysis.master_curve.points import MasterPoint
from tester.analysis.master_curve.spline import left_over, orthonormal
from tester.analysis.quantiles import f_quantile
from tester.base.arrays import Array

LEVEL: Final = 1e-4
"""Level of each test: one in ten thousand sets that do collapse is refused [A]."""
FLOOR: Final = 0.01
"""Standard deviation of ln mu too small to count as a failure: 1 % [A]."""
LEAST_TEMPERATURES: Final = 3
LEAST_SPEEDS: Final = 3
"""Least speeds per temperature, on average: with fewer, no temperature shows the curve's shape."""
OPEN_K: Final = 10.0
"""Standard uncertainty of Ts, with a factor of its own for every temperature, above which Ts is open [A]."""
WIDE_K: Final = 40.0
"""Length of the interval of Ts above which Ts is unknown [A]: it spans rubbers from NR to NBR."""


class Verdict(StrEnum):
    """Whether the conditions of a set lie on one master curve."""

    COLLAPSES = "collapses"
    DOES_NOT = "does not collapse"
    OPEN = "cannot tell"


@dataclass(frozen=True, slots=True)
class CollapseTest:
    """One way in which a set may fail: F, and the limit that it exceeds in ``LEVEL`` of sets that do collapse."""

    name: str
    f: float
    critical: float

    @property
    def failed(self) -> bool:
        """Return whether the set fails in this way."""
        return not self.f <= self.critical


@dataclass(frozen=True, slots=True)
class MasterJudgement:
    """The verdict, the reasons in words, and the tests."""

    verdict: Verdict
    reasons: tuple[str, ...]
    tests: tuple[CollapseTest, ...]


def judge(collapse: Collapse, pairs: Sequence[TemperaturePair]) -> MasterJudgement:
    """Return whether a set is one curve, from its collapse and its pairs of neighbouring temperatures."""
    unknown = tuple(_unknown(collapse, pairs))
    if unknown:
        return MasterJudgement(Verdict.OPEN, unknown, ())
    tests = tests_of(collapse)
    failed = sorted((test for test in tests if test.failed), key=lambda test: -test.f / test.critical)
    if failed:
        return MasterJudgement(Verdict.DOES_NOT, tuple(_WORDS[test.name] for test in failed), tests)
    vague = tuple(_vague(collapse))
    return MasterJudgement(Verdict.OPEN if vague else Verdict.COLLAPSES, vague, tests)


def _unknown(collapse: Collapse, pairs: Sequence[TemperaturePair]) -> list[str]:
    of = collapse.of
    if len(of.blocks_c) < LEAST_TEMPERATURES:
        return [f"{len(of.blocks_c)} temperatures (expected at least {LEAST_TEMPERATURES})"]
    if of.log_v.size < LEAST_SPEEDS * len(of.blocks_c):
        return [f"fewer than {LEAST_SPEEDS} speeds a temperature"]
    apart = [f"{pair.colder_c:g} and {pair.warmer_c:g} degC" for pair in pairs if not pair.tied]
    if apart:
        return [f"too little overlap: on the curve nothing of {', '.join(apart)} lies side by side"]
    if collapse.u_factors_k > OPEN_K or not _bends(collapse):
        return [
            "mu has no bend to determine a shift: a power law in v collapses at any shift, for moving it along"
            " and multiplying it are the same"
        ]
    return []


def _bends(collapse: Collapse) -> bool:
    """Return whether the curve shows more than a straight line with a free factor for every temperature."""
    of, curve = collapse.of, collapse.design()
    factors_of_runs = curve[:, collapse.interior + 4 :]
    straight = np.column_stack([padded(of, np.column_stack([of.in_block, collapse.x])), factors_of_runs])
    test = _test("bend", straight, curve, padded(of, of.log_mu))
    return test is not None and test.failed


def _vague(collapse: Collapse) -> list[str]:
    low, high = collapse.interval
    if collapse.at_end:
        return [f"no Ts is best: the search ended at the end of its range, {collapse.ts_c:.0f} degC"]
    if high - low > WIDE_K:
        return [f"Ts is open over {high - low:.0f} K"]
    return []


_FACTORS, _SHIFTS, _SHAPE = "factors", "shifts", "shape"
_WORDS: Final = {
    _FACTORS: "temperatures lie above or below the curve by factors of their own",
    _SHIFTS: "temperatures ask for shifts that are not those of WLF",
    _SHAPE: "the curve's shape changes with temperature",
}
TEST_WORDS: Final = {
    _FACTORS: "a factor for each temperature",
    _SHIFTS: "a shift of its own for each temperature",
    _SHAPE: "a shape that changes with temperature",
}


def tests_of(collapse: Collapse) -> tuple[CollapseTest, ...]:
    """Return every test of a set."""
    of = collapse.of
    base = collapse.design()
    if collapse.searched:
        base = np.column_stack([base, padded(of, collapse.moved_by_ts())])
    slope = collapse.curve.slope(collapse.x)[:, None]
    splines = base[: collapse.residual.size, : collapse.interior + 4]
    warmer = (of.celsius - np.mean(of.celsius))[:, None]
    further = {_FACTORS: of.in_block, _SHIFTS: slope * of.in_block, _SHAPE: splines * warmer}
    tests = [_test(name, base, padded(of, columns), padded(of, of.log_mu)) for name, columns in further.items()]
    return tuple(test for test in tests if test is not None)


def _test(name: str, base: Array, further: Array, y: Array) -> CollapseTest | None:
    """Return a test of further columns, None where they leave no degrees of freedom for chance."""
    plain, wide = orthonormal(base), orthonormal(np.column_stack([base, further]))
    more, df = wide.shape[1] - plain.shape[1], y.size - wide.shape[1]
    if more < 1 or df < 2:
        return None
    before, after = (float(np.sum(left_over(q, y) ** 2)) for q in (plain, wide))
    chance = max(after / df, FLOOR**2)
    return CollapseTest(name, max(before - after, 0.0) / more / chance, f_quantile(1.0 - LEVEL, float(more), float(df)))


CLEAR: Final = 0.02
"""Smallest change of ln mu that counts: 2 % [A]."""


@dataclass(frozen=True, slots=True)
class Signs:
    """Cells of two neighbouring speeds and temperatures in which mu changes clearly with both.

    ``same``: cells in which mu changes the same way with both. No master curve allows that.
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
