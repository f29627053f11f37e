"""Several belts in one recipe: the changes, their consequences, and the remaining plan after an interruption."""

from __future__ import annotations

import pytest

from tester.base.axes import surface_of
from tester.inputs.recipe.loader import check
from tester.inputs.recipe.plan import Mounted, Stand
from tester.kinds.wheel_on_belt.recipe.describe import WheelDescription
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import ChangeBelt, Install, WheelCondition, WheelPlan, WheelStep
from tester.kinds.wheel_on_belt.recipe.remaining import remaining
from tester.kinds.wheel_on_belt.run.runs import split
from tests.tester.inputs.recipe.texts import PREPARED, recipe, rig

BELTS = PREPARED.replace("    slip_velocity:", "    surface: [A, B]\n    slip_velocity:").replace(
    "[40 degC, 25 degC]", "40 degC"
)
"""Two belts, two loads on each, one temperature, on one wheel that is ground in and rests."""


def plan_of(text: str = BELTS) -> WheelPlan:
    return expand(recipe(text), rig())


def outline(steps: tuple[WheelStep, ...]) -> str:
    """Return a letter for each step: a belt's name, i(nstall), m(ount again), g(rind), c(ool), r(est), h(eat).

    A condition is its belt's name in small, a reference R.
    """
    letters = {"pre_grind": "g", "cool": "c", "rest": "r", "heat": "h", "prompt": "p"}
    found: list[str] = []
    for step in steps:
        match step:
            case ChangeBelt():
                found.append(step.surface)
            case Install():
                found.append("m" if step.again else "i")
            case WheelCondition():
                found.append("R" if step.reference else surface_of(step.setpoint).lower())
            case _:
                found.append(letters[step.kind])
    return "".join(found)


def test_each_belt_is_put_on_once_and_the_first_before_its_wheel() -> None:
    assert outline(plan_of().steps) == "Aigrhaa" + "cBhbb"


def test_every_specimen_goes_through_its_belts_and_is_ground_in_on_the_first() -> None:
    text = BELTS.replace('- compound: "1#"', '- compound: "1#"\n  - compound: "2#"')
    assert outline(plan_of(text).steps) == "Aigrhaa" + "cBhbb" + "cAirgrhaa" + "cBhbb"


def test_a_recipe_that_names_no_belts_has_no_change() -> None:
    assert not any(isinstance(step, ChangeBelt) for step in plan_of(PREPARED).steps)


def test_a_wheel_that_is_worn_out_at_a_change_is_ground_in_on_the_new_belt() -> None:
    worn = plan_of(BELTS + "wheel: {replace_after: 0.4 mm}\n")
    assert outline(worn.steps) == "Aigrhaa" + "cBirgrhbb"


def test_the_reference_is_measured_first_and_last_on_every_belt() -> None:
    found = plan_of(BELTS + "reference: {every: 9, temperature: 40 degC}\n")
    assert outline(found.steps) == "AigrhRaaR" + "cBhRbbR"
    references = [surface_of(step.setpoint) for step in found.conditions() if step.reference]
    assert references == ["A", "A", "B", "B"]


def test_a_reserved_wheel_shows_both_belts_at_a_change() -> None:
    found = plan_of(BELTS + "reference: {every: 9, wheel: R, temperature: 40 degC}\n")
    assert outline(found.steps) == "AigrhR" + "cirgrhaa" + "cmhR" + "cBhR" + "cmhbb" + "cmhR"


def test_the_plan_names_the_change_and_counts_its_time() -> None:
    plan = plan_of()
    one = next(step for step in plan.steps if isinstance(step, ChangeBelt) and step.surface == "B")
    estimate = WheelEstimator(rig()).walk(plan)[one.index]
    assert WheelDescription.words(PART, one, estimate) == "ask: put belt B on"
    assert estimate.seconds > 0.0


def test_parts_on_rigs_of_their_own_begin_with_their_belt() -> None:
    text = BELTS.replace("[A, B]", "A").replace('- compound: "1#"', '- compound: "1#"\n  - compound: "2#"')
    assert outline(plan_of(text).steps) == "Aigrhaa" + "cirgrhaa"
    assert [outline(WheelPlan.of(part.plan).steps)[:2] for part in split(plan_of(text))] == ["Ai", "Ai"]


@pytest.mark.parametrize(("ended", "left"), [(1, "Aiha" + "cBhbb"), (2, "Bihbb"), (3, "Bihb")])
def test_the_rest_begins_with_the_belt_of_its_first_condition(ended: int, left: str) -> None:
    done = frozenset(range(1, ended + 1))
    found = remaining(plan_of(), Stand(done, done, (Mounted(1, 1, 1, 89.5, 700.0, True, ended),)))
    assert outline(found.steps) == left
    first = found.steps[0]
    assert isinstance(first, ChangeBelt) and first.again


def test_nothing_done_asks_for_the_first_belt_once() -> None:
    assert outline(remaining(plan_of(), Stand()).steps) == outline(plan_of().steps)


def test_a_belt_without_friction_on_the_simulated_wheel_is_refused() -> None:
    text = BELTS.replace('"1#"', "tread").replace("[A, B]", "[no such stone, granite]")
    told = check(text, rig("sim.friction_model=persson"), PART, "r.yaml")
    assert any("no such stone" in str(one) for one in told)
