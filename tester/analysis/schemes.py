"""How a condition's repeats make its values: each repeat by itself, or each pair of repeats that slide opposite ways.

Code that measures, stores and shows a condition calls a scheme and need not know which.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import hypot
from typing import Final, Protocol

from tester.analysis.blocks import Block
from tester.analysis.change import change_of, greatest
from tester.analysis.closest import Combining
from tester.analysis.counts import PAIRS as COUNTED
from tester.analysis.directions import as_pairs, both_ways, halves, is_reversed
from tester.analysis.flags import flags_in, joined
from tester.analysis.judge import judge
from tester.analysis.repeats import (
    BY_HAND,
    REPEATABILITY,
    ConditionResult,
    Exclusion,
    combine_repeats,
    counting,
    with_coefficient,
)
from tester.analysis.results import NOT_JUDGED, ConditionStatus, Judgement, RepeatResult

_NOTHING: Final[Mapping[int, str]] = {}
OTHER_HALF: Final = "the other repeat of its pair does not count"
HALF: Final = "the other repeat of its pair is not made"


class Scheme(Protocol):
    """Turns a condition's repeats, in order, into its values."""

    repeats_each: int
    """Repeats behind one value."""

    def valid(self, results: Sequence[RepeatResult]) -> int:
        """Return the number of values from valid repeats."""
        ...

    def values(self, results: Sequence[RepeatResult]) -> list[float]:
        """Return the coefficients that count."""
        ...

    def judge(
        self,
        results: Sequence[RepeatResult],
        blocks: Sequence[Sequence[Block]],
        planned: int,
        revolutions: float | None,
        seconds: float | None,
    ) -> tuple[list[RepeatResult], Judgement]:
        """Return repeats as judged, and the judgement on all of them (``tester.analysis.judge``)."""
        ...

    def combine(
        self,
        results: Sequence[RepeatResult],
        planned: int,
        min_valid: int = 3,
        ended: ConditionStatus | None = None,
        reason: str = "",
        *,
        judged: Judgement = NOT_JUDGED,
        by_hand: Mapping[int, str] = _NOTHING,
        combining: Combining = "mean",
    ) -> ConditionResult:
        """Return the condition's result (``tester.analysis.repeats``)."""
        ...


class EachRepeat:
    """Each repeat is a value."""

    repeats_each = 1

    judge = staticmethod(judge)
    combine = staticmethod(combine_repeats)

    def valid(self, results: Sequence[RepeatResult]) -> int:
        """Return how many repeats are valid."""
        return sum(result.valid for result in results)

    def values(self, results: Sequence[RepeatResult]) -> list[float]:
        """Return the coefficients of the repeats that count."""
        return [results[i].mu_resultant for i in counting(results)]


class OppositePairs:
    """A value is half the difference of a repeat in the requested direction and a reversed one; planned and least are
    pairs.

    A pair counts only if both its repeats do. Another pair makes up for it, so both directions keep the same number of
    repeats. Each direction has a drift of its own.
    """

    repeats_each = 2

    def valid(self, results: Sequence[RepeatResult]) -> int:
        """Return how many whole pairs are valid."""
        return sum(pair.valid for pair in as_pairs(results, whole=True))

    def values(self, results: Sequence[RepeatResult]) -> list[float]:
        """Return the coefficients of the pairs that count."""
        pairs = as_pairs(results, whole=True)
        return [pairs[i].mu_resultant for i in counting(pairs)]

    def judge(
        self,
        results: Sequence[RepeatResult],
        blocks: Sequence[Sequence[Block]],
        planned: int,
        revolutions: float | None,
        seconds: float | None,
    ) -> tuple[list[RepeatResult], Judgement]:
        """Judge each direction by its own repeats; return all of them, and the common judgement."""
        judged, judgements = list(results), list[Judgement]()
        for backward in (False, True):
            places = [i for i in range(len(results)) if is_reversed(i + 1) == backward]
            if not places:
                continue
            repeats, judgement = judge([results[i] for i in places], [blocks[i] for i in places], planned, revolutions,
                                   seconds)  # fmt: skip
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
        by_hand: Mapping[int, str] = _NOTHING,
        combining: Combining = "mean",
    ) -> ConditionResult:
        """Return the result of a condition from its pairs; ``by_hand`` and the exclusions are places of repeats."""
        pairs = as_pairs(results, whole=ended is None)
        hands = {place // 2: why for place, why in by_hand.items() if place // 2 < len(pairs)}
        result = combine_repeats(pairs, planned, min_valid, ended, reason, judged=judged, by_hand=hands,
                                combining=combining, changed_percent=_changed(results, by_hand),
                                counted=COUNTED)  # fmt: skip
        out = {exclusion.position: exclusion.reason for exclusion in result.excluded}
        kept = [halves(results, pair) for pair in range(len(pairs)) if pair not in out]
        kept = [(a, b) for a, b in kept if max(a, b) < len(results)]
        excluded = [
            Exclusion(place, _why(results, place, out[pair], by_hand))
            for pair in sorted(out)
            for place in sorted(halves(results, pair))
            if place < len(results)
        ]
        half = range(2 * len(pairs), len(results))
        excluded += [Exclusion(place, _why(results, place, HALF, by_hand)) for place in half]
        return replace(
            result,
            excluded=tuple(excluded),
            flagged=tuple(place for pair in result.flagged for place in sorted(halves(results, pair))),
            both_ways=both_ways([(results[a], results[b]) for a, b in kept]) if kept else None,
        )


def _changed(results: Sequence[RepeatResult], by_hand: Mapping[int, str]) -> float:
    """Return the greatest sudden change within one direction: misaligned axes separate the two, whatever friction
    does."""
    ways = (
        [result for i, result in enumerate(results) if is_reversed(i + 1) == backward and i not in by_hand]
        for backward in (False, True)
    )
    return greatest(change_of(with_coefficient(way), REPEATABILITY) for way in ways)


def _why(results: Sequence[RepeatResult], place: int, of_pair: str, by_hand: Mapping[int, str]) -> str:
    """Return why a repeat of a pair that does not count is not in the mean."""
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


EACH: Final[Scheme] = EachRepeat()
PAIRS: Final[Scheme] = OppositePairs()


def scheme_of(*, both_directions: bool) -> Scheme:
    """Return how repeats make values."""
    return PAIRS if both_directions else EACH
