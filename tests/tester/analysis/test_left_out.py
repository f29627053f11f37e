"""The closest two of three repeats, where a recipe asks for it by name."""

from __future__ import annotations

from math import sqrt
from random import Random
from statistics import fmean, pstdev

import pytest

from tester.analysis import left_out
from tester.analysis.flags import CLOSEST_TWO, flags_in
from tester.analysis.left_out import combining_of, taken
from tester.analysis.repeats import ConditionResult, combine_repeats
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


def test_the_run_says_how_its_repeats_are_combined() -> None:
    assert combining_of({"combine": "paper"}) == "paper"
    assert combining_of({}) == combining_of({"combine": "other"}) == "mean"
