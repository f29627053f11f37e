"""The closest two of three repeats, where a recipe asks for it by name; and counts of repeats."""

from __future__ import annotations

from math import sqrt
from random import Random
from statistics import fmean, pstdev

import pytest

from tester.analysis import left_out
from tester.analysis.flags import CLOSEST_TWO, flags_in
from tester.analysis.left_out import Counts, combining_of, make_ups_of, taken
from tester.analysis.repeats import ConditionResult, combine_repeats, combine_replicates
from tester.analysis.results import ConditionStatus, RepeatResult, RepeatStatus
from tester.analysis.schemes import PAIRS
from tests.tester.analysis.test_repeats import repeat
from tests.tester.store.build import result

THREE = (0.80, 0.70, 0.72)


def combined(*values: float, by_hand: dict[int, str] | None = None) -> ConditionResult:
    repeats = [result(value) for value in values]
    return combine_repeats(repeats, len(values), by_hand=by_hand or {}, combining="paper")


def test_the_mean_is_that_of_the_closest_two() -> None:
    assert combined(*THREE).mu_resultant == pytest.approx(0.71)
    assert combined(*THREE).mu_longitudinal == pytest.approx(0.71)
    assert CLOSEST_TWO in flags_in(combined(*THREE).flags)


def test_without_its_name_nothing_changes() -> None:
    plain = combine_repeats([result(value) for value in THREE], 3)
    assert plain.mu_resultant == pytest.approx(0.74) and CLOSEST_TWO not in flags_in(plain.flags)


def test_the_scatter_stays_that_of_all_and_the_mean_is_less_certain() -> None:
    plain, paper = combine_repeats([result(value) for value in THREE], 3), combined(*THREE)
    assert paper.s == plain.s and paper.n_valid == 3
    assert paper.type_a == pytest.approx(0.798 * sqrt(3.0) * plain.type_a)


def test_where_both_distances_are_the_same_all_three_count() -> None:
    assert taken((1.0, 3.0, 2.0), "paper") == [0, 1, 2]


@pytest.mark.parametrize("values", [(0.7, 0.8), (0.70, 0.71, 0.8, 0.9)])
def test_another_number_of_repeats_has_the_mean_of_all(values: tuple[float, ...]) -> None:
    assert combined(*values).mu_resultant == pytest.approx(fmean(values))


def test_a_repeat_that_a_person_left_out_is_none_of_the_three() -> None:
    assert combined(*THREE, by_hand={1: "slipped"}).mu_resultant == pytest.approx(0.76)


def test_how_much_the_mean_of_the_closest_two_scatters() -> None:
    random = Random(1)
    means: list[float] = []
    for _ in range(40_000):
        values = [random.gauss(0.0, 1.0) for _ in range(3)]
        means.append(fmean(values[i] for i in taken(values, "paper")))
    assert pstdev(means) == pytest.approx(left_out.CLOSEST_STANDARD, abs=0.012)


def test_the_run_states_how_its_repeats_are_combined() -> None:
    assert combining_of({"combine": "paper"}) == "paper"
    assert combining_of({}) == combining_of({"combine": "other"}) == "mean"


GOOD = repeat(0.70)
REFUSED = repeat(0.80, status=RepeatStatus.REFUSED)


def test_left_out_repeats_are_made_minus_valid() -> None:
    assert Counts(3, 5, 3).left_out == 2


@pytest.mark.parametrize(
    ("asked", "made", "refused", "found"),
    [
        (3, 3, (), ()),
        (3, 4, (1,), (3,)),
        (3, 5, (), ()),  # for precision: none was refused
        (3, 5, (1,), (3,)),  # one replacement, one more for precision
        (3, 5, (3,), (4,)),  # the fourth was for precision, the fifth replaces it
        (3, 6, (0, 3), (3, 4)),  # a refused make-up gets its own make-up
        (3, 2, (0,), ()),  # stopped before anything was made up
    ],
)
def test_a_make_up_replaces_a_refused_repeat(
    asked: int, made: int, refused: tuple[int, ...], found: tuple[int, ...]
) -> None:
    assert make_ups_of(asked, made, refused) == found


def counts(*results: RepeatResult, by_hand: dict[int, str] | None = None) -> Counts:
    return combine_repeats(results, 3, ended=ConditionStatus.OK, by_hand=by_hand or {}).counts


def test_a_plain_condition_has_as_many_valid_as_asked() -> None:
    assert counts(GOOD, GOOD, GOOD) == Counts(3, 3, 3)


def test_a_short_condition_lacks_make_ups() -> None:
    assert counts(GOOD, REFUSED, GOOD) == Counts(3, 3, 2)


def test_a_repeat_excluded_by_a_person_has_no_make_up() -> None:
    assert counts(GOOD, GOOD, GOOD, GOOD, by_hand={0: "dust"}) == Counts(3, 4, 3)


def test_a_make_up_stays_one_when_a_person_excludes_the_replaced_repeat() -> None:
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


def test_replicates_are_the_counted_repeats_of_their_row() -> None:
    measured = combine_repeats([GOOD] * 3, 3)
    failed = combine_repeats([REFUSED] * 3, 3, ended=ConditionStatus.OK)
    waiting = combine_repeats([], 3)
    found = combine_replicates([measured, measured, failed, waiting]).counts
    assert found == Counts(4, 3, 2, of="replicates")
