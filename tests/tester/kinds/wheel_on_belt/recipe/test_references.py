"""A reference condition in recipes and plans: its places, its wheel, refusals."""

from __future__ import annotations

import pytest

from tester.inputs.recipe.loader import check
from tester.inputs.recipe.plan import Mounted, Stand
from tester.inputs.recipe.plan_text import lines
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Install, WheelCondition, WheelPlan
from tester.kinds.wheel_on_belt.recipe.remaining import remaining
from tester.kinds.wheel_on_belt.run.runs import split
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, rig

EVERY_2 = "reference: {every: 2}\n"
RESERVED = 'reference: {every: 3, wheel: ref-1, compound: "2#"}\n'


def plan_of(extra: str, text: str = SMALL) -> WheelPlan:
    return expand(recipe(text + extra), rig())


def marks(plan: WheelPlan) -> str:
    """Return a letter for each condition: R for a reference, else c."""
    return "".join("R" if one.reference else "c" for one in plan.conditions())


def problems(extra: str, text: str = SMALL) -> list[str]:
    return [one.message for one in check(text + extra, rig(), PART, "r.yaml")]


def test_it_comes_at_the_start_after_every_n_conditions_and_at_the_end() -> None:
    assert marks(plan_of(EVERY_2)) == "RccRccR"
    assert marks(plan_of("reference: {every: 3}\n")) == "RcccRcR"
    assert marks(plan_of("reference: {every: 100}\n")) == "RccccR"


def test_it_counts_on_over_specimens_and_replicates() -> None:
    text = SMALL.replace('- compound: "1#"', '- compound: "1#"\n  - compound: "3#"')
    assert marks(plan_of("reference: {every: 3}\n", text)) == "RcccRcccRccR"
    assert marks(plan_of("reference: {every: 3}\nreplicates: 2\n")) == "RcccRcccRccR"


def test_references_are_one_condition_with_rows_of_their_own() -> None:
    found = [one for one in plan_of(EVERY_2).conditions() if one.reference]
    assert [one.row for one in found] == [5, 6, 7]
    assert {one.grid for one in found} == {"reference"} and len({one.setpoint for one in found}) == 1


def test_its_axes_are_the_given_values_and_the_defaults() -> None:
    first = next(iter(plan_of("reference: {every: 2, load: 150 N, repeats: 2}\n").conditions()))
    held = {axis: first.setpoint.number(axis) for axis in ("load", "slip_velocity", "temperature", "wheel_speed")}
    assert held == {"load": 150.0, "slip_velocity": 0.3, "temperature": 40.0, "wheel_speed": 0.8}
    assert (first.repeats, first.min_valid) == (2, 2)


def test_the_wheel_is_heated_to_it_and_back() -> None:
    steps = plan_of(EVERY_2).steps
    held = [step.temperature_c for step in steps if isinstance(step, Heat)]
    assert held == [40.0, 25.0, 40.0]  # the block at 40 degC begins with a reference
    cooled = [place for place, step in enumerate(steps) if isinstance(step, Cool)]
    assert [steps[place].hub_below_c for place in cooled] == [25.0]  # type: ignore[union-attr]
    assert isinstance(steps[cooled[0] + 1], Heat)


def test_without_it_a_plan_is_as_it_was() -> None:
    plan = plan_of("")
    assert plan.references == 0 and "reference_every" not in plan.metadata and marks(plan) == "cccc"


def test_its_wear_counts_with_the_wheel_s() -> None:
    assert plan_of(EVERY_2).wear[0].loss_mm > plan_of("").wear[0].loss_mm
    assert plan_of(EVERY_2).wear[0].conditions == 7


def test_a_plan_with_references_is_one_part() -> None:
    assert len(split(plan_of("replicates: 3\n"))) == 3
    assert len(split(plan_of(EVERY_2 + "replicates: 3\n"))) == 1


def test_the_plan_states_its_setpoints_and_places() -> None:
    told = "\n".join(lines(plan_of(EVERY_2), PART.estimate(plan_of(EVERY_2), rig()), PART))
    assert "references        3 of 300 mm/s, 200 N, 40 degC," in told
    assert "after every 2 conditions, on whichever wheel is on" in told


def test_fewer_repeats_of_a_reference_do_not_change_the_separation_of_compounds() -> None:
    def told(extra: str) -> str:
        plan = plan_of(extra)
        return next(one for one in lines(plan, PART.estimate(plan, rig()), PART) if one.startswith("two compounds"))

    assert told("reference: {every: 2, repeats: 1}\n") == told("")


def test_its_key_is_in_the_schema_for_editors() -> None:
    assert "reference" in PART.model().model_fields


# -- a reserved wheel ------------------------------------------------------------------------------------------------


def test_a_reserved_wheel_measures_references_and_nothing_else() -> None:
    plan = plan_of(RESERVED, PREPARED)
    assert marks(plan) == "RcccRcR"
    assert {one.wheel for one in plan.conditions() if one.reference} == {1}
    assert {one.wheel for one in plan.conditions() if not one.reference} == {2}
    assert plan.specimen(2).compound == "2#" and plan.specimen(2).note == "reserved: ref-1"
    assert plan.metadata["reference_reserved"] == "ref-1"


def test_wheels_are_changed_for_it_and_back() -> None:
    installs = [step for step in plan_of(RESERVED, PREPARED).steps if isinstance(step, Install)]
    assert [(one.wheel, one.again) for one in installs] == [(1, False), (2, False), (1, True), (2, True), (1, True)]
    assert [one.specimen for one in installs] == [2, 1, 2, 1, 2]


def test_it_comes_on_at_every_change_of_the_wheel_and_the_count_begins_anew() -> None:
    assert marks(plan_of("reference: {every: 3, wheel: a}\nreplicates: 2\n")) == "RcccRcRcccRcR"


# -- going on --------------------------------------------------------------------------------------------------------


def mounted(number: int, specimen: int, last: int) -> Mounted:
    return Mounted(number, specimen, 1, 89.5, 100.0, ground=True, last_condition=last)


def test_the_rest_after_its_first_condition_is_unchanged() -> None:
    plan = plan_of(RESERVED, PREPARED)
    stand = Stand(frozenset({1, 2}), frozenset({1, 2, 3}), (mounted(1, 2, 1), mounted(2, 1, 3)))
    left = remaining(plan, stand)
    assert [one.condition for one in left.conditions()] == [3, 4, 5, 6, 7]
    installs = [step for step in left.steps if isinstance(step, Install)]
    assert [(one.wheel, one.again, one.worn is not None) for one in installs] == [
        (2, False, True),
        (1, True, False),
        (2, True, False),
        (1, True, False),
    ]


def test_it_resumes_with_the_reserved_wheel_where_that_was_mounted() -> None:
    plan = plan_of(RESERVED, PREPARED)
    stand = Stand(frozenset({1, 2, 3, 4}), frozenset({1, 2, 3, 4, 5}), (mounted(1, 2, 5), mounted(2, 1, 4)))
    first = next(step for step in remaining(plan, stand).steps if isinstance(step, Install))
    assert (first.wheel, first.worn is not None) == (1, True)


# -- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        ("reference: {every: 0}\n", "every: \"0\" is not accepted (expected greater than or equal to 1)"),
        ("reference: {load: 200 N}\n", "every is missing"),
        ("reference: {every: 5, lode: 200 N}\n", "unknown key"),
        ("reference: {every: 5, sideslip: 10 deg}\n", "unknown key"),
        ("reference: {every: 5, load: 500 N}\n", "limits.load"),
        ("reference: {every: 5, load: 3 N}\n", "too near to touching"),
        ("reference: {every: 5, temperature: 10 degC}\n", "below ambient"),
        ("reference: {every: 5, slip_velocity: 780 mm/s}\n", "a standing belt is never loaded"),
        ("reference: {every: 5, wheel_speed: 9 m/s}\n", "limits.wheel_speed"),
        ('reference: {every: 5, compound: "2#"}\n', "expected wheel with it"),
    ],
)
def test_nonsense_is_refused(extra: str, said: str) -> None:
    found = problems(extra)
    assert found and any(said in one for one in found), found


def test_a_default_that_the_rig_cannot_hold_is_also_refused() -> None:
    found = [one.message for one in check(SMALL + EVERY_2, rig("limits.load=150 N"), PART, "r.yaml")]
    assert sum("load: 200 N is more than the rig allows" in one for one in found) == 2


def test_a_grid_cannot_have_its_name() -> None:
    assert any("another name" in one for one in problems(EVERY_2, SMALL.replace("name: load", "name: reference")))
    assert not problems("", SMALL.replace("name: load", "name: reference"))


def test_references_need_something_between_them() -> None:
    grind = "recipe: grind\nspecimens: [{compound: '1#'}]\npre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}\n"  # noqa: E501
    assert any("nothing to measure between" in one for one in problems(EVERY_2, grind))


def test_a_reserved_wheel_has_to_outlast_its_references() -> None:
    found = problems("reference: {every: 1, wheel: a, repeats: 60}\n")
    assert any("reserved wheel" in one for one in found), found


def test_conditions_name_their_wheel() -> None:
    assert all(isinstance(one, WheelCondition) for one in plan_of(EVERY_2).conditions())
