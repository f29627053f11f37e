"""A coefficient from both directions of sliding: the result of each, and the errors that their difference removes.

With the cell's axes turned by theta against those of the contact, load shows as friction. Its sign does not depend on
the direction of sliding, while friction reverses. Of signed coefficients l = Fx / Fz

  half difference (l+ - l-) / 2 = mu (1 + theta^2 (1 + mu^2)),      half sum (l+ + l-) / 2 = theta (1 + mu^2),

so half the difference is the coefficient, and half the sum yields the angle. Crosstalk (a share of the load on the
friction channel, or of friction on the load channel) behaves the same way and is part of that angle.

Repeats alternate + - - +: a linear change in time drops out of every two pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite

from tester.analysis.change import greatest
from tester.analysis.flags import flags_in, joined
from tester.analysis.reduce import standard_deviation, without_value
from tester.analysis.results import RepeatResult, RepeatStatus, greatest_swing
from tester.base.quantities import Means, mean_of


def is_reversed(repeat: int) -> bool:
    """Return whether a repeat, counted from 1, slides against the requested direction: no, yes, yes, no, ..."""
    return repeat % 4 in (2, 3)


@dataclass(frozen=True, slots=True)
class SlidingWay:
    """Result of the repeats of one direction: number, mean and standard deviation of the coefficient, the mean along
    the sliding with its sign, their drift (per cent a window), and the means of the channels."""

    n: int
    mu: float
    s: float
    along: float
    drift_percent: float
    means: Means


@dataclass(frozen=True, slots=True)
class BothWays:
    """Both directions of a condition. ``half_sum``: of the signed coefficients, with the standard deviation between its
    ``pairs``."""

    forward: SlidingWay
    backward: SlidingWay
    pairs: int
    half_sum: float
    half_sum_s: float

    @property
    def difference_percent(self) -> float:
        """Return the excess of the requested direction over the reverse, per cent of the mean of both."""
        mean = 0.5 * (self.forward.mu + self.backward.mu)
        return 100.0 * (self.forward.mu - self.backward.mu) / mean if mean > 0.0 else float("nan")

    @property
    def turning(self) -> dict[str, float]:
        """Return half the difference of the channels' means: the part of each that reverses with the sliding."""
        backward = self.backward.means
        return {name: 0.5 * (value - backward[name]) for name, value in self.forward.means.items()}


def both_ways(pairs: Sequence[tuple[RepeatResult, RepeatResult]]) -> BothWays:
    """Return the result of at least one pair, each a repeat in the requested direction and one in the reverse."""
    sums = [
        0.5 * (forward_repeat.mu_longitudinal + reverse_repeat.mu_longitudinal)
        for forward_repeat, reverse_repeat in pairs
    ]
    forward, backward = (_way([pair[side] for pair in pairs]) for side in (0, 1))
    return BothWays(forward, backward, len(pairs), sum(sums) / len(sums), standard_deviation(sums))


def _way(repeats: Sequence[RepeatResult]) -> SlidingWay:
    n = len(repeats)
    means = mean_of(repeat.means for repeat in repeats)
    values, drifts = [repeat.mu_resultant for repeat in repeats], [repeat.drift_percent for repeat in repeats]
    along = sum(repeat.mu_longitudinal for repeat in repeats) / n
    return SlidingWay(n, sum(values) / n, standard_deviation(values), along, sum(drifts) / n, means)


def mean_of_both_ways(replicates: Sequence[BothWays]) -> BothWays:
    """Return the mean over replicates, each of equal weight; deviations between pairs are pooled."""
    forward = _mean_way([replicate.forward for replicate in replicates])
    backward = _mean_way([replicate.backward for replicate in replicates])
    df = [replicate.pairs - 1 for replicate in replicates]
    squares = sum(n * replicate.half_sum_s**2 for n, replicate in zip(df, replicates, strict=True) if n)
    spread = (squares / sum(df)) ** 0.5 if sum(df) else float("nan")
    half_sum = sum(replicate.half_sum for replicate in replicates) / len(replicates)
    return BothWays(forward, backward, sum(replicate.pairs for replicate in replicates), half_sum, spread)


def _mean_way(ways: Sequence[SlidingWay]) -> SlidingWay:
    n = len(ways)
    values = [way.mu for way in ways]
    means = mean_of(way.means for way in ways)
    along, drift = sum(way.along for way in ways) / n, sum(way.drift_percent for way in ways) / n
    return SlidingWay(sum(way.n for way in ways), sum(values) / n, standard_deviation(values), along, drift, means)


def halves(pair: int) -> tuple[int, int]:
    """Return the places of the repeats of a pair (from 0): the one in the requested direction, then the reverse."""
    first = 2 * pair
    return (first + 1, first) if is_reversed(first + 1) else (first, first + 1)


def as_pairs(results: Sequence[RepeatResult], *, whole: bool = False) -> list[RepeatResult]:
    """Return a result for each pair: half the difference of its repeats, valid where both are.

    ``whole``: leave out a last pair that lacks a repeat.
    """
    count = len(results) // 2 if whole else (len(results) + 1) // 2
    return [_as_one(results, pair) for pair in range(count)]


def _as_one(results: Sequence[RepeatResult], pair: int) -> RepeatResult:
    places = halves(pair)
    there = [results[place] for place in places if place < len(results)]
    odd = next(((results[place], place) for place in sorted(places) if place < len(results)
                and not results[place].valid), None)  # fmt: skip
    status, reason = RepeatStatus.VALID, ""
    if odd is not None:
        status, reason = odd[0].status, f"repeat {odd[1] + 1}: {odd[0].reason}" if odd[0].reason else ""
    if len(there) < 2 or not all(isfinite(half.mu_resultant) for half in there):
        ended = max(half.ended_s for half in there)
        if odd is None:
            return without_value(RepeatStatus.TOO_FEW, "its other direction was not measured", ended_s=ended)
        return without_value(status, odd[0].reason, ended_s=ended)
    forward, backward = there
    along = 0.5 * (forward.mu_longitudinal - backward.mu_longitudinal)
    across = 0.5 * (forward.mu_lateral - backward.mu_lateral)
    swing_percent, swing_hz = greatest_swing((half.swing_percent, half.swing_hz) for half in there)
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
        swing_percent=swing_percent,
        swing_hz=swing_hz,
        revolutions=forward.revolutions + backward.revolutions,
        truncated=forward.truncated + backward.truncated,
        window_s=forward.window_s + backward.window_s,
        bursts=forward.bursts + backward.bursts,
        means=_half_difference(forward.means, backward.means),
        started_s=min(forward.started_s, backward.started_s),
        ended_s=max(forward.ended_s, backward.ended_s),
    )


def _half_difference(forward: Means, backward: Means) -> Means:
    """Return the means over both directions; for friction, which reverses, half the difference."""
    table = forward.table
    turning = table.roles.friction if table is not None else ()
    values = (
        0.5 * (value - backward[name] if name in turning else value + backward[name]) for name, value in forward.items()
    )
    return Means(table, values)
