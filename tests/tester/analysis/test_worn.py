"""Wear of a piece when a condition was measured on it, and its uncertainty from the checks."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isnan, nan, pi

import pytest

from tester.analysis.wear_rate import TOUCH, Worn, condition_wear, wear_rate
from tests.tester.analysis.test_wear_rate import FIRST

U = FIRST.u_mm
NEW = replace(FIRST, t_s=10.0, reference_s=10.0, diameter_mm=90.0, sliding_m=0.0, exposure_n_m=0.0, before=0)
"""As it was mounted."""
AFTER_GRINDING = replace(NEW, t_s=500.0, diameter_mm=89.8, expected_mm=89.9, sliding_m=50.0, exposure_n_m=1e4, before=1)
AFTER_ONE = replace(
    NEW, t_s=900.0, diameter_mm=89.6, expected_mm=89.63, sliding_m=100.0, exposure_n_m=2e4, before=2, after=1
)
WORN = Worn(90.0, 89.6, 100.0, (NEW, AFTER_GRINDING, AFTER_ONE))


def test_without_a_check_the_loss_is_the_estimate_at_that_time_not_at_the_end() -> None:
    piece = Worn(90.0, 88.0, 400.0)
    assert piece.size(100.0).loss_mm == pytest.approx(0.5)
    assert piece.size(400.0).loss_mm == pytest.approx(2.0)
    assert isnan(piece.size(100.0).checked_u_mm)


def test_a_record_without_sliding_distances_has_the_loss_of_its_end() -> None:
    assert Worn(90.0, 88.0, 400.0).size(nan).loss_mm == pytest.approx(2.0)


def test_between_two_checks_the_diameter_is_interpolated_over_the_sliding() -> None:
    assert WORN.size(75.0).size_mm == pytest.approx(89.7)
    assert WORN.size(90.0).size_mm == pytest.approx(89.64)


def test_the_error_of_the_estimate_at_the_next_check_is_in_the_uncertainty_in_proportion() -> None:
    apart = hypot(U, 0.5 * U, 0.5 * U, 0.5 * 0.03)  # the series' first check, both checks by halves, half of the error
    assert WORN.size(75.0).checked_u_mm == pytest.approx(apart)
    assert WORN.size(50.0).checked_u_mm == pytest.approx(hypot(U, U))


def test_a_record_without_estimates_gets_the_whole_loss_between_checks_as_uncertainty() -> None:
    unsaid = replace(WORN, checks=(NEW, AFTER_GRINDING, replace(AFTER_ONE, expected_mm=nan)))
    assert unsaid.size(75.0).checked_u_mm == pytest.approx(hypot(U, 0.5 * U, 0.5 * U, 0.5 * 0.2))


def test_after_the_last_check_the_rate_that_the_checks_have_shown_counts() -> None:
    piece = replace(WORN, last_mm=89.2, last_m=200.0)
    found = piece.size(200.0)
    assert found.loss_mm == pytest.approx(0.8)
    rate_share = (found.checked_u_mm**2 - 2.0 * U**2) ** 0.5 / 0.4
    assert 0.015 < rate_share < 0.1


def test_after_a_single_check_all_that_is_believed_to_be_worn_off_since_is_uncertain() -> None:
    piece = Worn(90.0, 89.2, 200.0, (NEW,))
    assert piece.size(100.0).loss_mm == pytest.approx(0.4)
    assert piece.size(100.0).checked_u_mm == pytest.approx(0.4)


def test_a_series_that_began_on_a_worn_piece_carries_the_loss_estimated_before_it() -> None:
    late = replace(NEW, diameter_mm=89.5, sliding_m=50.0, exposure_n_m=1e4)
    assert Worn(90.0, 89.5, 50.0, (late,)).size(50.0).checked_u_mm == pytest.approx(0.5)


def test_the_rate_of_a_series_gives_the_loss_before_it() -> None:
    late = replace(NEW, diameter_mm=89.9, sliding_m=50.0, exposure_n_m=1e4)
    checks = tuple(
        replace(late, t_s=10.0 + i, diameter_mm=89.9 - 0.3 * i, sliding_m=50.0 * (i + 1), exposure_n_m=1e4 * (i + 1))
        for i in range(4)
    )
    found = Worn(90.0, 89.0, 200.0, checks).size(50.0)
    assert found.checked_u_mm == pytest.approx(0.2, rel=0.05)  # 0.3 mm before it, and 0.1 mm assumed


def test_a_remounted_wheel_keeps_the_results_of_its_earlier_checks() -> None:
    again = replace(AFTER_ONE, t_s=2000.0, reference_s=2000.0, expected_mm=nan, exposure_n_m=0.0)
    found = replace(WORN, checks=(*WORN.checks, again)).size(100.0)
    assert found.checked_u_mm == pytest.approx(hypot(U, U), rel=1e-6)


def test_a_check_that_was_not_believed_is_no_check() -> None:
    unused = tuple(replace(one, used=0) for one in WORN.checks)
    assert isnan(replace(WORN, checks=unused).size(75.0).checked_u_mm)


def test_a_check_of_a_later_series_does_not_end_an_interval() -> None:
    other = replace(AFTER_ONE, reference_s=800.0)
    piece = Worn(90.0, 89.4, 100.0, (NEW, AFTER_GRINDING, other))
    assert piece.size(75.0).loss_mm == pytest.approx(0.2 + 0.5 * 0.4)


def test_a_check_by_a_person_has_its_own_zero() -> None:
    person = replace(NEW, method="person", diameter_mm=89.5, sliding_m=50.0)
    assert Worn(90.0, 89.5, 50.0, (person,)).size(50.0).checked_u_mm == pytest.approx(U)


TOUCHED = replace(
    FIRST, method=TOUCH, diameter_mm=88.8, u_mm=0.1, expected_mm=89.0, sliding_m=50.0, exposure_n_m=1e4,
    u_rate_percent=20.0,
)  # fmt: skip


def test_the_size_by_a_touch_is_the_one_in_use_with_the_uncertainty_of_the_touch_and_of_the_wear_since() -> None:
    found = Worn(90.0, 88.5, 100.0, (TOUCHED,)).size(100.0)
    assert found.size_mm == pytest.approx(88.5) and found.source == "touches of the wheel before it"
    assert found.checked_u_mm == pytest.approx(hypot(0.1, 0.2 * 0.5))


def test_touches_give_the_mean_rate_since_the_wheel_was_new_and_no_rate_of_a_condition() -> None:
    found = wear_rate([TOUCHED], 90.0)
    volume_mm3 = 0.25 * pi * 30.0 * (90.0**2 - 88.8**2)
    assert found.rate == pytest.approx(volume_mm3 / 1e4)
    assert found.standard == pytest.approx(0.5 * pi * 30.0 * 88.8 * 0.1 / 1e4)
    assert condition_wear([replace(TOUCHED, before=1), replace(TOUCHED, after=1)], 1) is None
