"""Both directions in a recipe: refusals and their limits, the text of a plan, and the cost."""

from __future__ import annotations

import json

import pytest

from tester.analysis.kelvin import Slope
from tester.inputs.recipe.loader import check
from tester.inputs.recipe.plan_text import json_chunks, lines
from tester.inputs.recipe.time_estimate import Outlook, estimate
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.run.build import plan_bounds
from tests.tester.inputs.recipe.texts import recipe as read
from tests.tester.inputs.recipe.texts import rig

TEXT = """\
recipe: both
specimens: [{{compound: "1#"}}]
measure: {{wheel_speed: 0.8 m/s, repeats: 3{measure}}}
grids:
  - {{name: one, slip_velocity: {slip}, load: 200 N, temperature: 25 degC{grid}}}
"""
BOTH = ", both_directions: true"
KNOWN = Outlook(slope=Slope(0.0005, 0.002, "made up"))


def text(slip: str = "300 mm/s", measure: str = BOTH, grid: str = "") -> str:
    return TEXT.format(slip=slip, measure=measure, grid=grid)


def problems(recipe: str) -> list[str]:
    return [str(one) for one in check(recipe, rig(), PART, "r.yaml")]


def condition(recipe: str) -> WheelCondition:
    return next(expand(read(recipe), rig()).conditions())


def test_a_recipe_in_both_directions_is_valid() -> None:
    assert problems(text()) == []
    assert condition(text()).both_directions and not condition(text(measure="")).both_directions


def test_a_grid_may_state_it() -> None:
    assert condition(text(measure="", grid=BOTH)).both_directions
    assert not condition(text(grid=", both_directions: false")).both_directions


@pytest.mark.parametrize(
    ("recipe", "message"),
    [
        (text("0 mm/s"), "slip_velocity: 0 m/s has no direction to reverse (expected another slip"),
        (text(grid=", sideslip: 30 deg"), "it slides at 0.444 m/s one way and at 0.571 m/s the other way"),
        (text(grid=", camber: 5 deg"), "a tilted tread carries more on one side"),
        (text("520 mm/s"), "reversed by both_directions, at a wheel speed of 0.8 m/s needs 1.32 m/s of the belt "
                           "(limit 1.3 m/s: limits.belt_speed of rig"),
        (text("-780 mm/s"), "reversed by both_directions, leaves 0.02 m/s for the belt at a wheel speed of 0.8 m/s "
                            "(expected at least 0.05 m/s"),
        (text(measure="", grid=", run_in_after_reversal: 5 m"), "run_in_after_reversal: without both_directions"),
        (text(grid=", run_in_after_reversal: -1 m"), "run_in_after_reversal"),
        (text("595 mm/s", measure=", wheel_speed: 0.65 m/s" + BOTH).replace("wheel_speed: 0.8 m/s, ", ""),
         "reversed by both_directions, at a wheel speed of 0.65 m/s leaves less than"),
    ],
)  # fmt: skip
def test_a_condition_that_differs_the_other_way_is_refused(recipe: str, message: str) -> None:
    found = problems(recipe)
    assert any(message in one for one in found), found


def test_a_slip_that_needs_a_fast_belt_one_way_is_allowed_one_way() -> None:
    assert problems(text("520 mm/s", measure="").replace("load: 200 N", "load: 100 N")) == []


def test_pairs_take_twice_the_time_and_the_wear_of_repeats() -> None:
    costs = WheelEstimator(rig())
    one, both = (costs.condition(condition(text(measure=measure))) for measure in ("", BOTH))
    assert both.repeats == pytest.approx(2.0 * one.repeats)
    assert both.loss_mm == pytest.approx(2.0 * one.loss_mm) and both.sliding_m == pytest.approx(2.0 * one.sliding_m)
    assert 1.6 * one.seconds < both.seconds < 2.05 * one.seconds


def test_run_ins_slide_once_for_each_pair_and_once_more() -> None:
    costs = WheelEstimator(rig())
    without, with_ = (costs.condition(condition(text(grid=grid))) for grid in ("", ", run_in_after_reversal: 5 m"))
    assert with_.sliding_m - without.sliding_m == pytest.approx(4.0 * 5.0, rel=0.02)


def test_a_precision_takes_as_many_repeats_in_both_directions() -> None:
    """A pair scatters by 1 / sqrt 2 of a repeat: half as many pairs, but at least four."""
    wanted = ", until: 1 %, repeats: {at_least: 4, at_most: 100}"
    recipes = (text(measure=wanted + more).replace("repeats: 3, ", "") for more in ("", BOTH))
    one, both = (WheelEstimator(rig()).condition(condition(recipe)).repeats for recipe in recipes)
    assert both == pytest.approx(one, rel=0.15)


@pytest.mark.parametrize("slip", ["300 mm/s", "-300 mm/s"])
def test_the_plan_states_pairs_and_belt_speeds(slip: str) -> None:
    plan = expand(read(text(slip, grid=", run_in_after_reversal: 5 m")), rig())
    said = "\n".join(lines(plan, estimate(plan, WheelEstimator(rig())), PART))
    assert "3 pairs x 30 rev" in said and "run-in 5 m" in said and "1, 6 repeats" in said
    assert "both directions   1 conditions: repeats alternate + - - +, the belt at up to 1.1 m/s" in said


def test_a_plan_s_json_states_it() -> None:
    plan = expand(read(text()), rig())
    found = json.loads("".join(json_chunks(plan, estimate(plan, WheelEstimator(rig())), PART)))
    assert [one["both_directions"] for one in found["steps"] if one["kind"] == "condition"] == [True]


def test_commands_may_go_as_far_as_the_reversed_belt_and_no_further() -> None:
    one, both, turned = (expand(read(text(*given)), rig()) for given in (("300 mm/s", ""), (), ("-300 mm/s",)))
    assert plan_bounds(one, rig()).belt_speed_m_s == 0.8
    assert plan_bounds(both, rig()).belt_speed_m_s == plan_bounds(turned, rig()).belt_speed_m_s == 1.1


def test_the_instruments_add_less_in_both_directions_and_another_term_is_the_largest() -> None:
    found = [WheelEstimator(rig()).budget(condition(text(measure=m)), KNOWN) for m in ("", BOTH)]
    assert all(found)
    (_, one), (_, both) = (pair for pair in found if pair is not None)
    worst = [max(b.contributions, key=lambda term: term.standard).name for b in (one, both)]
    assert both.standard < 0.5 * one.standard
    assert worst[0] == "axis misalignment" and worst[1] != "axis misalignment"
