"""Repeats needed for a precision, and precisions that cannot be reached."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import pytest

from tester.analysis.quantiles import t_quantile
from tester.analysis.uncertainty import Pool
from tester.inputs.recipe.foreseen import Foreseen, foreseen
from tester.inputs.recipe.grid_settings import LEAST_REPEATS, settings_of
from tester.inputs.recipe.plan import Plan, Settings
from tester.inputs.recipe.precision import (
    PrecisionError,
    floor_percent,
    precision_lines,
    s_percents,
    until_for_total,
    with_precision,
)
from tester.inputs.recipe.repeats_section import MADE_UP, expected, needed, reached_percent
from tester.inputs.recipe.time_estimate import estimate
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, rig


def settings(**changes: object) -> Settings:
    read = recipe(SMALL)
    assert read.measure is not None
    return replace(settings_of(read.measure, read.grids[0]), **changes)


@pytest.mark.parametrize(("until", "s"), [(2.0, 2.0), (1.0, 2.0), (3.0, 5.0)])
def test_the_repeats_needed_reach_the_precision_and_one_fewer_does_not(until: float, s: float) -> None:
    n = needed(until, s, 10)
    assert t_quantile(0.975, 10.0 + n - 1) * s / sqrt(n) <= until
    assert t_quantile(0.975, 10.0 + n - 2) * s / sqrt(n - 1) > until


def test_early_in_a_run_a_precision_takes_more() -> None:
    assert needed(2.0, 2.0, 0) > needed(2.0, 2.0, 30)


def test_fewer_than_four_repeats_never_count_as_precise() -> None:
    assert needed(50.0, 0.1) == LEAST_REPEATS


def test_a_share_of_the_repeats_is_made_up_for() -> None:
    assert expected(settings(repeats=5, at_most=10), 2.0) == pytest.approx(5.0 * (1.0 + MADE_UP))


def test_repeats_judged_alone_are_not_made_up_for() -> None:
    assert expected(settings(repeats=2, at_most=4), 2.0) == 2.0


def test_at_most_bounds_the_expected_repeats() -> None:
    how = settings(repeats=3, at_most=6, until_percent=0.5)
    assert expected(how, 2.0) == 6.0
    assert reached_percent(how, 2.0) > 0.5


def test_a_precision_makes_a_plan_longer() -> None:
    usual, precise = recipe(PREPARED), with_precision(recipe(PREPARED), 1.0)
    plan = expand(precise, rig())
    figures = PART.estimate(plan, rig())
    assert all(step.until_percent == 1.0 for step in plan.conditions())
    assert figures.rig_seconds > PART.estimate(expand(usual, rig()), rig()).rig_seconds + 600.0
    assert figures.rig_seconds_low < figures.rig_seconds < figures.rig_seconds_high


def test_stored_repeats_count() -> None:
    def repeats(pools: dict[str, Pool]) -> float:
        estimator = WheelEstimator(rig(), repeatability=s_percents(pools))
        plan = expand(with_precision(recipe(PREPARED), 2.0), rig(), estimator)
        return sum(one.repeats for one in estimate(plan, estimator).steps)

    steady, loose = Pool(20 * 0.01**2, 20), Pool(20 * 0.04**2, 20)
    assert repeats({"1#": steady}) < repeats({}) < repeats({"1#": loose})


def lines(pools: dict[str, Pool]) -> str:
    estimator = WheelEstimator(rig(), repeatability=s_percents(pools))
    plan = expand(with_precision(recipe(PREPARED), 2.0), rig(), estimator)
    figures = estimate(plan, estimator)
    return "\n".join(precision_lines(plan, figures, estimator, pools, foreseen(plan, figures.steps, estimator)))


def test_the_plan_states_the_source_of_the_deviation() -> None:
    assert "1#: s = 2 % between repeats, assumed: nothing is stored" in lines({})
    stored = lines({"1#": Pool(20 * 0.015**2, 20)})
    assert "1#: s = 1.5 % between repeats, 20 degrees of freedom in stored runs" in stored


def test_a_plan_without_a_precision_does_not_mention_it() -> None:
    plan = small_plan()
    estimator = WheelEstimator(rig())
    assert list(precision_lines(plan, estimate(plan, estimator), estimator, {}, small())) == []


def small_plan() -> Plan:
    return expand(recipe(PREPARED), rig())


def small() -> list[Foreseen]:
    estimator, plan = WheelEstimator(rig()), small_plan()
    return foreseen(plan, estimator.walk(plan), estimator)


def test_a_total_below_that_of_the_instruments_is_refused_by_its_largest_term() -> None:
    highest = max(small(), key=floor_percent)
    largest = max(highest.instruments.contributions, key=lambda one: one.standard).name
    told = f"{floor_percent(highest):.2f} % from the instruments .* of which {largest}"
    with pytest.raises(PrecisionError, match=told):
        until_for_total(0.9 * floor_percent(highest), small())


def test_a_total_leaves_the_remainder_to_the_repeats() -> None:
    highest = max(map(floor_percent, small()))
    until = until_for_total(highest + 1.0, small())
    assert until**2 + highest**2 == pytest.approx((highest + 1.0) ** 2)
