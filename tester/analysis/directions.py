"""A coefficient from both directions of sliding: what each showed, and what their difference is free of.

With the cell's axes turned by theta against those of the contact, load shows as friction. It does so whichever way the
rubber slides, while friction turns round with the sliding. Of signed coefficients l = Fx / Fz

    half difference (l+ - l-) / 2 = mu (1 + theta^2 (1 + mu^2)),      half sum (l+ + l-) / 2 = theta (1 + mu^2),

so half the difference is the coefficient, and half the sum tells the angle. A share of the load that the friction
channel sees, and of friction that the load channel sees (crosstalk), goes the same ways, and is in that angle.

Repeats alternate + - - +: what changes evenly with time drops out of every two pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite

from tester.analysis.change import greatest
from tester.analysis.flags import flags_in, joined
from tester.analysis.reduce import standard_deviation, without_value
from tester.analysis.results import RepeatResult, RepeatStatus, most_swinging
from tester.base.quantities import Means, mean_of


def is_reversed(repeat: int) -> bool:
    """Tell whether a repeat, counted from 1, slides against the direction that is asked for: no, yes, yes, no, ..."""
    return repeat % 4 in (2, 3)


@dataclass(frozen=True, slots=True)
class SlidingWay:
    """What the repeats of one direction show: how many, mean and standard deviation of the coefficient, the mean along
    the sliding with its sign, their drift (per cent a window), and the means of what was measured."""

    n: int
    mu: float
    s: float
    along: float
    drift_percent: float
    means: Means


@dataclass(frozen=True, slots=True)
class BothWays:
    """Both directions of a condition. ``half_sum``: of the signed coefficients, with the standard deviation between
    its ``pairs``."""

    forward: SlidingWay
    backward: SlidingWay
    pairs: int
    half_sum: float
    half_sum_s: float

    @property
    def difference_percent(self) -> float:
        """Return by how much the direction that is asked for shows more, per cent of the mean of both."""
        mean = 0.5 * (self.forward.mu + self.backward.mu)
        return 100.0 * (self.forward.mu - self.backward.mu) / mean if mean > 0.0 else float("nan")

    @property
    def turning(self) -> dict[str, float]:
        """Return half the difference of the channels' means: how much of each turns round with the sliding."""
        backward = self.backward.means
        return {name: 0.5 * (value - backward[name]) for name, value in self.forward.means.items()}


def both_ways(pairs: Sequence[tuple[RepeatResult, RepeatResult]]) -> BothWays:
    """Return what at least one pair shows, each a repeat as asked for and one reversed."""
    sums = [0.5 * (one.mu_longitudinal + other.mu_longitudinal) for one, other in pairs]
    forward, backward = (_way([pair[side] for pair in pairs]) for side in (0, 1))
    return BothWays(forward, backward, len(pairs), sum(sums) / len(sums), standard_deviation(sums))


def _way(repeats: Sequence[RepeatResult]) -> SlidingWay:
    n = len(repeats)
    values, drifts = [one.mu_resultant for one in repeats], [one.drift_percent for one in repeats]
    along = sum(one.mu_longitudinal for one in repeats) / n
    return SlidingWay(n, sum(values) / n, standard_deviation(values), along, sum(drifts) / n,
                      mean_of(one.means for one in repeats))  # fmt: skip


def mean_of_both_ways(given: Sequence[BothWays]) -> BothWays:
    """Return what stands for replicates, each of equal weight; deviations between pairs are pooled."""
    forward, backward = _mean_way([one.forward for one in given]), _mean_way([one.backward for one in given])
    df = [one.pairs - 1 for one in given]
    squares = sum(n * one.half_sum_s**2 for n, one in zip(df, given, strict=True) if n)
    spread = (squares / sum(df)) ** 0.5 if sum(df) else float("nan")
    half_sum = sum(one.half_sum for one in given) / len(given)
    return BothWays(forward, backward, sum(one.pairs for one in given), half_sum, spread)


def _mean_way(given: Sequence[SlidingWay]) -> SlidingWay:
    n = len(given)
    values = [one.mu for one in given]
    along, drift = sum(one.along for one in given) / n, sum(one.drift_percent for one in given) / n
    return SlidingWay(sum(one.n for one in given), sum(values) / n, standard_deviation(values), along, drift,
                      mean_of(one.means for one in given))  # fmt: skip


def halves(results: Sequence[RepeatResult], pair: int) -> tuple[int, int]:
    """Return where the repeats of a pair (from 0) are: the one as asked for, and the reversed one."""
    first = 2 * pair
    return (first + 1, first) if is_reversed(first + 1) else (first, first + 1)


def as_pairs(results: Sequence[RepeatResult], *, whole: bool = False) -> list[RepeatResult]:
    """Return a result for each pair: half the difference of its repeats, valid where both are.

    ``whole``: leave out a last pair of which one repeat is not there.
    """
    count = len(results) // 2 if whole else (len(results) + 1) // 2
    return [_as_one(results, pair) for pair in range(count)]


def _as_one(results: Sequence[RepeatResult], pair: int) -> RepeatResult:
    places = halves(results, pair)
    there = [results[place] for place in places if place < len(results)]
    odd = next(((results[place], place) for place in sorted(places) if place < len(results)
                and not results[place].valid), None)  # fmt: skip
    status, reason = RepeatStatus.VALID, ""
    if odd is not None:
        status, reason = odd[0].status, f"repeat {odd[1] + 1}: {odd[0].reason}" if odd[0].reason else ""
    if len(there) < 2 or not all(isfinite(one.mu_resultant) for one in there):
        ended = max(one.ended_s for one in there)
        if odd is None:
            return without_value(RepeatStatus.TOO_FEW, "its other direction was not measured", ended_s=ended)
        return without_value(status, odd[0].reason, ended_s=ended)
    forward, backward = there
    along = 0.5 * (forward.mu_longitudinal - backward.mu_longitudinal)
    across = 0.5 * (forward.mu_lateral - backward.mu_lateral)
    swings = most_swinging((forward, backward))
    return RepeatResult(
        status=status,
        reason=reason,
        flags=joined([*flags_in(forward.flags), *flags_in(backward.flags)]),
        mu_resultant=hypot(along, across),
        mu_longitudinal=along,
        mu_lateral=across,
        uncertainty=0.5 * hypot(forward.uncertainty, backward.uncertainty),
        fluctuation_percent=0.5 * hypot(forward.fluctuation_percent, backward.fluctuation_percent),
        batches=min(forward.batches, backward.batches),
        drift_percent=0.5 * (forward.drift_percent + backward.drift_percent),
        bound_percent=max(forward.bound_percent, backward.bound_percent),
        change_percent=greatest((forward.change_percent, backward.change_percent)),
        swing_percent=swings.swing_percent,
        swing_hz=swings.swing_hz,
        revolutions=forward.revolutions + backward.revolutions,
        truncated=forward.truncated + backward.truncated,
        window_s=forward.window_s + backward.window_s,
        bursts=forward.bursts + backward.bursts,
        means=_half_difference(forward.means, backward.means),
        started_s=min(forward.started_s, backward.started_s),
        ended_s=max(forward.ended_s, backward.ended_s),
    )


def _half_difference(forward: Means, backward: Means) -> Means:
    """Return the means over both directions; friction, which turns round, by half the difference."""
    table = forward.table
    turning = table.roles.friction if table is not None else ()
    values = (
        0.5 * (value - backward[name] if name in turning else value + backward[name])
        for name, value in forward.items()
    )
    return Means(table, values)
