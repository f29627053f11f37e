"""Whether conditions lie on one curve: a plain verdict, and what it rests on.

Each test adds columns to the curve and asks, by Fisher's F, whether they take away more of the residual than chance
does: a factor for each temperature; a shift of its own for each; a shape that changes with temperature. What the test
calls chance is what the wider model leaves, and never less than ``FLOOR``: a set that is 0.1 % off everywhere is one
for all that anybody does with it.

Before that, whether the conditions could say so at all. A curve without a bend can be moved along as well as up: then
a shift is no more than a factor by another name, and any law of aT does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Final

import numpy as np

from tester.analysis.master_curve.collapse import Collapse, padded
from tester.analysis.master_curve.overlap import TemperaturePair
from tester.analysis.master_curve.spline import left_over, orthonormal
from tester.analysis.quantiles import f_quantile

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

LEVEL: Final = 1e-4
"""Of each test: of ten thousand sets that do collapse one is refused [A]."""
FLOOR: Final = 0.01
"""Standard deviation of ln mu that nobody calls a failure: 1 % [A]."""
LEAST_TEMPERATURES: Final = 3
LEAST_SPEEDS: Final = 3
"""Of each temperature, on average: with fewer none has a shape."""
OPEN_K: Final = 10.0
"""Standard uncertainty of Ts, were every temperature to have a factor of its own, from which on it is open [A]."""
WIDE_K: Final = 40.0
"""Length of the interval of Ts from which on nothing is known of it [A]: it spans rubbers from NR to NBR."""


class Verdict(StrEnum):
    """Whether a set is one curve."""

    COLLAPSES = "collapses"
    DOES_NOT = "does not collapse"
    OPEN = "cannot tell"


@dataclass(frozen=True, slots=True)
class CollapseTest:
    """One way in which a set may fail: F, and what it stays below in all but ``LEVEL`` of sets that do collapse."""

    name: str
    f: float
    critical: float

    @property
    def failed(self) -> bool:
        """Tell whether the set fails in this way."""
        return not self.f <= self.critical


@dataclass(frozen=True, slots=True)
class MasterJudgement:
    """The verdict, the reasons in words, and the tests."""

    verdict: Verdict
    reasons: tuple[str, ...]
    tests: tuple[CollapseTest, ...]


def judge(one: Collapse, pairs: Sequence[TemperaturePair]) -> MasterJudgement:
    """Return whether a set is one curve, by its collapse and its pairs of neighbouring temperatures."""
    unknown = tuple(_unknown(one, pairs))
    if unknown:
        return MasterJudgement(Verdict.OPEN, unknown, ())
    tests = tests_of(one)
    failed = sorted((test for test in tests if test.failed), key=lambda test: -test.f / test.critical)
    if failed:
        return MasterJudgement(Verdict.DOES_NOT, tuple(_WORDS[test.name] for test in failed), tests)
    vague = tuple(_vague(one))
    return MasterJudgement(Verdict.OPEN if vague else Verdict.COLLAPSES, vague, tests)


def _unknown(one: Collapse, pairs: Sequence[TemperaturePair]) -> list[str]:
    of = one.of
    if len(of.blocks_c) < LEAST_TEMPERATURES:
        return [f"{len(of.blocks_c)} temperatures (expected at least {LEAST_TEMPERATURES})"]
    if of.log_v.size < LEAST_SPEEDS * len(of.blocks_c):
        return [f"fewer than {LEAST_SPEEDS} speeds a temperature"]
    apart = [f"{pair.colder_c:g} and {pair.warmer_c:g} degC" for pair in pairs if not pair.tied]
    if apart:
        return [f"too little overlap: on the curve nothing of {', '.join(apart)} lies side by side"]
    if one.u_factors_k > OPEN_K or not _bends(one):
        return [
            "mu has no bend that a shift could be told by: a power law in v collapses at any shift, for moving it along"
            " and multiplying it are the same"
        ]
    return []


def _bends(one: Collapse) -> bool:
    """Tell whether the curve shows more than a straight line does that every temperature lays where it likes."""
    of, curve = one.of, one.design()
    factors_of_runs = curve[:, one.interior + 4 :]
    straight = np.column_stack([padded(of, np.column_stack([of.in_block, one.x])), factors_of_runs])
    test = _test("bend", straight, curve, padded(of, of.log_mu))
    return test is not None and test.failed


def _vague(one: Collapse) -> list[str]:
    low, high = one.interval
    if one.at_end:
        return [f"no Ts is best: the search ended at the end of its range, {one.ts_c:.0f} degC"]
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


def tests_of(one: Collapse) -> tuple[CollapseTest, ...]:
    """Return every test of a set."""
    of = one.of
    base = one.design()
    if one.searched:
        base = np.column_stack([base, padded(of, one.moved_by_ts())])
    slope = one.curve.slope(one.x)[:, None]
    splines = base[: one.residual.size, : one.interior + 4]
    warmer = (of.celsius - np.mean(of.celsius))[:, None]
    further = {_FACTORS: of.in_block, _SHIFTS: slope * of.in_block, _SHAPE: splines * warmer}
    found = [_test(name, base, padded(of, columns), padded(of, of.log_mu)) for name, columns in further.items()]
    return tuple(test for test in found if test is not None)


def _test(name: str, base: Array, further: Array, y: Array) -> CollapseTest | None:
    """Return a test of further columns, None where they leave nothing to tell chance by."""
    plain, wide = orthonormal(base), orthonormal(np.column_stack([base, further]))
    more, df = wide.shape[1] - plain.shape[1], y.size - wide.shape[1]
    if more < 1 or df < 2:
        return None
    before, after = (float(np.sum(left_over(q, y) ** 2)) for q in (plain, wide))
    chance = max(after / df, FLOOR**2)
    return CollapseTest(name, max(before - after, 0.0) / more / chance, f_quantile(1.0 - LEVEL, float(more), float(df)))
