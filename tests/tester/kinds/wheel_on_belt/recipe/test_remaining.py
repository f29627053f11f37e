"""The rest of a plan: where it resumes, with which wheel, after which conditioning."""

from __future__ import annotations

from tester.inputs.recipe.plan import Mounted, PromptStep, Stand, Step
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Install, PreGrind, Rest, WheelCondition, WheelPlan
from tester.kinds.wheel_on_belt.recipe.remaining import remaining
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, rig, with_line

TWO = with_line('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n', PREPARED)


def plan_of(text: str = PREPARED) -> WheelPlan:
    return expand(recipe(text), rig())


def worn(wheel: int = 1, specimen: int = 1, *, ground: bool = True, last: int = 1) -> Mounted:
    return Mounted(wheel, specimen, 1, 89.5, 700.0, ground, last)


def kinds(plan: WheelPlan) -> list[type[Step]]:
    return [type(step) for step in plan.steps]


def numbers(plan: WheelPlan) -> list[int]:
    return [step.condition for step in plan.conditions()]


def test_nothing_done_leaves_the_whole_plan() -> None:
    assert remaining(plan_of(), Stand()) == plan_of()


def test_a_condition_resumes_after_heating_with_the_same_wheel() -> None:
    left = remaining(plan_of(), Stand(frozenset({1}), frozenset({1, 2}), (worn(last=2),)))
    assert kinds(left)[:3] == [Install, Heat, WheelCondition] and numbers(left) == [2, 3, 4]
    first = left.steps[0]
    assert isinstance(first, Install) and first.wheel == 1 and first.worn is not None
    assert (first.worn.diameter_mm, first.worn.sliding_m) == (89.5, 700.0)


def test_heating_is_to_the_resumed_condition() -> None:
    left = remaining(plan_of(), Stand(frozenset({1, 2}), frozenset({1, 2, 3}), (worn(last=3),)))
    assert [step.temperature_c for step in left.steps if isinstance(step, Heat)] == [40.0]


def test_a_wheel_that_was_not_ground_in_is_ground_and_rested() -> None:
    left = remaining(plan_of(), Stand(mounted=(worn(ground=False, last=0),)))
    assert kinds(left)[:5] == [Install, Rest, PreGrind, Rest, Heat]


def test_a_ground_wheel_that_measured_nothing_rests_again() -> None:
    left = remaining(plan_of(), Stand(mounted=(worn(last=0),)))
    assert kinds(left)[:3] == [Install, Rest, Heat] and PreGrind not in kinds(left)


def test_everything_done_leaves_nothing() -> None:
    done = frozenset({1, 2, 3, 4})
    assert remaining(plan_of(), Stand(done, done, (worn(last=4),))).steps == ()


def test_the_next_specimen_gets_its_new_wheel() -> None:
    done = frozenset({1, 2, 3, 4})
    left = remaining(plan_of(TWO), Stand(done, done, (worn(last=4),)))
    assert kinds(left)[:2] == [Cool, Install] and numbers(left) == [5, 6, 7, 8]
    assert isinstance(left.steps[1], Install) and left.steps[1].worn is None


def test_specimens_measured_side_by_side_resume_each_at_its_place() -> None:
    stand = Stand(frozenset({1, 5, 6}), frozenset({1, 2, 5, 6}), (worn(last=2), worn(2, 2, last=6)))
    left = remaining(plan_of(TWO), stand)
    assert numbers(left) == [2, 3, 4, 7, 8]
    assert [step.wheel for step in left.steps if isinstance(step, Install)] == [1, 2]


def test_a_wheel_that_the_plan_did_not_foresee_stays_on() -> None:
    stand = Stand(frozenset({1}), frozenset({1, 2}), (worn(last=1), worn(7, last=2)))
    (mounted,) = [step for step in remaining(plan_of(), stand).steps if isinstance(step, Install)]
    assert mounted.wheel == 7


def test_a_planned_new_wheel_is_mounted_where_that_had_not_happened() -> None:
    plan = plan_of(TWO)
    done = frozenset({1, 2, 3, 4})
    left = remaining(plan, Stand(done, done, (worn(last=4), worn(2, 2, ground=False, last=0))))
    mounted = [step for step in left.steps if isinstance(step, Install)]
    assert [(step.wheel, step.worn is not None) for step in mounted] == [(2, True)]


def test_prompts_of_a_condition_that_was_begun_are_not_asked_again() -> None:
    text = SMALL + "steps:\n  - {prompt: clean debris, every: condition}\n"
    plan = plan_of(text)
    asked = [step for step in plan.steps if isinstance(step, PromptStep)]
    begun = remaining(plan, Stand(frozenset({1}), frozenset({1, 2}), (worn(last=2),)))
    fresh = remaining(plan, Stand(frozenset({1}), frozenset({1}), (worn(last=1),)))
    assert len(asked) == 4
    assert [sum(isinstance(s, PromptStep) for s in left.steps) for left in (begun, fresh)] == [2, 3]


def test_a_recipe_that_only_grinds_is_over_once_the_wheel_is_ground() -> None:
    text = 'recipe: grind\nspecimens:\n  - compound: "1#"\n' + PREPARED[PREPARED.index("pre_grind") :]
    plan = plan_of(text)
    assert remaining(plan, Stand(mounted=(worn(last=0),))).steps == ()
    assert PreGrind in kinds(remaining(plan, Stand(mounted=(worn(ground=False, last=0),))))
