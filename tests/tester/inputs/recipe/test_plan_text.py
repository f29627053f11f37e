"""Plans in words and as JSON."""

from __future__ import annotations

import json

import pytest

from tester.inputs.recipe.plan_text import json_chunks, lines
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, rig


def described(text: str) -> list[str]:
    plan = expand(recipe(text), rig())
    return list(lines(plan, PART.estimate(plan, rig()), PART))


def test_the_plan_lists_wheels_steps_and_totals() -> None:
    text = "\n".join(described(PREPARED))
    assert "wheel 1: 1#, 4 conditions, " in text
    assert "pre-grind 4 min, 200 N, wheel / belt 0.8 / 0.6 m/s" in text
    assert "rest at least 20 min, to 25 degC +- 2 K" in text
    assert "   1  300 mm/s, 100 N, 25 degC  5 x 30 rev" in text
    assert "conditions        4, 20 repeats" in text
    assert "sliding distance" in text
    assert "peak temperature" in text


def test_the_plan_names_a_hardness_that_is_read_at_mounting() -> None:
    asked = PREPARED.replace('"1#"', '"1#"\n    measured: {hardness: prompt}')
    assert any("install wheel 1, its hardness is read" in line for line in described(asked))
    assert not any("hardness" in line for line in described(PREPARED))


def test_angles_are_named_where_there_are_any() -> None:
    text = "\n".join(described(SMALL.replace("name: load", "name: load\n    sideslip: 10 deg\n    camber: -2 deg")))
    assert "300 mm/s, 100 N, sideslip 10 deg, camber -2 deg, 25 degC" in text


def test_json_is_one_object_with_a_step_a_line() -> None:
    plan = expand(recipe(PREPARED), rig())
    text = "".join(json_chunks(plan, PART.estimate(plan, rig()), PART))
    data = json.loads(text)
    assert (data["conditions"], data["wheels"], len(data["steps"])) == (4, 1, len(plan.steps))
    assert data["rig_seconds"] == pytest.approx(sum(step["seconds"] for step in data["steps"]), abs=1.0)
    assert [step["kind"] for step in data["steps"]] == [step.kind for step in plan.steps]
    assert text.count("\n") == len(plan.steps) + 2


def test_a_condition_in_json_has_its_setpoints_with_units() -> None:
    plan = expand(recipe(SMALL), rig())
    steps = json.loads("".join(json_chunks(plan, PART.estimate(plan, rig()), PART)))["steps"]
    first = next(step for step in steps if step["kind"] == "condition")
    assert (first["compound"], first["slip_velocity_m_s"], first["load_n"]) == ("1#", 0.3, 100.0)
    assert (first["belt_speed_m_s"], first["temperature_c"], first["window"]) == (0.5, 25.0, "30 rev")


def test_text_of_a_recipe_stays_text_in_json() -> None:
    plan = expand(recipe(SMALL.replace("recipe: small", "recipe: 'a \"b\" {0} \\n'")), rig())
    assert json.loads("".join(json_chunks(plan, PART.estimate(plan, rig()), PART)))["recipe"] == 'a "b" {0} \\n'
