"""The budget after the GUM."""

from __future__ import annotations

from math import inf, isnan, radians, sqrt

import pytest

from tester.analysis.uncertainty import Contribution, Instruments, budget, friction_budget, instruments_of

NOTHING = Contribution("type A", 0.0)


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


def test_misalignment_is_the_largest_systematic_contribution() -> None:
    found = friction_budget(0.73, 200.0, 0.3, NOTHING)
    largest = max(found.contributions, key=lambda c: c.standard)
    assert largest.name == "axis misalignment"
    assert largest.standard == pytest.approx((1 + 0.73**2) * radians(0.5) / sqrt(3.0))


def test_perfect_instruments_leave_what_repeating_showed() -> None:
    perfect = Instruments(*[0.0] * 10)
    assert friction_budget(0.73, 200.0, 0.3, Contribution("type A", 0.01, 4.0), perfect).standard == pytest.approx(0.01)


def test_zero_slip_has_a_finite_budget() -> None:
    assert friction_budget(0.4, 200.0, 0.0, NOTHING).standard < 0.1


def test_no_load_has_no_budget() -> None:
    assert isnan(friction_budget(0.4, 0.0, 0.3, NOTHING).standard)


def test_settings_replace_defaults() -> None:
    assert instruments_of({"uncertainty.misalignment_deg": "0.2", "ambient": "23 degC"}).misalignment_deg == 0.2
    assert instruments_of() == Instruments()


@pytest.mark.parametrize("wrong", ["-1", "nan", "much"])
def test_a_setting_that_is_no_limit_is_refused(wrong: str) -> None:
    with pytest.raises(ValueError, match=r"uncertainty|convert"):
        instruments_of({"uncertainty.misalignment_deg": wrong})


def test_no_contribution_at_all_is_no_uncertainty() -> None:
    assert (budget([]).standard, budget([]).df) == (0.0, inf)
