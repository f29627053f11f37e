"""Two measurands: this piece in this condition, and the compound."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isnan, nan, sqrt

import pytest

from tester.analysis.flags import CARRY_OVER
from tester.analysis.kelvin import Slope, SurfaceWarmth
from tester.analysis.measurand import (
    BETWEEN,
    REPEATABILITY,
    Surroundings,
    pooled,
    repeatability,
    with_budget,
    with_budget_of_replicates,
)
from tester.analysis.reference import COUNTERFACE, CounterfaceDrift
from tester.analysis.repeats import ConditionResult, combine_repeats, combine_replicates
from tester.analysis.results import Judgement, RepeatResult, RepeatStatus
from tester.analysis.terms import Size
from tester.analysis.uncertainty import Budget, Pool
from tester.kinds.wheel_on_belt.budget import TERMS
from tests.tester.analysis.series import means_of

MEANS = means_of(force_z_n=200.0, slip_m_s=0.3, surface_c=26.0, wheel_speed_m_s=0.8, belt_speed_m_s=0.5)
BY = Surroundings(
    TERMS, Pool(12 * 0.02**2, 12), SurfaceWarmth(25.0, 26.0, 0.0, Slope(0.01, 0.002, "tried")), Size(90.0)
)


def condition(*values: float, judged: Judgement | None = None) -> ConditionResult:
    repeats = [RepeatResult(RepeatStatus.VALID, mu_resultant=mu, fluctuation_percent=1.0, batches=10, means=MEANS)
               for mu in values]  # fmt: skip
    return combine_repeats(repeats, len(values), judged=judged or Judgement())


THREE = condition(0.69, 0.70, 0.71)


def standard(budget: Budget, name: str) -> float:
    (found,) = [one.standard for one in budget.contributions if one.name == name]
    return found


def test_the_repeatability_is_the_run_s_over_the_root_of_the_repeats() -> None:
    found = repeatability(THREE, BY.pool)
    assert (found.standard, found.df) == (pytest.approx(0.70 * 0.02 / sqrt(3.0)), 12.0)


def test_the_mean_of_the_closest_two_of_three_is_less_sure_than_that_of_all() -> None:
    closest = replace(THREE, type_a=0.798 * THREE.s)
    assert repeatability(closest, BY.pool).standard == pytest.approx(0.70 * 0.02 * 0.798)


def test_a_condition_that_scatters_by_far_more_than_the_run_has_its_own_repeatability() -> None:
    wild = condition(0.60, 0.70, 0.80)
    found = repeatability(wild, BY.pool)
    assert (found.standard, found.df) == (pytest.approx(0.1 / sqrt(3.0)), 2.0)


def test_a_run_of_one_condition_has_that_one_s_repeatability() -> None:
    found = repeatability(THREE, pooled([THREE]))
    assert (found.standard, found.df) == (pytest.approx(THREE.type_a), 2.0)


def test_one_repeat_of_a_run_that_repeats_others_has_the_run_s() -> None:
    assert repeatability(condition(0.7), BY.pool).standard == pytest.approx(0.7 * 0.02)
    assert isnan(repeatability(condition(0.7), Pool()).standard)


def test_the_pool_is_over_conditions_with_a_value() -> None:
    found = pooled([THREE, condition(0.5), condition(0.79, 0.81)])
    assert found.df == 3
    squares = 2 * (0.01 / 0.7) ** 2 + (0.0141421 / 0.8) ** 2
    assert found.s_percent == pytest.approx(100.0 * sqrt(squares / 3), rel=1e-5)


def test_the_compound_has_the_difference_from_piece_to_piece_and_this_piece_has_not() -> None:
    found = with_budget(THREE, BY)
    more = sqrt(found.compound_budget.standard**2 - found.budget.standard**2)
    assert more == pytest.approx(0.03 * 0.70)
    assert "wheel to wheel" not in {one.name for one in found.budget.contributions}


def test_the_budget_s_terms_add_in_squares() -> None:
    found = with_budget(THREE, BY).budget
    assert found.standard == pytest.approx(hypot(*(one.standard for one in found.contributions)))
    assert found.expanded == pytest.approx(found.coverage * found.standard)


def test_the_coefficient_is_given_at_the_nominal_temperature_beside_the_measured_one() -> None:
    found = with_budget(THREE, BY)
    assert (found.mu_resultant, found.mu) == (pytest.approx(0.70), pytest.approx(0.70 * 0.99005, rel=1e-5))


def test_the_uncertainty_of_the_sensitivity_is_a_term() -> None:
    assert standard(with_budget(THREE, BY).budget, "temperature sensitivity") == pytest.approx(
        0.70 * 0.002 * hypot(1.0, 1.0 / sqrt(3.0))
    )


def test_drift_and_carry_over_enter_the_uncertainty() -> None:
    drift = Judgement(drift_percent=-0.8, drift_error_percent=0.3, repeat_windows=1.5, trend_percent=6.0)
    found = with_budget(condition(0.69, 0.70, 0.71, judged=drift), BY).budget
    assert standard(found, "drift") == pytest.approx(0.70 * 0.011 * 1.5 / sqrt(12.0))
    assert standard(found, "carry-over") == 0.0
    carried = replace(drift, flags=CARRY_OVER)
    found = with_budget(condition(0.69, 0.70, 0.71, judged=carried), BY).budget
    assert standard(found, "carry-over") == pytest.approx(0.70 * 0.06 / sqrt(12.0))


DRIFT = CounterfaceDrift(-5e-5, 2e-5, 9.0, 100.0, 2100.0, 7, 7, apart=True)
WATCHED = replace(BY, drift=DRIFT, travel_m=1100.0)


def test_the_counterface_s_change_is_in_the_compound_s_uncertainty_and_not_in_this_piece_s() -> None:
    plain, found = with_budget(THREE, BY), with_budget(THREE, WATCHED)
    assert found.budget == plain.budget
    more = sqrt(found.compound_budget.standard**2 - plain.compound_budget.standard**2)
    assert more == pytest.approx(0.70 * 1000.0 * hypot(5e-5, 2e-5))


def test_a_condition_whose_travel_is_not_known_has_no_such_term() -> None:
    assert with_budget(THREE, replace(WATCHED, travel_m=nan)) == with_budget(THREE, BY)


def test_the_counterface_s_change_is_in_the_compound_s_uncertainty_of_replicates() -> None:
    each = [with_budget(condition(mu - 0.01, mu, mu + 0.01), WATCHED) for mu in (0.68, 0.70, 0.72)]
    found = with_budget_of_replicates(combine_replicates(each), each, WATCHED)
    assert standard(found.compound_budget, COUNTERFACE) == pytest.approx(0.70 * 1000.0 * hypot(5e-5, 2e-5))
    assert COUNTERFACE not in {one.name for one in found.budget.contributions}


def replicates(*values: float) -> ConditionResult:
    each = [with_budget(condition(mu - 0.01, mu, mu + 0.01), BY) for mu in values]
    return with_budget_of_replicates(combine_replicates(each), each, BY)


def test_replicates_have_the_repeatability_of_each_over_their_number() -> None:
    found = replicates(0.68, 0.70, 0.72)
    each = sqrt(sum((mu * 0.02 / sqrt(3.0)) ** 2 for mu in (0.68, 0.70, 0.72)))
    assert standard(found.budget, REPEATABILITY) == pytest.approx(each / 3.0)


def test_the_compound_of_replicates_has_the_scatter_between_them_weighed_with_the_stated_one() -> None:
    found = replicates(0.64, 0.70, 0.76).compound_budget
    s = sqrt((8 * 0.03**2 + 2 * (0.06 / 0.70) ** 2) / 10)
    assert standard(found, BETWEEN) == pytest.approx(0.70 * s / sqrt(3.0))
    names = {one.name for one in found.contributions}
    assert REPEATABILITY not in names and "wheel to wheel" not in names


def test_one_replicate_alone_has_the_stated_difference() -> None:
    each = [with_budget(THREE, BY), combine_repeats([], 3)]
    found = with_budget_of_replicates(combine_replicates(each), each, BY)
    assert standard(found.compound_budget, "wheel to wheel") == pytest.approx(0.03 * 0.70)


def test_a_rig_without_terms_has_repeats_alone_for_both() -> None:
    found = with_budget(THREE, Surroundings(pool=BY.pool))
    assert found.budget.standard == found.compound_budget.standard == pytest.approx(0.70 * 0.02 / sqrt(3.0))
    assert found.mu == found.mu_resultant


def test_without_a_pool_a_condition_has_its_own_repeatability() -> None:
    assert repeatability(THREE, Pool()).standard == pytest.approx(THREE.type_a)
