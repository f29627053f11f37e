"""Counts of what was asked for, made, valid, left out and made up."""

from __future__ import annotations

import pytest

from tester.analysis.counts import Counts, make_ups_of
from tester.analysis.repeats import combine_repeats, combine_replicates
from tester.analysis.results import ConditionStatus, RepeatResult, RepeatStatus
from tester.analysis.schemes import PAIRS
from tests.tester.analysis.test_repeats import repeat

GOOD = repeat(0.70)
REFUSED = repeat(0.80, status=RepeatStatus.REFUSED)


def test_what_is_left_out_is_what_was_made_and_is_not_valid() -> None:
    assert Counts(3, 5, 3).left_out == 2


@pytest.mark.parametrize(
    ("asked", "made", "refused", "found"),
    [
        (3, 3, (), ()),
        (3, 4, (1,), (3,)),
        (3, 5, (), ()),  # for precision: none was refused
        (3, 5, (1,), (3,)),  # one in its place, one more for precision
        (3, 5, (3,), (4,)),  # the fourth was for precision, the fifth stands in its place
        (3, 6, (0, 3), (3, 4)),  # a make-up that was refused has one of its own
        (3, 2, (0,), ()),  # stopped before anything was made up
    ],
)
def test_a_make_up_stands_in_place_of_a_refused_one(
    asked: int, made: int, refused: tuple[int, ...], found: tuple[int, ...]
) -> None:
    assert make_ups_of(asked, made, refused) == found


def counts(*results: RepeatResult, by_hand: dict[int, str] | None = None) -> Counts:
    return combine_repeats(results, 3, ended=ConditionStatus.OK, by_hand=by_hand or {}).counts


def test_a_plain_condition_has_as_many_valid_as_asked() -> None:
    assert counts(GOOD, GOOD, GOOD) == Counts(3, 3, 3)


def test_a_short_condition_lacks_make_ups() -> None:
    assert counts(GOOD, REFUSED, GOOD) == Counts(3, 3, 2)


def test_what_a_person_leaves_out_is_left_out_and_has_no_make_up() -> None:
    assert counts(GOOD, GOOD, GOOD, GOOD, by_hand={0: "dust"}) == Counts(3, 4, 3)


def test_a_make_up_stays_one_when_a_person_leaves_out_what_it_stands_for() -> None:
    assert counts(GOOD, REFUSED, GOOD, GOOD, by_hand={1: "dust"}) == Counts(3, 4, 3, make_ups=(3,))


def test_the_paper_s_mean_leaves_one_of_three_out() -> None:
    three = [repeat(mu) for mu in (0.80, 0.70, 0.72)]
    found = combine_repeats(three, 3, combining="paper")
    assert found.counts == Counts(3, 3, 2)
    assert [one.position for one in found.excluded] == [0]


def test_pairs_count_as_pairs() -> None:
    found = PAIRS.combine([GOOD, GOOD, GOOD, REFUSED, GOOD, GOOD, GOOD, GOOD], 3, ended=ConditionStatus.OK)
    assert (found.counts, found.counts.left_out) == (Counts(3, 4, 3, make_ups=(3,), of="pairs"), 1)


def test_half_a_pair_of_a_stopped_run_is_in_no_count_and_in_no_mean() -> None:
    found = PAIRS.combine([GOOD, GOOD, GOOD], 3)
    assert found.counts == Counts(3, 1, 1, of="pairs") and found.reason == "1 of 3 pairs committed"
    assert [one.position for one in found.excluded] == [2]


def test_replicates_are_what_is_counted_of_the_row_that_stands_for_them() -> None:
    measured = combine_repeats([GOOD] * 3, 3)
    failed = combine_repeats([REFUSED] * 3, 3, ended=ConditionStatus.OK)
    waiting = combine_repeats([], 3)
    found = combine_replicates([measured, measured, failed, waiting]).counts
    assert found == Counts(4, 3, 2, of="replicates")
