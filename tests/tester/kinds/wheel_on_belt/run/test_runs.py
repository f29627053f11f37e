"""A plan in parts: the part of each step; nothing is lost or renumbered."""

from __future__ import annotations

import pytest

from tester.inputs.recipe.plan import Plan
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Install, WheelCondition
from tester.kinds.wheel_on_belt.run.runs import split
from tester.machine.run_parts import Part
from tests.tester.inputs.recipe.texts import PREPARED
from tests.tester.kinds.wheel_on_belt.bench import plan_of

THREE = PREPARED.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n  - compound: "3#"\n')
WORN = PREPARED.replace("[100 N, 200 N]", "[100 N, 200 N, 300 N]") + "wheel: {replace_after: 0.3 mm}\n"


def parts_of(text: str) -> tuple[Plan, tuple[Part, ...]]:
    plan = plan_of(text)
    return plan, split(plan)


def installs(plan: Plan) -> list[Install]:
    return [step for step in plan.steps if isinstance(step, Install)]


def test_every_specimen_is_a_part() -> None:
    _, parts = parts_of(THREE)
    assert [part.number for part in parts] == [1, 2, 3]
    assert [{step.specimen for step in part.plan.conditions()} for part in parts] == [{1}, {2}, {3}]


def test_every_replicate_is_a_part() -> None:
    _, parts = parts_of(THREE + "replicates: 2\n")
    places = [{(step.specimen, step.replicate) for step in part.plan.conditions()} for part in parts]
    assert places == [{(1, 1)}, {(1, 2)}, {(2, 1)}, {(2, 2)}, {(3, 1)}, {(3, 2)}]


def test_a_change_of_wheel_begins_no_part() -> None:
    plan, parts = parts_of(WORN)
    assert len(installs(plan)) > 1 and len(parts) == 1


def test_a_plan_of_one_specimen_is_left_as_it_is() -> None:
    plan, parts = parts_of(PREPARED)
    assert len(parts) == 1 and parts[0].plan is plan


def test_steps_keep_their_order_and_their_numbers() -> None:
    plan, parts = parts_of(THREE)
    kept = [step for part in parts for step in part.plan.steps]
    between = [step for part in parts[1:] for step in [plan.steps[part.plan.steps[0].index - 1]]]
    assert all(isinstance(step, Cool) for step in between)
    assert kept == [step for step in plan.steps if step not in between]


def test_a_rig_of_its_own_has_nothing_to_cool() -> None:
    _, parts = parts_of(THREE)
    assert all(isinstance(part.plan.steps[0], Install) for part in parts)


def test_a_part_has_the_predicted_loss_of_its_own_wheels() -> None:
    plan, parts = parts_of(THREE)
    assert [wear for part in parts for wear in part.plan.wear] == list(plan.wear)
    assert [len(part.plan.wear) for part in parts] == [1, 1, 1]


@pytest.mark.parametrize("text", [THREE, THREE + "replicates: 2\n", WORN])
def test_wheels_that_were_not_foreseen_get_numbers_of_their_own(text: str) -> None:
    plan, parts = parts_of(text)
    given = {step.wheel for step in installs(plan)}
    for part in parts:
        conditions = sum(isinstance(step, WheelCondition) for step in part.plan.steps)
        unforeseen = set(range(part.last_mounted + 1, part.last_mounted + conditions + 1))
        assert not given & unforeseen
        given |= unforeseen
