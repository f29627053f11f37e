"""The repeats of two runs along their number, rig time or sliding: difference and ratio where both have a value.

Only repeats of the same condition are compared. Between two neighbouring repeats of a condition the coefficient is
taken as linear; the common places are all those at which either run has a repeat, inside the overlap of the two.
Outside it there is no value. U is that of the scatter within the repeats, independent in the two runs: what both share,
such as a calibration, is not in it.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from math import hypot, isfinite
from typing import Final, NamedTuple

from tester.analysis.difference import Difference
from tester.analysis.uncertainty import effective_df
from tester.base.axes import condition_words
from tester.results.compared import Pair
from tester.results.table_rows import Measured
from tester.store.records import StoredRepeat, Travel

ALONG: Final = {"repeat": ("repeat", ""), "time": ("rig time", "s"), "sliding": ("sliding", "m")}
"""What repeats may be aligned on, with title and unit."""
EXACT: Final = "repeat"
"""Compared at equal numbers alone: there is nothing between two repeats."""
_LINEAR: Final = (
    "Between two repeats of the same condition the coefficient is taken as linear; compared where both runs have it"
)
HOW: Final = {
    EXACT: "Compared at equal numbers of repeats of the same condition.",
    "time": f"{_LINEAR} at the same rig time, nowhere else.",
    "sliding": f"{_LINEAR} after the same sliding, nowhere else.",
}  # fmt: skip
"""How runs are compared along each, for people."""


class RepeatPlace(NamedTuple):
    """A repeat's coefficient as measured at ``x``, its standard uncertainty and the degrees of freedom of that."""

    x: float
    mu: float
    u: float
    df: float

    @property
    def expanded(self) -> float:
        """Return the expanded uncertainty of the scatter within the repeat, 95 %; NaN without one."""
        return Difference(self.mu, self.u, self.df).expanded


class ComparedRepeats(NamedTuple):
    """Two runs at ``x``: second less first, and second over first with its expanded uncertainty (95 %)."""

    x: float
    found: Difference
    ratio: float
    ratio_u: float
    label: str


def place_of(repeat: StoredRepeat, along: str, travel: Travel | None) -> RepeatPlace:
    """Return where a repeat lies along a word of ``ALONG``; ``travel``: as its record has it. NaN where unknown."""
    x = {
        "repeat": float(repeat.repeat), "time": repeat.result.started_s,
        "sliding": travel.piece_m if travel is not None else float("nan"),
    }[along]  # fmt: skip
    return RepeatPlace(x, repeat.result.mu_resultant, repeat.result.uncertainty, float(repeat.result.batches - 1))


def compared_along(
    matched: Sequence[Pair], along: str, travels: Sequence[dict[int, Travel]]
) -> Iterator[ComparedRepeats]:
    """Yield the comparison of matched conditions, repeat by repeat; ``travels``: of both runs, by the repeats' keys."""
    for pair in matched:
        if pair.first is None or pair.second is None:
            continue
        for first, second in zip(pair.first.replicates, pair.second.replicates, strict=False):
            words = condition_words(first.info.setpoint)
            series = [_series(one, along, by) for one, by in zip((first, second), travels, strict=True)]
            for a, b in common(*series, exact=along == EXACT):
                yield _compared(a, b, words)


def _series(measured: Measured, along: str, travels: dict[int, Travel]) -> list[RepeatPlace]:
    """Return the repeats of a condition that are in its mean, by their place; of several at one place the first."""
    out = {excluded.position for excluded in measured.result.excluded}
    kept = [repeat for at, repeat in enumerate(measured.repeats) if at not in out]
    places = [place_of(repeat, along, travels.get(repeat.key)) for repeat in kept]
    by_x = {one.x: one for one in reversed(places) if isfinite(one.x) and isfinite(one.mu)}
    return [by_x[x] for x in sorted(by_x)]


def common(
    first: Sequence[RepeatPlace], second: Sequence[RepeatPlace], *, exact: bool
) -> Iterator[tuple[RepeatPlace, RepeatPlace]]:
    """Yield both series at every place of either inside their overlap; ``exact``: only where both have one. Each is
    ordered by ``x``, without doubles.
    """
    if not first or not second:
        return
    low, high = max(first[0].x, second[0].x), min(first[-1].x, second[-1].x)
    for x in sorted({one.x for one in (*first, *second) if low <= one.x <= high}):
        a, b = _at(first, x), _at(second, x)
        if not exact or (a in first and b in second):
            yield a, b


def _at(series: Sequence[RepeatPlace], x: float) -> RepeatPlace:
    """Return a series at ``x`` inside it, linear between neighbours; their uncertainties are independent."""
    place = bisect_left(series, x, key=lambda one: one.x)
    after = series[place]
    if after.x == x:
        return after
    before = series[place - 1]
    weight = (x - before.x) / (after.x - before.x)
    parts = [((1.0 - weight) * before.u, before.df), (weight * after.u, after.df)]
    standard = hypot(*(u for u, _ in parts))
    return RepeatPlace(x, before.mu + weight * (after.mu - before.mu), standard, _df(parts, standard))


def _compared(a: RepeatPlace, b: RepeatPlace, label: str) -> ComparedRepeats:
    parts = [(a.u, a.df), (b.u, b.df)]
    standard = hypot(a.u, b.u)
    found = Difference(b.mu - a.mu, standard, _df(parts, standard))
    if not a.mu:
        return ComparedRepeats(a.x, found, float("nan"), float("nan"), label)
    ratio = b.mu / a.mu
    of_ratio = [(b.u / a.mu, b.df), (ratio * a.u / a.mu, a.df)]
    spread = hypot(*(u for u, _ in of_ratio))
    return ComparedRepeats(a.x, found, ratio, Difference(ratio, spread, _df(of_ratio, spread)).expanded, label)


def _df(parts: Sequence[tuple[float, float]], standard: float) -> float:
    """Return the degrees of freedom of a sum; NaN where a part has none."""
    return effective_df(parts, standard) if isfinite(standard) and all(df > 0.0 for _, df in parts) else float("nan")
