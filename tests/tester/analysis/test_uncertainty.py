"""The budget after the GUM."""

from __future__ import annotations

from math import inf, isnan, sqrt

import pytest

from tester.analysis.uncertainty import Contribution, Pool, budget, contribution


def test_independent_contributions_add_in_squares() -> None:
    assert budget([Contribution("a", 0.3), Contribution("b", 0.4)]).standard == pytest.approx(0.5)


def test_known_contributions_are_covered_by_the_normal_factor() -> None:
    assert budget([Contribution("a", 0.3)]).coverage == pytest.approx(1.95996, rel=1e-5)


def test_effective_degrees_of_freedom_follow_welch_satterthwaite() -> None:
    found = budget([Contribution("a", 1.0, 4.0), Contribution("b", 1.0)])
    assert found.df == pytest.approx(16.0)
    assert found.expanded == pytest.approx(2.119905 * sqrt(2.0), rel=1e-5)


def test_a_single_contribution_has_its_own_degrees_of_freedom() -> None:
    assert budget([Contribution("a", 1.0, 4.0)]).coverage == pytest.approx(2.776445, rel=1e-6)


def test_a_contribution_without_a_value_leaves_the_budget_without_one() -> None:
    assert isnan(budget([Contribution("a", 1.0), Contribution("b", float("nan"))]).expanded)


def test_an_input_contributes_by_the_sensitivity_to_it_whatever_its_sign() -> None:
    assert contribution("a", 0.5, -0.2).standard == pytest.approx(0.1)


def test_shares_are_of_the_variance_and_sum_up_to_one() -> None:
    found = budget([Contribution("a", 0.3), Contribution("b", 0.4)])
    assert [found.share(one) for one in found.contributions] == pytest.approx([0.36, 0.64])


def test_no_contribution_at_all_is_no_uncertainty() -> None:
    assert (budget([]).standard, budget([]).df) == (0.0, inf)


def test_deviations_of_conditions_are_pooled_as_shares_of_their_means() -> None:
    pool = Pool().with_condition([0.99, 1.01]).with_condition([1.96, 2.0, 2.04])
    assert pool.df == 3
    assert pool.s_percent == pytest.approx(100.0 * sqrt((2 * 0.01**2 + 2 * 0.02**2) / 3))


def test_the_expanded_repeatability_is_that_of_a_mean_of_n() -> None:
    pool = Pool(squares=4 * 0.02**2, df=4)
    assert pool.expanded_percent(4) == pytest.approx(2.776445 * 2.0 / 2.0, rel=1e-6)


def test_a_single_value_gives_no_repeatability() -> None:
    assert Pool().with_condition([0.7]) == Pool()
    assert Pool().expanded_percent(5) == inf
