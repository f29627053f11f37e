"""Recipes to plans: which conditions, in which order, on which wheels."""

from __future__ import annotations

from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st

import recipes
from tester.analysis.stability import Window
from tester.inputs.recipe.conditions import conditions_of
from tester.inputs.recipe.plan import PromptStep, Soak
from tester.kinds.wheel_on_belt.image.axes import AXES, held_by
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import change_points, expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Install, PreGrind, Rest, WheelCondition, WheelPlan
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, load_recipe, recipe, rig, with_line


def plan_of(text: str) -> WheelPlan:
    return expand(recipe(text), rig())


def table2(extra: str = "") -> WheelPlan:
    text = recipes.find("table2").read_text(encoding="utf-8")
    return expand(load_recipe(text + extra, PART).recipe, rig())


def setpoints(plan: WheelPlan) -> list[tuple[float, float]]:
    return [(step.setpoint.value("temperature"), step.setpoint.value("load")) for step in plan.conditions()]


# -- conditions ----------------------------------------------------------------------------------------------------


def test_table_2_has_55_distinct_conditions_a_compound() -> None:
    plan = table2()
    found = [step.setpoint for step in plan.conditions() if not step.reference]
    assert len(found) == len(set(found)) == 165
    assert [sum(one.compound == name for one in found) for name in ("1#", "2#", "3#")] == [55, 55, 55]


def test_three_replicates_of_table_2_are_495_conditions() -> None:
    plan = table2("replicates: 3\n")
    assert sum(not step.reference for step in plan.conditions()) == 495
    assert len({step.row for step in plan.conditions() if not step.reference}) == 165


def test_a_condition_is_held_and_measured_as_the_recipe_states() -> None:
    step = next(iter(plan_of(SMALL).conditions()))
    assert held_by(step.setpoint)._asdict() == {
        "compound": "1#",
        "slip_velocity_m_s": 0.3,
        "load_n": 100.0,
        "temperature_c": 25.0,
        "wheel_speed_m_s": 0.8,
        "positions": {"sideslip": 0.0, "camber": 0.0},
    }
    assert held_by(step.setpoint).belt_speed_m_s == 0.5
    assert (step.repeats, step.min_valid, step.max_bursts, step.wear_check) == (5, 3, 40, "never")
    assert step.window == Window(revolutions=30.0, seconds=None, extend_to=90.0)
    assert (step.temperature_band_k, step.soak) == (2.0, Soak(1.0, 60.0, 1800.0))


def test_a_grid_may_override_measure() -> None:
    own = "name: load\n    repeats: 7\n    window: 60 s\n    soak: {within: 0.5 K, for: 2 min}"
    step = next(iter(plan_of(with_line("name: load", own)).conditions()))
    assert (step.repeats, step.window) == (7, Window(None, 60.0, 180.0))
    assert (step.soak.within_k, step.soak.for_s) == (0.5, 120.0)


def test_a_condition_of_several_grids_is_measured_once_and_belongs_to_the_first() -> None:
    second = "  - {name: slip, slip_velocity: [0.1 m/s, 0.3 m/s], load: 100 N, temperature: 25 degC}\n"
    found = list(plan_of(SMALL + second).conditions())
    assert len(found) == 5
    assert [step.grid for step in found].count("slip") == 1


def test_wheel_speed_may_be_an_axis_of_a_grid() -> None:
    text = with_line("name: load", "name: load\n    wheel_speed: [0.6 m/s, 0.8 m/s]")
    assert {step.setpoint.value("wheel_speed") for step in plan_of(text).conditions()} == {0.6, 0.8}


load_and_temperature = AXES.numbers_of("load", "temperature")


def test_rows_number_the_recipes_order_not_the_measured_one() -> None:
    found = conditions_of(recipe(SMALL), PART.settings)
    assert [(one.row, *load_and_temperature(one.values)) for one in found] == [
        (1, 100.0, 40.0),
        (2, 100.0, 25.0),
        (3, 200.0, 40.0),
        (4, 200.0, 25.0),
    ]
    assert [step.row for step in plan_of(SMALL).conditions()] == [2, 4, 1, 3]


def test_rows_continue_through_the_specimens() -> None:
    plan = plan_of(with_line('- compound: "1#"', '- compound: "1#"\n  - compound: "2#"'))
    assert sorted(step.row for step in plan.conditions()) == list(range(1, 9))


def axis(values: st.SearchStrategy[int], unit: str, most: int = 4) -> st.SearchStrategy[list[str]]:
    return st.lists(values.map(lambda value: f"{value} {unit}"), min_size=1, max_size=most, unique=True)


GRID = st.fixed_dictionaries(
    {
        "slip_velocity": axis(st.integers(100, 104), "mm/s"),
        "load": axis(st.integers(100, 104), "N"),
        "sideslip": axis(st.integers(-1, 1), "deg", 2),
        "camber": axis(st.integers(0, 1), "deg", 2),
        "wheel_speed": axis(st.integers(700, 701), "mm/s", 2),
        "temperature": axis(st.integers(25, 28), "degC"),
    }
)
GRIDS = st.lists(GRID, min_size=1, max_size=3)
ORDERS = st.sampled_from(["listed", "snake", "shuffled, seed: 5"])


def with_grids(grids: list[dict[str, list[str]]], within: str, replicates: int) -> str:
    listed = "".join(
        "  - {" + f"name: g{number}" + "".join(f", {name}: [{', '.join(grid[name])}]" for name in grid) + "}\n"
        for number, grid in enumerate(grids)
    )
    top = SMALL[: SMALL.index("grids:")].replace('- compound: "1#"', '- compound: "1#"\n  - compound: "2#"')
    return f"{top}replicates: {replicates}\norder: {{within: {within}}}\ngrids:\n{listed}"


def keys_of(grid: dict[str, list[str]]) -> set[tuple[str, ...]]:
    return set(product(*(grid[name] for name in sorted(grid))))


@given(GRIDS, ORDERS, st.integers(1, 2))
@settings(max_examples=25, deadline=None)
def test_every_combination_of_every_grid_is_measured_exactly_once_in_every_replicate(
    grids: list[dict[str, list[str]]], within: str, replicates: int
) -> None:
    plan = plan_of(with_grids(grids, within, replicates))
    wanted = len(set[tuple[str, ...]]().union(*map(keys_of, grids)))
    found = [(step.specimen, step.replicate, step.setpoint) for step in plan.conditions()]
    assert len(found) == len(set(found)) == 2 * replicates * wanted
    rows = [(step.row, step.replicate) for step in plan.conditions()]
    assert sorted(rows) == [(row, n) for row in range(1, 2 * wanted + 1) for n in range(1, replicates + 1)]


@given(GRIDS, ORDERS)
@settings(max_examples=25, deadline=None)
def test_a_plan_counts_through_and_heats_a_specimen_upwards(grids: list[dict[str, list[str]]], within: str) -> None:
    plan = plan_of(with_grids(grids, within, 1))
    assert [step.index for step in plan.steps] == list(range(len(plan.steps)))
    assert [step.condition for step in plan.conditions()] == list(range(1, 1 + sum(1 for _ in plan.conditions())))
    heated = [(step.specimen, step.setpoint.value("temperature")) for step in plan.conditions()]
    assert heated == sorted(heated)


@given(GRIDS)
@settings(max_examples=25, deadline=None)
def test_listed_conditions_of_a_temperature_come_in_the_order_of_their_rows(grids: list[dict[str, list[str]]]) -> None:
    plan = plan_of(with_grids(grids, "listed", 1))
    found = [(s.specimen, s.setpoint.value("temperature"), s.row) for s in plan.conditions()]
    assert found == sorted(found)


@given(GRIDS)
@settings(max_examples=25, deadline=None)
def test_a_condition_belongs_to_the_first_grid_that_has_it(grids: list[dict[str, list[str]]]) -> None:
    seen: set[tuple[str, ...]] = set()
    wanted: list[str] = []
    for number, grid in enumerate(grids):
        new = keys_of(grid) - seen
        wanted += [f"g{number}"] * len(new)
        seen |= new
    assert [one.grid for one in conditions_of(recipe(with_grids(grids, "listed", 1)), PART.settings)] == wanted


# -- order ---------------------------------------------------------------------------------------------------------


def test_temperatures_ascend_whatever_the_recipe_lists() -> None:
    assert setpoints(plan_of(SMALL)) == [(25.0, 100.0), (25.0, 200.0), (40.0, 100.0), (40.0, 200.0)]


def test_a_snake_begins_a_temperature_where_the_last_one_ended() -> None:
    assert setpoints(plan_of(SMALL + "order: {within: snake}\n")) == [
        (25.0, 100.0),
        (25.0, 200.0),
        (40.0, 200.0),
        (40.0, 100.0),
    ]


def test_a_shuffled_order_keeps_temperatures_ascending_and_is_the_seeds_alone() -> None:
    text = SMALL.replace("[100 N, 200 N]", "[" + ", ".join(f"{n} N" for n in range(100, 120)) + "]")
    first, again, other = (plan_of(f"{text}order: {{within: shuffled, seed: {seed}}}\n") for seed in (1, 1, 2))
    temperatures = [step.setpoint.value("temperature") for step in first.conditions()]
    assert temperatures == sorted(temperatures)
    assert setpoints(first) == setpoints(again) != setpoints(other)
    assert sorted(setpoints(first)) == sorted(setpoints(other)) == setpoints(plan_of(text))


def test_another_temperature_leaves_a_shuffled_order_alone() -> None:
    text = SMALL.replace("[100 N, 200 N]", "[" + ", ".join(f"{n} N" for n in range(100, 120)) + "]")
    text += "order: {within: shuffled, seed: 3}\n"
    less = text.replace("[40 degC, 25 degC]", "40 degC")
    assert setpoints(plan_of(less)) == [one for one in setpoints(plan_of(text)) if one[0] == 40.0]


# -- steps ---------------------------------------------------------------------------------------------------------


def test_a_wheel_is_installed_ground_rested_heated_and_measured() -> None:
    kinds = [step.kind for step in plan_of(PREPARED).steps]
    assert kinds == ["install", "pre_grind", "rest", "heat", "condition", "condition", "heat", "condition", "condition"]


def test_every_step_knows_its_place() -> None:
    plan = table2()
    assert [step.index for step in plan.steps] == list(range(len(plan.steps)))
    assert [step.condition for step in plan.conditions()] == list(range(1, 166 + plan.references))


def test_pre_grind_and_rest_follow_the_recipe() -> None:
    steps = plan_of(PREPARED).steps
    assert steps[1] == PreGrind(1, 0.8, 0.6, 200.0, 240.0)
    assert steps[2] == Rest(2, 1200.0, 25.0, 2.0, 5400.0)


def test_the_next_specimen_begins_with_a_cool_hub_and_rubber_at_ambient() -> None:
    plan = plan_of(with_line('- compound: "1#"', '- compound: "1#"\n  - compound: "2#"', PREPARED))
    second = [step for step in plan.steps if step.index > 8]
    assert [step.kind for step in second[:5]] == ["cool", "install", "rest", "pre_grind", "rest"]
    assert second[0] == Cool(9, 45.0)
    assert second[2] == Rest(11, 0.0, 23.0, 5.0, 5400.0)


def test_work_of_a_person_is_requested_as_often_as_the_recipe_states() -> None:
    steps = "steps:\n  - {prompt: clean debris, every: condition}\n  - {prompt: look, every: temperature}\n"
    plan = plan_of(SMALL + steps + "  - {prompt: measure the diameter, every: wheel}\n")
    asked = [step.text if isinstance(step, PromptStep) else step.kind for step in plan.steps]
    assert asked == [
        "install", "measure the diameter",
        "look", "heat", "clean debris", "condition", "clean debris", "condition",
        "look", "heat", "clean debris", "condition", "clean debris", "condition",
    ]  # fmt: skip


def test_a_recipe_without_grids_only_prepares_the_wheel() -> None:
    plan = expand(load_recipe(recipes.find("pre-grind"), PART).recipe, rig())
    assert [step.kind for step in plan.steps] == ["install", "pre_grind", "rest"]


def test_metadata_are_texts_with_units_in_their_names() -> None:
    said = "abrasive: {name: belt, mesh: 80, id: B7}\nhumidity: 45 %\nambient: 22.5 degC\n"
    said += "experiment: {operator: Li, uncertainty.misalignment_deg: 0.1}\n"
    assert plan_of(SMALL + said).metadata == {
        "abrasive": "belt",
        "abrasive_mesh": "80",
        "abrasive_id": "B7",
        "humidity_percent": "45",
        "ambient_c": "22.5",
        "experiment.operator": "Li",
        "uncertainty.misalignment_deg": "0.1",
    }


# -- wheels --------------------------------------------------------------------------------------------------------


def test_every_wheel_of_table_2_is_ground_and_rests_twenty_minutes() -> None:
    plan = table2()
    wheels = sum(isinstance(step, Install) for step in plan.steps)
    assert sum(isinstance(step, PreGrind) for step in plan.steps) == wheels
    assert sum(isinstance(step, Rest) and step.at_least_s == 1200.0 for step in plan.steps) == wheels


def test_no_wheel_of_table_2_wears_more_than_allowed() -> None:
    plan = table2()
    assert len(plan.wear) > 3
    assert all(wheel.loss_mm <= plan.replace_after_mm for wheel in plan.wear)
    assert sum(wheel.conditions for wheel in plan.wear) == 165 + plan.references


def test_conditions_name_the_wheel_they_are_measured_on() -> None:
    wheel = 0
    for step in table2().steps:
        if isinstance(step, Install):
            wheel = step.wheel
        elif isinstance(step, WheelCondition):
            assert step.wheel == wheel


def test_a_wheel_changed_at_one_temperature_is_brought_back_to_it() -> None:
    plan = plan_of(PREPARED + "wheel: {replace_after: 0.3 mm}\n")
    steps = plan.steps
    changes = [index for index, step in enumerate(steps) if isinstance(step, Install) and step.wheel > 1]
    assert changes
    for index in changes:
        following = next(step for step in steps[index:] if isinstance(step, WheelCondition))
        before = steps[following.index - 1]
        assert isinstance(before, Heat)
        assert before.temperature_c == following.setpoint.value("temperature")


def test_one_estimator_may_serve_expansion_and_estimate() -> None:
    estimator = WheelEstimator(rig())
    assert expand(recipe(PREPARED), rig(), estimator) == expand(recipe(PREPARED), rig())


def test_a_wheel_is_changed_before_the_condition_it_would_not_outlast() -> None:
    assert change_points([[0.5, 0.5, 0.5, 0.5]], 0.2, 1.5) == [{2}]


def test_a_wheel_is_changed_at_a_temperature_boundary_where_that_costs_no_wheel() -> None:
    assert change_points([[0.4, 0.4], [0.4, 0.4]], 0.0, 1.3) == [set(), {0}]


def test_a_wheel_is_changed_within_a_temperature_where_the_boundary_would_cost_a_wheel() -> None:
    assert change_points([[0.4, 0.4], [0.4, 0.4], [0.4, 0.4]], 0.0, 1.25) == [set(), {1}, set()]


def test_a_new_wheel_always_takes_a_condition() -> None:
    assert change_points([[3.0, 3.0]], 0.1, 2.0) == [{1}]


@given(
    st.lists(st.lists(st.floats(0.001, 1.0), min_size=1, max_size=6), min_size=1, max_size=5),
    st.floats(0.0, 0.5),
)
@settings(max_examples=200, deadline=None)
def test_moving_changes_to_boundaries_never_costs_a_wheel(losses: list[list[float]], first: float) -> None:
    changes = change_points(losses, first, 2.0)
    left, greedy = 2.0 - first, 0
    for loss in (loss for block in losses for loss in block):
        if loss > left:
            greedy, left = greedy + 1, 2.0 - first
        left -= loss
    assert sum(map(len, changes)) == greedy
    left = 2.0 - first
    for block, points in zip(losses, changes, strict=True):
        for position, loss in enumerate(block):
            left = 2.0 - first if position in points else left
            left -= loss
            assert left > -1e-9
