"""What a plan takes: time, sliding, wear, heat."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import recipes
from tester.base.axes import Setpoint
from tester.inputs.recipe.time_estimate import Estimate, StepEstimate, estimate
from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.kinds.wheel_on_belt.recipe.constants import CONSTANTS, EstimateConstants
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator, predicted_loss_mm
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition, WheelPlan
from tester.kinds.wheel_on_belt.recipe.schema import wheel_settings
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, load_recipe, real_rig, recipe, rig, with_line


def planned(text: str, *overrides: str) -> tuple[WheelPlan, Estimate]:
    plan = expand(recipe(text), rig(*overrides))
    return plan, PART.estimate(plan, rig(*overrides))


def condition(
    setpoint: Setpoint, constants: EstimateConstants = CONSTANTS, text: str = SMALL, *overrides: str
) -> StepEstimate:
    read = recipe(text)
    assert read.measure is not None
    return WheelEstimator(rig(*overrides), constants).costs.of(setpoint, wheel_settings(read.measure, read.grids[0]))


MILD = AXES.setpoint("1#", slip_velocity=0.3, load=200.0, temperature=40.0)
HARD = AXES.setpoint("3#", slip_velocity=0.4, load=200.0, temperature=85.0)


def test_totals_are_the_sums_of_the_steps() -> None:
    plan, figures = planned(PREPARED)
    assert len(figures.steps) == len(plan.steps)
    assert figures.rig_seconds == pytest.approx(sum(one.seconds for one in figures.steps))
    assert figures.sliding_m == pytest.approx(sum(one.sliding_m for one in figures.steps))


def test_pre_grinding_slides_48_metres_and_wears_by_the_law() -> None:
    plan, figures = planned(PREPARED)
    ground = figures.steps[1]
    assert plan.steps[1].kind == "pre_grind"
    assert ground.sliding_m == pytest.approx(48.0)
    # V = k F s over the tread of a 90 x 30 mm wheel, on both sides of the diameter.
    assert ground.loss_mm == pytest.approx(2.0 * 0.08 * 200.0 * 48.0 / (math.pi * 90.0 * 30.0), rel=1e-9)
    assert 240.0 <= ground.seconds < 270.0


def test_the_default_quickstart_takes_about_45_minutes() -> None:
    plan = expand(load_recipe(recipes.find("quickstart"), PART).recipe, rig())
    assert 35 * 60 < PART.estimate(plan, rig()).rig_seconds < 60 * 60


def test_a_rest_lasts_as_long_as_it_must_cool() -> None:
    _, usual = planned(PREPARED)
    _, hot = planned(PREPARED, "observer.friction_heat_fraction=1")
    assert usual.steps[2].seconds == 1200.0
    assert hot.steps[2].seconds > 1200.0


def test_friction_heats_the_surface_with_the_square_root_of_time() -> None:
    # The plant's time constant: from equilibrium, 2 K take about 18 s with 1# at 200 N, 300 mm/s, 25 degC.
    costs = WheelEstimator(rig()).costs
    power = costs.mu("1#", 25.0, 200.0, 0.3, 0.0) * 200.0 * 0.3
    assert (2.0 / (costs.rise_k * power)) ** 2 == pytest.approx(18.0, rel=0.1)


def test_more_friction_needs_more_bursts() -> None:
    mild, hard = condition(MILD), condition(HARD)
    assert mild.bursts == 3  # each warms, and ends at half the window of 30 revolutions
    assert hard.bursts > 4
    assert hard.seconds > mild.seconds


def test_a_temperature_that_rises_through_the_band_within_a_turn_is_not_held() -> None:
    usual = condition(HARD)
    hot = condition(HARD, CONSTANTS, SMALL, "observer.friction_heat_fraction=0.5")
    assert usual.held
    assert not hot.held


def test_conditions_that_will_not_hold_are_named() -> None:
    text = SMALL.replace('"1#"', '"3#"').replace("300 mm/s", "400 mm/s").replace("[40 degC, 25 degC]", "85 degC")
    _, figures = planned(text, "observer.friction_heat_fraction=0.5")
    assert figures.not_held == (1, 2)


def test_rolling_takes_one_window_a_repeat_and_no_wear() -> None:
    rolling = condition(MILD.but(slip_velocity=0.0))
    assert (rolling.bursts, rolling.sliding_m, rolling.loss_mm) == (1, 0.0, 0.0)
    assert rolling.seconds > 5 * 30 * math.pi * 0.09 / 0.8


def test_sideslip_takes_longer_than_the_same_without() -> None:
    assert condition(MILD.but(sideslip=20.0)).seconds > 1.2 * condition(MILD).seconds


def test_braking_slides_as_far_as_driving() -> None:
    assert condition(MILD.but(slip_velocity=-0.3)).sliding_m > 0.0


def test_camber_alone_does_not_change_the_friction() -> None:
    straight, tilted = condition(MILD), condition(MILD.but(camber=5.0))
    assert tilted.friction_j / tilted.sliding_m == pytest.approx(straight.friction_j / straight.sliding_m, rel=1e-9)


def test_a_compound_without_a_model_is_estimated_with_a_round_coefficient_on_a_real_rig() -> None:
    costs = WheelEstimator(real_rig(), replace(CONSTANTS, unknown_mu=0.5)).costs
    assert costs.mu("EPDM", 40.0, 200.0, 0.3, 0.0) == 0.5
    assert costs.mu("1#", 40.0, 200.0, 0.3, 0.0) != 0.5


def test_a_simulated_rig_rubs_an_unknown_compound_by_the_assumed_law() -> None:
    assert condition(MILD.but("EPDM")).friction_j == pytest.approx(condition(MILD).friction_j)


def test_a_person_takes_time_on_a_real_rig_only() -> None:
    simulated = planned(PREPARED)[1].steps[0].seconds
    plan = expand(recipe(PREPARED), real_rig())
    real = PART.estimate(plan, real_rig()).steps[0].seconds
    assert real == simulated + CONSTANTS.person_s


def test_heating_takes_longer_the_further_it_goes() -> None:
    plan, figures = planned(PREPARED.replace("[40 degC, 25 degC]", "[25 degC, 40 degC, 85 degC]"))
    heats = [one.seconds for step, one in zip(plan.steps, figures.steps, strict=True) if step.kind == "heat"]
    assert heats[0] < heats[1] < heats[2]


def test_the_peak_is_the_hottest_setpoint_and_its_pulse() -> None:
    assert 40.0 < planned(PREPARED)[1].peak_c <= 42.0


def test_cooling_a_hub_from_85_degrees_takes_most_of_an_hour() -> None:
    text = PREPARED.replace("[40 degC, 25 degC]", "85 degC").replace(
        '- compound: "1#"', '- compound: "1#"\n  - compound: "2#"'
    )
    plan = expand(recipe(text), real_rig())
    figures = PART.estimate(plan, real_rig())
    (cool,) = [one for step, one in zip(plan.steps, figures.steps, strict=True) if step.kind == "cool"]
    assert 25 * 60 < cool.seconds < 90 * 60


def test_a_conditions_wear_can_be_asked_for_alone() -> None:
    plan, figures = planned(PREPARED)
    step = next(plan.conditions())
    assert predicted_loss_mm(step, rig()) == figures.steps[step.index].loss_mm > 0.0


def test_other_constants_give_another_estimate() -> None:
    plan = expand(recipe(PREPARED), rig())
    slow = estimate(plan, WheelEstimator(rig(), replace(CONSTANTS, repeat_moves_s=100.0)))
    assert slow.rig_seconds > PART.estimate(plan, rig()).rig_seconds


def test_a_shared_estimator_gives_the_same_figures() -> None:
    estimator = WheelEstimator(rig())
    plan = expand(recipe(PREPARED), rig(), estimator)
    assert estimate(plan, estimator) == PART.estimate(plan, rig())


def test_every_condition_of_table_2_is_expected_to_hold() -> None:
    plan = expand(load_recipe(recipes.find("table2"), PART).recipe, rig())
    assert PART.estimate(plan, rig()).not_held == ()


def test_a_time_window_counts_seconds() -> None:
    text = with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  window: 60 s")
    assert condition(MILD, CONSTANTS, text).sliding_m > 5 * 60 * 0.3


def test_condition_steps_are_recognised_by_kind() -> None:
    plan, _ = planned(PREPARED)
    assert all((step.kind == "condition") == isinstance(step, WheelCondition) for step in plan.steps)


def hot(extra: str) -> Estimate:
    text = PREPARED.replace("[40 degC, 25 degC]", "85 degC").replace("measure:\n", "measure:\n" + extra)
    return planned(text)[1]


def test_a_person_at_a_hot_wheel_costs_cooling_and_warming_again() -> None:
    assert hot("  wear_check: prompt\n").rig_seconds > hot("").rig_seconds + 25 * 60


def test_a_prompt_costs_the_same_as_a_wear_check() -> None:
    text = PREPARED.replace("[40 degC, 25 degC]", "85 degC")
    prompts = planned(text + "steps:\n  - {prompt: look, every: condition}\n")[1]
    assert prompts.rig_seconds == pytest.approx(hot("  wear_check: prompt\n").rig_seconds)


@pytest.mark.parametrize(("speed_m_s", "each_s"), [(0.8, 7.1), (0.4, 9.4)])  # as simulated runs take
def test_a_roll_check_costs_its_moves_and_six_turns(speed_m_s: float, each_s: float) -> None:
    measure = f"measure:\n  wheel_speed: {speed_m_s} m/s\n"
    text = with_line("measure:\n  wheel_speed: 0.8 m/s\n", measure, PREPARED)
    plan, without = planned(text)
    checked = planned(with_line(measure, f"{measure}  wear_check: each_condition\n", text))[1]
    extra = [with_s.seconds - one.seconds for with_s, one in zip(checked.steps, without.steps, strict=True)]
    conditions = [place for place, step in enumerate(plan.steps) if isinstance(step, WheelCondition)]
    assert plan.steps[0].kind == "install"
    expected = [each_s if place in (0, *conditions) else 0.0 for place in range(len(extra))]
    expected[conditions[-1]] += each_s  # and after the wheel's last
    assert extra == pytest.approx(expected, abs=0.3)
