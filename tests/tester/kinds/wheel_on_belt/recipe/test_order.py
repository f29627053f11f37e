"""The cost of the steps' order, and the range of the rig time."""

from __future__ import annotations

import pytest

from tester.inputs.recipe.time_estimate import Estimate
from tester.kinds.wheel_on_belt.recipe.constants import CONSTANTS
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition, WheelPlan
from tests.tester.inputs.recipe.texts import PREPARED, recipe, rig


def planned(text: str, *overrides: str) -> tuple[WheelPlan, Estimate]:
    plan = expand(recipe(text), rig(*overrides))
    return plan, PART.estimate(plan, rig(*overrides))


def at(temperatures: str, loads: str = "[100 N, 200 N]", slips: str = "300 mm/s") -> str:
    text = PREPARED.replace("[40 degC, 25 degC]", temperatures).replace("[100 N, 200 N]", loads)
    return text.replace("300 mm/s", slips)


def conditions(text: str) -> list[float]:
    plan, figures = planned(text)
    return [
        one.seconds for step, one in zip(plan.steps, figures.steps, strict=True) if isinstance(step, WheelCondition)
    ]


def heats(text: str) -> list[float]:
    plan, figures = planned(text)
    return [one.seconds for step, one in zip(plan.steps, figures.steps, strict=True) if step.kind == "heat"]


def test_the_first_condition_after_heating_waits_for_the_hub_to_come_down() -> None:
    first, second = conditions(at("40 degC", "100 N", "[100 mm/s, 150 mm/s]"))
    assert first > second + 300.0


def test_heating_itself_does_not_hold_that_wait() -> None:
    # Simulated runs of seeds 0 and 3 take 303 and 279 s to 40 degC.
    assert heats(at("40 degC"))[0] == pytest.approx(290.0, abs=30.0)


def test_a_small_step_up_does_not_overshoot_as_heating_from_ambient_does() -> None:
    # 15 K on top of 55 degC: the surface is steady at once; from ambient it takes minutes more.
    steps = conditions(at("[55 degC, 70 degC]", "100 N", "100 mm/s"))
    alone = conditions(at("70 degC", "100 N", "100 mm/s"))
    assert steps[1] < alone[0] - 100.0


def test_near_ambient_pulses_wait_longest() -> None:
    cold, warm = conditions(at("25 degC", "400 N"))[0], conditions(at("70 degC", "400 N"))[0]
    assert cold > 1.5 * warm


def test_more_friction_waits_longer() -> None:
    mild, hard = conditions(at("55 degC", "[100 N, 400 N]"))
    assert hard > mild


def test_after_a_hotter_condition_a_mild_one_waits_less() -> None:
    after_hot = conditions(at("55 degC", "[300 N, 100 N]"))[1]
    after_mild = conditions(at("55 degC", "[100 N, 101 N]"))[1]
    assert after_hot < after_mild


def test_from_rolling_to_pulses_the_surface_has_to_cool() -> None:
    after_rolling = conditions(at("40 degC", "100 N", "[0 mm/s, 100 mm/s]"))[1]
    after_pulses = conditions(at("40 degC", "100 N", "[90 mm/s, 100 mm/s]"))[1]
    assert after_rolling > after_pulses + 30.0


def test_the_steps_of_a_plan_and_its_end_are_its_rig_time() -> None:
    _, figures = planned(at("40 degC"))
    assert figures.rig_seconds == pytest.approx(sum(one.seconds for one in figures.steps))


def test_the_range_contains_the_estimate_and_widens_with_waiting_steps() -> None:
    _, figures = planned(at("40 degC"))
    waits = sum(one.waiting_s for one in figures.steps)
    low, high = figures.rig_seconds - figures.rig_seconds_low, figures.rig_seconds_high - figures.rig_seconds
    assert low == pytest.approx((1.0 - CONSTANTS.waits_least) * waits)
    assert high > (CONSTANTS.waits_most - 1.0) * waits > 0.0


def test_near_ambient_the_range_holds_one_lift_to_cool() -> None:
    # Of 6 runs of 2# at 28 degC one waits 600 s longer than the others: its thermometer reads 0.6 K high.
    _, figures = planned(at("27 degC", "100 N", "100 mm/s"))
    assert figures.rig_seconds_high - figures.rig_seconds > CONSTANTS.lift_s


def test_where_settling_is_long_the_range_has_it_already() -> None:
    _, figures = planned(at("40 degC", "100 N", "100 mm/s"))
    waits = sum(one.waiting_s for one in figures.steps)
    high = figures.rig_seconds_high - figures.rig_seconds
    assert high < CONSTANTS.waits_most * waits


def test_each_specimen_of_a_simulated_run_starts_on_a_cold_rig() -> None:
    both = PREPARED.replace('- compound: "1#"', '- compound: "1#"\n  - compound: "1#"\n    note: again')
    text = both.replace("[40 degC, 25 degC]", "85 degC")
    plan, figures = planned(text)
    grinds = [place for place, step in enumerate(plan.steps) if step.kind == "pre_grind"]
    seconds = [one.seconds for one in figures.steps]
    conditions_and_heat = len(plan.steps) - grinds[1]
    assert seconds[grinds[0] : grinds[0] + conditions_and_heat] == pytest.approx(seconds[grinds[1] :])
    assert [one.seconds for step, one in zip(plan.steps, figures.steps, strict=True) if step.kind == "cool"] == [0.0]
