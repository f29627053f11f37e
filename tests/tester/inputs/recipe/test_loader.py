"""Recipes as files: form, defaults and sense, each problem with its position."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.inputs.recipe.conditions import metadata_of
from tester.inputs.recipe.loader import load_recipe
from tester.inputs.recipe.schema import Extent
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, recipe, with_line


def refused(text: str) -> list[str]:
    with pytest.raises(InvalidSource) as raised:
        load_recipe(text, PART, "r.yaml")
    return [str(problem) for problem in raised.value.problems]


def test_quantities_arrive_in_the_units_of_the_model() -> None:
    read = recipe(PREPARED)
    assert read.pre_grind is not None
    assert read.rest is not None
    assert (read.pre_grind.wheel_speed, read.pre_grind.duration) == (0.8, 240.0)
    assert (read.rest.at_least, read.rest.until, read.rest.within) == (1200.0, 25.0, 2.0)
    assert read.grids[0].model_dump()["slip_velocity"] == [0.3]
    assert read.grids[0].model_dump()["load"] == [100.0, 200.0]


def test_what_a_recipe_leaves_out_has_the_documented_defaults() -> None:
    read = recipe(PREPARED)
    assert read.measure is not None
    assert read.rest is not None
    assert (read.measure.repeats.at_least, read.measure.min_valid, read.measure.max_bursts) == (5, None, 40)
    assert (read.measure.window, read.measure.temperature_band) == (Extent(30.0, "rev"), 2.0)
    assert (read.measure.soak.within, read.measure.soak.for_, read.measure.soak.at_most) == (1.0, 60.0, 1800.0)
    assert (read.rest.at_most, read.wheel.replace_after, read.measure.wear_check) == (5400.0, 2.0, "never")
    assert (read.order.within, read.replicates) == ("listed", 1)
    assert (read.grids[0].model_dump()["sideslip"], read.grids[0].model_dump()["camber"]) == ([0.0], [0.0])


def test_a_scalar_is_an_axis_of_one() -> None:
    assert recipe(with_line("[100 N, 200 N]", "0.2 kN")).grids[0].model_dump()["load"] == [200.0]


def test_slip_may_be_negative() -> None:
    assert recipe(with_line("300 mm/s", "-100 mm/s")).grids[0].model_dump()["slip_velocity"] == [-0.1]


def test_a_window_may_be_a_time() -> None:
    read = recipe(with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  window: 60 s"))
    assert read.measure is not None
    assert read.measure.window == Extent(60.0, "s")


def test_free_fields_are_kept_as_text() -> None:
    read = recipe(SMALL + "experiment: {operator: Li, batch: 7, blind: true}\n")
    assert read.experiment == {"operator": "Li", "batch": "7", "blind": "true"}


def test_a_file_is_read_like_a_text(tmp_path: Path) -> None:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL, encoding="utf-8")
    assert load_recipe(file, PART).recipe == recipe(SMALL)


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        (
            "load: [100 N, 200 N]",
            "load: [100 N, 200]",
            'r.yaml:9:19: load: 200 has no unit (expected a force such as "200 N"; units accepted: N, kN)',
        ),
        (
            "load: [100 N, 200 N]",
            "load: 5 m/s",
            'r.yaml:9:11: load: "5 m/s" has the unit of speed'
            ' (expected a force such as "200 N"; units accepted: N, kN)',
        ),
        (
            "slip_velocity",
            "slip_velocty",
            'r.yaml:8:5: unknown key "slip_velocty", did you mean slip_velocity? (expected one of name, slip_velocity, '
            "load, temperature, sideslip, camber, wheel_speed, repeats, until, min_valid, window, extend_to, "
            "temperature_band, soak, measure_again, max_bursts, wear_check, both_directions, run_in_after_reversal)",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.01 m/s",
            "r.yaml:5:16: wheel_speed: 0.01 m/s is too small (expected at least 0.05 m/s)",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  window: 30 N",
            'r.yaml:6:11: window: "30 N" has the unit of force (expected a number of revolutions or a duration such'
            ' as "30 rev"; units accepted: rev, s, min, h, ms)',
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  repeats: 2.5",
            'r.yaml:6:12: repeats: "2.5" is not accepted (expected a whole number)',
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  wear_check: promt",
            'r.yaml:6:15: wear_check: "promt" is not accepted, did you mean prompt?'
            " (expected 'never', 'each_condition' or 'prompt')",
        ),
        (
            "load: [100 N, 200 N]",
            "load: []",
            "r.yaml:9:11: load: List should have at least 1 item after validation, not 0",
        ),
        (
            "[40 degC, 25 degC]",
            "[40 K]",
            'r.yaml:10:19: temperature: "40 K" has the unit K, which is for temperature differences here (expected a'
            ' temperature such as "25 degC"; units accepted: degC)',
        ),
    ],
)
def test_a_value_of_the_wrong_form_is_reported_where_it_stands(old: str, new: str, problem: str) -> None:
    assert problem in refused(with_line(old, new))


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("load: [100 N, 200 N]", "load: [100 N, 0.1 kN]", "9:19", "load: 100 N is listed twice"),
        ("slip_velocity: 300 mm/s", "slip_velocity: 790 mm/s", "8:20", "leaves 0.01 m/s for the belt"),
        ("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  repeats: 2", "6:12", "a flag needs 3 valid repeats"),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  repeats: {at_least: 5, at_most: 4}",
            "6:12",
            "at_most, 4, is less than at_least, 5",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  until: 2 %\n  repeats: {at_least: 3, at_most: 3}",
            "6:10",
            "until needs 4 repeats to know the repeatability, and at most 3 are made",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  min_valid: 6",
            "6:14",
            "min_valid, 6, is more than repeats, 5",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  extend_to: 20 rev",
            "6:14",
            "extend_to, 20 rev, is to be at least the window, 30 rev",
        ),
        ("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  extend_to: 90 s", "6:14", "in the same unit"),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  temperature_band: 0.5 K",
            "6:21",
            "soak.within, 1 K, is wider than temperature_band, 0.5 K",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 0.8 m/s\n  combine: paper",
            "6:12",
            "combine: paper takes the closest two of 3 repeats, and 5 are asked for (expected repeats: 3)",
        ),
        ("name: load", "name: load\n    repeats: 2", "8:14", "a value without a flag needs 3 valid repeats"),
    ],
)
def test_what_makes_no_sense_is_reported_where_it_stands(old: str, new: str, line: str, said: str) -> None:
    (problem,) = refused(with_line(old, new))
    assert problem.startswith(f"r.yaml:{line}: ")
    assert said in problem


@pytest.mark.parametrize(("said", "kept"), [("", {}), ("combine: mean", {}), ("combine: paper", {"combine": "paper"})])
def test_how_repeats_are_combined_goes_with_the_run_where_it_is_not_the_mean(said: str, kept: dict[str, str]) -> None:
    read = recipe(with_line("wheel_speed: 0.8 m/s", f"wheel_speed: 0.8 m/s\n  repeats: 3\n  {said}"))
    assert metadata_of(read) == kept


def test_fewer_repeats_than_three_are_accepted_with_their_own_min_valid() -> None:
    read = recipe(with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  repeats: 1\n  min_valid: 1"))
    assert read.measure is not None
    assert read.measure.min_valid == 1


@pytest.mark.parametrize(
    ("order", "said"),
    [
        ("{within: shuffled}", "within: shuffled needs a seed"),
        ("{within: snake, seed: 1}", "a seed has no effect"),
        ("{temperature: descending}", "(expected 'ascending')"),
    ],
)
def test_an_order_that_cannot_be_is_refused(order: str, said: str) -> None:
    (problem,) = refused(f"{SMALL}order: {order}\n")
    assert problem.startswith("r.yaml:11:")
    assert said in problem


def test_grids_without_measure_are_refused() -> None:
    (problem,) = refused(with_line("measure:\n  wheel_speed: 0.8 m/s\n", ""))
    assert problem.startswith("r.yaml:5:3: measure is missing")


def test_a_recipe_that_does_nothing_is_refused() -> None:
    assert refused('recipe: x\nspecimens: [{compound: "1#"}]\n') == [
        "r.yaml:1:1: there is nothing to do: neither grids nor pre_grind"
    ]


def test_two_grids_of_one_name_are_refused() -> None:
    second = "  - {name: load, slip_velocity: 100 mm/s, load: 100 N, temperature: 25 degC}\n"
    assert refused(SMALL + second) == ['r.yaml:11:12: there is a grid "load" already']


def test_two_grids_that_measure_a_shared_condition_differently_are_refused() -> None:
    second = "  - {name: b, slip_velocity: 0.3 m/s, load: 100 N, temperature: 25 degC, repeats: 7}\n"
    (problem,) = refused(SMALL + second)
    assert problem.startswith('r.yaml:11:5: shares conditions with grid "load" but measures them differently')


@pytest.mark.parametrize("again", ["name: b, measure_again: true,", "name: b,"])
def test_a_grid_that_measures_its_conditions_again_may_measure_them_differently(again: str) -> None:
    second = f"  - {{{again} slip_velocity: 0.3 m/s, load: 100 N, temperature: 25 degC, repeats: 7}}\n"
    text = SMALL + second
    if "measure_again" not in again:  # the first of the two says it
        text = text.replace("name: load", "name: load\n    measure_again: true")
    assert len(recipe(text).grids) == 2


def test_grids_that_share_nothing_may_be_measured_differently() -> None:
    second = "  - {name: b, slip_velocity: 0.3 m/s, load: 150 N, temperature: 25 degC, repeats: 7}\n"
    assert len(recipe(SMALL + second).grids) == 2


def test_more_conditions_than_a_life_could_measure_are_refused_without_making_them() -> None:
    axis = ", ".join(f"{n} N" for n in range(1, 502))
    speeds = ", ".join(f"{n / 1000:g} m/s" for n in range(100, 400))
    text = with_line("[100 N, 200 N]", f"[{axis}]").replace("300 mm/s", f"[{speeds}]")
    (problem,) = refused(text)
    assert problem == "r.yaml:7:3: 300600 conditions are too many for one recipe (at most 250000)"


def test_form_and_sense_are_reported_together() -> None:
    text = with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  min_valid: 6\n  windw: 30 rev")
    assert [line.split(": ")[0] for line in refused(text + "recipe: again\n")] == [
        "r.yaml:6:14",
        "r.yaml:7:3",
        "r.yaml:13:1",
    ]


@pytest.mark.parametrize("text", ["5\n", "- a\n", "null\n", "just text\n"])
def test_a_file_that_is_no_mapping_is_refused(text: str) -> None:
    assert refused(text) == ["r.yaml:1:1: a recipe is a list of keys: recipe, specimens, measure, grids and others"]
