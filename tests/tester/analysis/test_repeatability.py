"""Repeatability pooled over conditions."""

from __future__ import annotations

from math import inf, sqrt

import pytest

from tester.analysis.repeatability import Pool


def test_deviations_of_conditions_are_pooled_as_shares_of_their_means() -> None:
    pool = Pool().with_condition([0.99, 1.01]).with_condition([1.96, 2.0, 2.04])
    assert pool.df == 3
    assert pool.s_percent == pytest.approx(100.0 * sqrt((2 * 0.01**2 + 2 * 0.02**2) / 3))


def test_the_expanded_repeatability_is_that_of_a_mean_of_n() -> None:
    pool = Pool(squares=4 * 0.02**2, df=4)
    assert pool.expanded_percent(4) == pytest.approx(2.776445 * 2.0 / 2.0, rel=1e-6)


def test_a_single_value_says_nothing_about_repeatability() -> None:
    assert Pool().with_condition([0.7]) == Pool()
    assert Pool().expanded_percent(5) == inf
