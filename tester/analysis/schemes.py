"""How a condition's repeats make its values: each repeat by itself, or each pair of repeats that slide opposite ways.

Code that measures, stores and shows a condition calls a scheme and need not know which. Opposite directions also reveal
the misalignment of the load cell's axes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees, hypot, isfinite, sqrt
from typing import Final

from tester.analysis.blocks import Block
from tester.analysis.change import change_of, greatest
from tester.analysis.directions import as_pairs, both_ways, halves, is_reversed
from tester.analysis.flags import flags_in, joined
from tester.analysis.judge import judge
from tester.analysis.left_out import BY_HAND, NONE_BY_HAND, Combining, Exclusion, counting
from tester.analysis.left_out import PAIRS as COUNTED
from tester.analysis.quantiles import t_quantile
from tester.analysis.repeats import ConditionResult, combine_repeats
from tester.analysis.results import NAN, NOT_JUDGED, ConditionStatus, Judgement, RepeatResult
from tester.analysis.stability import Window
from tester.analysis.uncertainty import CONFIDENCE

OTHER_HALF: Final = "the other repeat of its pair does not count"
HALF: Final = "the other repeat of its pair is not made"


class Scheme:
    """Turns a condition's repeats, in order, into its values: each repeat is a value."""

    repeats_each = 1
    """Repeats behind one value."""

    def valid(self, results: Sequence[RepeatResult]) -> int:
        """Return the number of values from valid repeats."""
        return sum(result.valid for result in results)

    def values(self, results: Sequence[RepeatResult]) -> list[float]:
        """Return the coefficients that count."""
        return [results[i].mu_resultant for i in counting(results)]

    judge = staticmethod(judge)
    combine = staticmethod(combine_repeats)


class OppositePairs(Scheme):
    """A value is half the difference of a repeat in the requested direction and a reversed one; planned and least are
    pairs.

    A pair counts only if both its repeats do. Another pair makes up for it, so both directions keep the same number of
    repeats. Each direction has a drift of its own.
    """

    repeats_each = 2

    def valid(self, results: Sequence[RepeatResult]) -> int:
        return sum(pair.valid for pair in as_pairs(results, whole=True))

    def values(self, results: Sequence[RepeatResult]) -> list[float]:
        pairs = as_pairs(results, whole=True)
        return [pairs[i].mu_resultant for i in counting(pairs)]

    def judge(
        self,
        results: Sequence[RepeatResult],
        blocks: Sequence[Sequence[Block]],
        planned: int,
        window: Window,
    ) -> tuple[list[RepeatResult], Judgement]:
        """Judge each direction by its own repeats; return all of them, and the common judgement."""
        judged, judgements = list(results), list[Judgement]()
        for backward in (False, True):
            places = [i for i in range(len(results)) if is_reversed(i + 1) == backward]
            if not places:
                continue
            listed = [results[i] for i in places]
            repeats, judgement = judge(listed, [blocks[i] for i in places], planned, window)
            judgements.append(judgement)
            for place, repeat in zip(places, repeats, strict=True):
                judged[place] = repeat
        return judged, _together(judgements)

    def combine(
        self,
        results: Sequence[RepeatResult],
        planned: int,
        min_valid: int = 3,
        ended: ConditionStatus | None = None,
        reason: str = "",
        *,
        judged: Judgement = NOT_JUDGED,
        by_hand: Mapping[int, str] = NONE_BY_HAND,
        combining: Combining = "mean",
    ) -> ConditionResult:
        """Return the result of a condition from its pairs; ``by_hand`` and the exclusions are places of repeats."""
        changed_percent = _changed(results, by_hand)
        pairs = as_pairs(results, whole=ended is None)
        places_of = [halves(pair) for pair in range(len(pairs))]
        hands = {place // 2: why for place, why in by_hand.items() if place // 2 < len(pairs)}
        result = combine_repeats(pairs, planned, min_valid, ended, reason, judged=judged, by_hand=hands,
                                combining=combining, changed_percent=changed_percent, counted=COUNTED)  # fmt: skip
        out = {exclusion.position: exclusion.reason for exclusion in result.excluded}
        whole = [(a, b) for pair, (a, b) in enumerate(places_of) if pair not in out and max(a, b) < len(results)]
        excluded = [
            Exclusion(place, _why(results, place, out[pair], by_hand))
            for pair in sorted(out)
            for place in sorted(places_of[pair])
            if place < len(results)
        ]
        half = range(2 * len(pairs), len(results))
        excluded += [Exclusion(place, _why(results, place, HALF, by_hand)) for place in half]
        return replace(
            result,
            excluded=tuple(excluded),
            flagged=tuple(place for pair in result.flagged for place in sorted(places_of[pair])),
            both_ways=both_ways([(results[a], results[b]) for a, b in whole]) if whole else None,
        )


def _changed(results: Sequence[RepeatResult], by_hand: Mapping[int, str]) -> float:
    """Return the greatest sudden change within one direction: misaligned axes separate the two, whatever friction
    does."""
    ways = (
        [result for i, result in enumerate(results) if is_reversed(i + 1) == backward and i not in by_hand]
        for backward in (False, True)
    )
    return greatest(change_of(way) for way in ways)


def _why(results: Sequence[RepeatResult], place: int, of_pair: str, by_hand: Mapping[int, str]) -> str:
    """Return why a repeat of an excluded pair is not in the mean."""
    if place in by_hand:
        return f"{BY_HAND}: {by_hand[place]}"
    repeat = results[place]
    if not repeat.valid:
        return f"{repeat.status.value}{': ' + repeat.reason if repeat.reason else ''}"
    other = place ^ 1
    if other in by_hand or other >= len(results) or not results[other].valid:
        return OTHER_HALF
    return of_pair


def _together(judgements: Sequence[Judgement]) -> Judgement:
    """Return the judgement of both directions: the drift of their mean, the bound of the less steady one."""
    made = [judgement for judgement in judgements if judgement.made]
    flags = joined(flag for judgement in judgements for flag in flags_in(judgement.flags))
    if len(made) < 2:
        return replace(made[0] if made else NOT_JUDGED, flags=flags)
    forward, backward = made
    return Judgement(
        drift_percent=0.5 * (forward.drift_percent + backward.drift_percent),
        drift_error_percent=0.5 * hypot(forward.drift_error_percent, backward.drift_error_percent),
        drift_bound_percent=max(forward.drift_bound_percent, backward.drift_bound_percent),
        per_kelvin_percent=0.5 * (forward.per_kelvin_percent + backward.per_kelvin_percent),
        repeat_windows=0.5 * (forward.repeat_windows + backward.repeat_windows),
        trend_percent=0.5 * (forward.trend_percent + backward.trend_percent),
        flags=flags,
    )


EACH: Final = Scheme()
PAIRS: Final = OppositePairs()


def scheme_of(*, both_directions: bool) -> Scheme:
    """Return how repeats make values."""
    return PAIRS if both_directions else EACH


@dataclass(frozen=True, slots=True)
class Misalignment:
    """An apparent angle of the load cell's axes and its standard uncertainty, degrees, with the degrees of freedom and
    the number of pairs.

    Crosstalk between load and friction looks the same, and is part of it: the angle is the budget's misalignment and
    crosstalk together. It corrects nothing; coefficients from both directions are free of it.
    """

    deg: float = NAN
    standard_deg: float = NAN
    df: int = 0
    pairs: int = 0

    @property
    def expanded_deg(self) -> float:
        """Return the expanded uncertainty (95 %), degrees; NaN where no scatter is known."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, float(self.df)) * self.standard_deg if self.df else NAN


NOT_KNOWN = Misalignment()


def misalignment(results: Iterable[ConditionResult]) -> Misalignment:
    """Return the angle pooled over conditions; those without a value, or of one direction, are ignored.

    Half the sum of a pair's signed coefficients is theta (1 + mu^2) (``tester.analysis.directions``). One condition of
    three pairs resolves it to some 0.2 degrees, because repeats differ by 2 %; so it is pooled over the session, in
    which the cell is not moved. Each condition weighs by its uncertainty, for which the relative scatter between pairs
    is pooled:

      u_i = s mu_i / ((1 + mu_i^2) sqrt(n_i)),      theta = sum(theta_i / u_i^2) / sum(1 / u_i^2),
      u^-2 = sum u_i^-2
    """
    valued = [
        (result.mu_resultant, result.both_ways) for result in results if result.ok and result.both_ways is not None
    ]
    valued = [(mu, ways) for mu, ways in valued if mu > 0.0]
    if not valued:
        return NOT_KNOWN
    df = sum(ways.pairs - 1 for _, ways in valued)
    squares = sum((ways.pairs - 1) * (ways.half_sum_s / mu) ** 2 for mu, ways in valued if isfinite(ways.half_sum_s))
    weights = [ways.pairs * ((1.0 + mu * mu) / mu) ** 2 for mu, ways in valued]
    angles = [ways.half_sum / (1.0 + mu * mu) for mu, ways in valued]
    angle = sum(w * a for w, a in zip(weights, angles, strict=True)) / sum(weights)
    standard = sqrt(squares / df / sum(weights)) if df else NAN
    return Misalignment(degrees(angle), degrees(standard), df, sum(ways.pairs for _, ways in valued))
