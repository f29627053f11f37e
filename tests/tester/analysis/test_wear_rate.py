"""The wear rate from checks of the diameter: rate, uncertainty, refusals."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, pi, sqrt

import numpy as np
import pytest

from tester.analysis.wear_rate import WearCheck, condition_wear, wear_rate

FIRST = WearCheck(
    piece=1, method="roll", t_s=100.0, reference_s=100.0, before=1, after=0, diameter_mm=90.0, u_mm=0.008,
    rubber_c=40.0, u_growth_mm_k=0.0017, press_mm=10.5, load_n=50.0, sliding_m=50.0, exposure_n_m=10_000.0,
    width_mm=30.0, u_rate_percent=1.5, used=1,
)  # fmt: skip
RATE = 0.08


def worn(number: int, *, rate: float = RATE, rubber_c: float = 40.0, off_mm: float = 0.0) -> WearCheck:
    """Return the check before condition ``number`` + 1, each condition having 3000 N m."""
    volume = rate * 3000.0 * number
    diameter = sqrt(90.0**2 - 4.0 * volume / (pi * 30.0))
    return replace(
        FIRST, t_s=100.0 + 300.0 * number, before=number + 1, after=number, diameter_mm=diameter + off_mm,
        exposure_n_m=10_000.0 + 3000.0 * number, rubber_c=rubber_c,
    )  # fmt: skip


def test_exact_checks_give_the_rate_that_wore_the_wheel() -> None:
    found = wear_rate([worn(i) for i in range(5)])
    assert found.rate == pytest.approx(RATE, rel=1e-6) and found.checks == 5 and found.resolved


def test_the_uncertainty_of_two_checks_is_that_of_their_difference() -> None:
    found = wear_rate([worn(0), worn(1)])
    volume = sqrt(2.0) * 0.008 * 0.5 * pi * 30.0 * 90.0
    assert found.standard == pytest.approx(sqrt((volume / 3000.0) ** 2 + (0.015 * RATE) ** 2), rel=2e-3)
    assert found.expanded == pytest.approx(2.0 * found.standard)


def test_more_checks_know_more() -> None:
    few, many = wear_rate([worn(0), worn(1)]), wear_rate([worn(i) for i in range(6)])
    assert many.standard < 0.4 * few.standard


def test_the_stated_interval_covers_the_rate_in_95_of_100() -> None:
    """Errors drawn as stated: alone for each check, shared for the growth with temperature."""
    draws = np.random.default_rng(1)
    covered = 0
    for _ in range(400):
        growth, scale = draws.normal(0.0, 0.0017), 1.0 + draws.normal(0.0, 0.015)
        temperatures = [40.0, 40.0, 55.0, 55.0, 70.0]
        checks = [
            worn(i, rate=RATE * scale, rubber_c=t, off_mm=draws.normal(0.0, 0.008) + growth * (t - 40.0))
            for i, t in enumerate(temperatures)
        ]
        found = wear_rate(checks)
        covered += abs(found.rate - RATE) <= found.expanded
    assert 0.93 * 400 <= covered <= 0.99 * 400


def test_a_difference_of_temperature_widens_the_interval() -> None:
    same = condition_wear([worn(0), worn(1)], 1)
    warmer = condition_wear([worn(0), worn(1, rubber_c=55.0)], 1)
    assert same is not None and warmer is not None
    assert warmer.u_mm == pytest.approx(sqrt(same.u_mm**2 + (15.0 * 0.0017) ** 2), rel=2e-3)


def test_a_condition_has_the_diameters_before_and_after_it() -> None:
    found = condition_wear([worn(0), worn(1), worn(2)], 2)
    assert found is not None
    assert (found.before_mm, found.after_mm) == (worn(1).diameter_mm, worn(2).diameter_mm)
    assert found.rate.rate == pytest.approx(RATE, rel=1e-3)


def test_a_loss_below_the_resolution_has_an_interval_that_contains_zero() -> None:
    found = condition_wear([worn(0, rate=0.01), worn(1, rate=0.01)], 1)
    assert found is not None and not found.rate.resolved


def test_rates_that_differ_between_conditions_widen_the_uncertainty_of_their_mean() -> None:
    even = wear_rate([worn(i) for i in range(5)])
    uneven = wear_rate([worn(i, off_mm=0.05 * (-1) ** i) for i in range(5)])
    assert uneven.standard > 2.0 * even.standard


def test_a_check_that_is_not_believed_counts_nowhere() -> None:
    wrong = replace(worn(1, off_mm=1.0), used=0)
    assert wear_rate([worn(0), wrong, worn(2)]).rate == pytest.approx(RATE, rel=1e-6)
    assert condition_wear([worn(0), wrong], 1) is None


def test_a_wheel_that_was_put_back_is_fitted_with_an_offset_of_its_own() -> None:
    later = [replace(worn(i, off_mm=0.4), reference_s=5000.0) for i in (2, 3, 4)]
    found = wear_rate([worn(0), worn(1), *later])
    assert found.rate == pytest.approx(RATE, rel=0.01) and found.checks == 5


def test_a_condition_across_two_series_has_no_value() -> None:
    assert condition_wear([worn(0), replace(worn(1), reference_s=400.0)], 1) is None


@pytest.mark.parametrize("checks", [[], [worn(0)], [worn(0), replace(worn(0), t_s=200.0, before=0, after=1)]])
def test_without_two_checks_and_sliding_between_them_there_is_no_rate(checks: list[WearCheck]) -> None:
    found = wear_rate(checks)
    assert isnan(found.rate) and not found.resolved
    one = condition_wear(checks, 1)
    assert one is None or isnan(one.rate.rate)
