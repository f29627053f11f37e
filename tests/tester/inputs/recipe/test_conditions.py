"""Grids to conditions: conditions shared by several grids, measured once or again."""

from __future__ import annotations

from tester.inputs.recipe.conditions import MergedConditions, conditions_of, merged_of
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import SMALL, recipe, rig

AGAIN = "measure_again: true, "


def with_grids(*said: str) -> str:
    """Return SMALL (100 and 200 N at 40 and 25 degC) with grids of 200 N at 40 and 55 degC behind it."""
    grids = (
        f"  - {{name: g{number}, {one}slip_velocity: 300 mm/s, load: 200 N, temperature: [40 degC, 55 degC]}}\n"
        for number, one in enumerate(said, start=1)
    )
    return SMALL + "".join(grids)


def listed(text: str) -> list[tuple[str, float, float]]:
    """Return grid, load and temperature of each condition, by row."""
    places = PART.axes.places
    found = conditions_of(recipe(text), PART.settings)
    assert [one.row for one in found] == list(range(1, len(found) + 1))
    return [(one.grid, float(one.values[places["load"]]), float(one.values[places["temperature"]])) for one in found]


def merged(text: str) -> list[MergedConditions]:
    return list(merged_of(recipe(text)))


def test_conditions_shared_by_two_grids_are_measured_in_the_first() -> None:
    assert listed(with_grids(""))[4:] == [("g1", 200.0, 55.0)]


def test_a_grid_measures_shared_conditions_again_on_request() -> None:
    assert listed(with_grids(AGAIN))[4:] == [("g1", 200.0, 40.0), ("g1", 200.0, 55.0)]
    assert merged(with_grids(AGAIN)) == []


def test_conditions_measured_again_take_nothing_from_a_later_grid() -> None:
    assert listed(with_grids(AGAIN, ""))[6:] == [("g2", 200.0, 55.0)]
    (one,) = merged(with_grids(AGAIN, ""))
    assert (one.grid, one.measured_in) == ("g2", "load")


def test_a_plan_has_a_step_for_each_measurement_of_a_setting() -> None:
    plan = expand(recipe(with_grids(AGAIN)), rig())
    twice = [one for one in plan.conditions() if (one.setpoint.number("load"), one.setpoint.number("temperature")) ==
             (200.0, 40.0)]  # fmt: skip
    assert [(one.grid, one.setpoint) for one in twice] == [("load", twice[0].setpoint), ("g1", twice[0].setpoint)]
    assert len({one.row for one in twice}) == 2


def test_merged_conditions_are_listed_by_grid_and_by_measuring_grid() -> None:
    first, second = merged(with_grids("", ""))[0], merged(with_grids("", ""))[1:]
    assert (first.grid, first.measured_in, [one.number("temperature") for one in first.conditions]) == (
        "g1", "load", [40.0],
    )  # fmt: skip
    assert [(one.grid, one.measured_in, len(one.conditions)) for one in second] == [("g2", "load", 1), ("g2", "g1", 1)]


def test_grids_that_share_nothing_are_not_listed() -> None:
    assert merged(SMALL) == []


def test_a_sentence_names_the_merged_conditions_and_the_key() -> None:
    (one,) = merged(with_grids(""))
    assert one.sentence() == (
        "grid g1 shares 1 condition with grid load, which alone measures it: 300 mm/s, 200 N, 40 degC "
        "(measure_again: true in the grid measures it again)"
    )


def test_a_sentence_lists_three_conditions_and_counts_the_rest() -> None:
    (one,) = merged(SMALL + "  - {name: b, slip_velocity: 300 mm/s, load: [100 N, 200 N], "
                    "temperature: [25 degC, 40 degC]}\n")  # fmt: skip
    assert "shares 4 conditions" in one.sentence() and one.sentence().count(" degC") == 3
    assert "; 1 more (" in one.sentence()
