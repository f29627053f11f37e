"""The steps of a wheel change, as the executor requests them during a run."""

from __future__ import annotations

from tester.inputs.recipe.plan import PromptStep
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Install, PreGrind, Rest
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED, wheel_change
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, rig


def test_a_worn_wheel_is_cooled_replaced_ground_rested_and_heated_back() -> None:
    plan = expand(recipe(PREPARED + "steps: [{prompt: measure it, every: wheel}]\n"), rig())
    last = list(plan.conditions())[-1]
    assert wheel_change(plan, last, plan.specimen(1), 2) == (
        Cool(INSERTED, 45.0),
        Install(INSERTED, specimen=1, wheel=2, compound="1#", note="", replicate=1),
        PromptStep(INSERTED, "measure it"),
        Rest(INSERTED, 0.0, 23.0, 5.0, 5400.0),
        PreGrind(INSERTED, 0.8, 0.6, 200.0, 240.0),
        Rest(INSERTED, 1200.0, 25.0, 2.0, 5400.0),
        Heat(INSERTED, 40.0),
    )


def test_without_pre_grind_and_rest_a_wheel_is_only_exchanged() -> None:
    plan = expand(recipe(SMALL), rig())
    steps = wheel_change(plan, next(plan.conditions()), plan.specimen(1), 2)
    assert [step.kind for step in steps] == ["cool", "install", "heat"]
