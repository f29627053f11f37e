"""Whether two coefficients differ: common errors drop out, pieces and repeats stay."""

from __future__ import annotations

from math import hypot, inf, isnan, sqrt

import pytest

from tester.analysis.difference import Difference, difference, pieces_needed
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import ConditionStatus
from tester.analysis.uncertainty import Contribution, budget, contribution


def result(mu: float, *terms: Contribution) -> ConditionResult:
    return ConditionResult(ConditionStatus.OK, mu_resultant=mu, compound_budget=budget(terms))


def repeats(u: float, df: float = inf) -> Contribution:
    return contribution("repeatability", u, 1.0, df=df)


def chain(u: float, sensitivity: float = 1.0) -> Contribution:
    return contribution("cell", u, sensitivity, common="rig")


def test_a_common_error_drops_out_on_one_rig() -> None:
    found = difference(result(0.7, chain(0.5), repeats(0.03)), result(0.8, chain(0.5), repeats(0.04)), same_rig=True)
    assert (found.value, found.standard) == (pytest.approx(0.1), pytest.approx(0.05))


def test_on_different_rigs_every_error_counts_twice() -> None:
    found = difference(result(0.7, chain(0.5), repeats(0.03)), result(0.8, chain(0.5), repeats(0.04)), same_rig=False)
    assert found.standard == pytest.approx(hypot(0.5, 0.5, 0.03, 0.04))


def test_unequal_effects_of_a_common_error_stay() -> None:
    one, other = result(0.7, chain(0.01, 2.0), repeats(0.0)), result(0.8, chain(0.01, -1.0), repeats(0.0))
    assert difference(one, other, same_rig=True).standard == pytest.approx(0.03)


def test_an_error_that_only_one_has_counts() -> None:
    one, other = result(0.7, chain(0.04), repeats(0.0)), result(0.8, repeats(0.03))
    assert difference(one, other, same_rig=True).standard == pytest.approx(0.05)
    assert difference(other, one, same_rig=True).standard == pytest.approx(0.05)


def test_the_degrees_of_freedom_are_those_of_the_remaining_terms() -> None:
    found = difference(result(0.7, chain(9.0), repeats(0.03, 4)), result(0.8, chain(9.0), repeats(0.03, 4)),
                       same_rig=True)  # fmt: skip
    assert found.df == pytest.approx(8.0) and found.coverage == pytest.approx(2.306, abs=1e-3)


@pytest.mark.parametrize(("value", "apart"), [(0.11, False), (-0.11, False), (0.12, True), (-0.12, True)])
def test_a_difference_beyond_its_coverage_is_reported(value: float, apart: bool) -> None:
    assert Difference(value, 0.05, 8.0).told_apart is apart


def test_without_a_coefficient_there_is_no_difference() -> None:
    found = difference(result(0.7, repeats(0.03)), ConditionResult(ConditionStatus.PENDING), same_rig=True)
    assert isnan(found.value) and not found.told_apart


def test_ten_percent_take_three_pieces_each_and_half_of_it_four_times_as_many() -> None:
    assert pieces_needed(10.0, 3.0, 2.0 / sqrt(3.0)) == 3
    assert pieces_needed(5.0, 3.0, 2.0 / sqrt(3.0)) == 9
    assert pieces_needed(100.0, 3.0, 1.0) == 1
