"""Recipes as files: form, defaults and sense, each problem with its position."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import recipes
from tester.base.source import InvalidSource
from tester.inputs.recipe.conditions import metadata_of
from tester.inputs.recipe.loader import check, load_checked
from tester.inputs.recipe.recipe_schema import Extent
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import PREPARED, SMALL, load_recipe, real_rig, recipe, rig, with_line


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


def test_omitted_keys_have_the_documented_defaults() -> None:
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
            "load, temperature, sideslip, camber, wheel_speed, surface, repeats, until, min_valid, window, extend_to, "
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
def test_a_value_of_the_wrong_form_is_reported_with_its_position(old: str, new: str, problem: str) -> None:
    assert problem in refused(with_line(old, new))


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
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
def test_nonsense_is_reported_with_its_position(old: str, new: str, line: str, message: str) -> None:
    (problem,) = refused(with_line(old, new))
    assert problem.startswith(f"r.yaml:{line}: ")
    assert message in problem


@pytest.mark.parametrize(
    ("message", "kept"), [("", {}), ("combine: mean", {}), ("combine: paper", {"combine": "paper"})]
)
def test_how_repeats_are_combined_goes_with_the_run_where_it_is_not_the_mean(
    message: str, kept: dict[str, str]
) -> None:
    read = recipe(with_line("wheel_speed: 0.8 m/s", f"wheel_speed: 0.8 m/s\n  repeats: 3\n  {message}"))
    assert metadata_of(read) == kept


def test_fewer_repeats_than_three_are_accepted_with_their_own_min_valid() -> None:
    read = recipe(with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.8 m/s\n  repeats: 1\n  min_valid: 1"))
    assert read.measure is not None
    assert read.measure.min_valid == 1


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ("{within: shuffled}", "within: shuffled needs a seed"),
        ("{within: snake, seed: 1}", "a seed has no effect"),
        ("{temperature: descending}", "(expected 'ascending')"),
    ],
)
def test_an_order_that_cannot_be_is_refused(order: str, message: str) -> None:
    (problem,) = refused(f"{SMALL}order: {order}\n")
    assert problem.startswith("r.yaml:11:")
    assert message in problem


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
    if "measure_again" not in again:  # the first of the two reports it
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


FROM_RIG = 'of rig "simulated rubber friction tester")'


def problems(text: str, *overrides: str) -> list[str]:
    return [str(problem) for problem in check(text, rig(*overrides), PART, "r.yaml")]


def test_a_recipe_within_the_limits_has_no_problems() -> None:
    assert problems(PREPARED) == []


def test_checking_returns_the_recipe_with_its_text() -> None:
    loaded = load_checked(PREPARED, rig(), PART, "r.yaml")
    assert (loaded.recipe.recipe, loaded.tree.text) == ("small", PREPARED)


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        (
            "200 N]",
            "441 N]",
            f"r.yaml:9:19: load: 441 N is more than the rig allows (limit 440 N: limits.load {FROM_RIG}",
        ),
        (
            "[40 degC, 25 degC]",
            "[40 degC, 94 degC]",
            "r.yaml:10:28: temperature: 94 degC with its band of 2 K is hotter than the rig allows rubber"
            f" (limit 95 degC: limits.surface {FROM_RIG}",
        ),
        (
            "[40 degC, 25 degC]",
            "[20 degC, 25 degC]",
            "r.yaml:10:19: temperature: 20 degC with its band of 2 K is below ambient, and the rig cannot cool"
            ' (23 degC: ambient of rig "simulated rubber friction tester")',
        ),
        (
            "name: load",
            "name: load\n    sideslip: [0 deg, -31 deg]",
            f"r.yaml:8:23: sideslip: -31 deg is more than the rig allows (limit 30 deg: limits.sideslip {FROM_RIG}",
        ),
        (
            "name: load",
            "name: load\n    camber: 11 deg",
            f"r.yaml:8:13: camber: 11 deg is more than the rig allows (limit 10 deg: limits.camber {FROM_RIG}",
        ),
        (
            "wheel_speed: 0.8 m/s",
            "wheel_speed: 1.2 m/s",
            "r.yaml:5:16: wheel_speed: 1.2 m/s is more than the rig allows"
            f" (limit 1.1 m/s: limits.wheel_speed {FROM_RIG}",
        ),
        (
            "slip_velocity: 300 mm/s",
            "slip_velocity: [0.3 m/s, -0.55 m/s]",
            "r.yaml:8:30: slip_velocity: -0.55 m/s at a wheel speed of 0.8 m/s needs 1.35 m/s of the belt"
            f" (limit 1.3 m/s: limits.belt_speed {FROM_RIG}",
        ),
        (
            "slip_velocity: 300 mm/s",
            "slip_velocity: 650 mm/s",
            "r.yaml:8:20: slip_velocity: 0.65 m/s at a wheel speed of 0.8 m/s is more than is ever loaded"
            f" (limit 0.6 m/s: interlocks.max_slip {FROM_RIG}",
        ),
    ],
)
def test_a_value_beyond_the_rig_is_reported_with_the_source_of_the_limit(old: str, new: str, problem: str) -> None:
    assert problem in problems(with_line(old, new))


def test_friction_heat_beyond_the_limit_names_the_worst_place() -> None:
    text = SMALL.replace('"1#"', '"3#"').replace("200 N]", "400 N]").replace("300 mm/s", "[100 mm/s, 500 mm/s]")
    text = text.replace("[40 degC, 25 degC]", "[40 degC, 70 degC]")
    (problem,) = problems(text)
    assert problem.startswith("r.yaml:9:19: load: 400 N makes ")
    assert 'W of friction heat at 0.5 m/s of slip with "3#" at 72 degC (limit 350 W: limits.slip_power' in problem


def test_an_angle_on_an_axis_that_is_set_by_hand_is_refused() -> None:
    by_hand = rig()
    by_hand = replace(by_hand, axes=replace(by_hand.axes, sideslip=None))
    text = SMALL.replace("name: load", "name: load\n    sideslip: [0 deg, 10 deg]")
    (problem,) = [str(one) for one in check(text, by_hand, PART, "r.yaml")]
    assert problem.startswith("r.yaml:8:23: sideslip: 10 deg needs a driven axis; this rig's is set by hand")


def test_a_compound_without_a_model_has_no_power_to_check_on_a_real_rig() -> None:
    text = SMALL.replace('"1#"', "EPDM").replace("300 mm/s", "500 mm/s").replace("200 N]", "430 N]")
    assert check(text, real_rig(), PART, "r.yaml") == []


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        (
            "200 N]",
            "431 N]",
            "r.yaml:9:19: load: 431 N is too near to limits.load, 440 N, to be held (expected at most 430 N: 10 N of"
            f" runout below limits.load {FROM_RIG}",
        ),
        (
            "[40 degC, 25 degC]",
            "[40 degC, 91 degC]",
            "r.yaml:10:28: temperature: 91 degC with its band of 2 K leaves less than 3 K, by which a burst overshoots,"
            f" to what rubber may be (limit 95 degC: limits.surface {FROM_RIG}",
        ),
        (
            "slip_velocity: 300 mm/s",
            "slip_velocity: 595 mm/s",
            "r.yaml:8:20: slip_velocity: 0.595 m/s at a wheel speed of 0.8 m/s leaves less than 0.01005 m/s, by which"
            " the speeds may be off (gates.speed), to what is ever loaded"
            f" (limit 0.6 m/s: interlocks.max_slip {FROM_RIG}",
        ),
    ],
)
def test_a_value_that_would_trip_at_a_limit_is_refused_before_it(old: str, new: str, problem: str) -> None:
    assert problem in problems(with_line(old, new))


def test_friction_heat_leaves_room_for_the_scatter_of_friction() -> None:
    text = SMALL.replace('"1#"', '"3#"').replace("200 N]", "430 N]").replace("[40 degC, 25 degC]", "[85 degC]")
    (problem,) = problems(text.replace("300 mm/s", "430 mm/s"))
    assert "and with the scatter of friction 15 % more (limit 350 W: limits.slip_power" in problem
    assert problems(text.replace("300 mm/s", "410 mm/s")) == []


def test_friction_heat_is_that_of_the_worst_temperature_within_the_band() -> None:
    text = SMALL.replace('"1#"', '"3#"').replace("200 N]", "430 N]").replace("[40 degC, 25 degC]", "[85 degC]")
    (problem,) = problems(text.replace("300 mm/s", "420 mm/s"))
    assert '"3#" at 83 degC' in problem


def test_a_temperature_whose_hub_would_leave_too_little_to_harm_is_refused() -> None:
    (problem,) = problems(SMALL.replace("[40 degC, 25 degC]", "[88 degC]"))
    assert "88 degC with its band of 2 K needs a hub of 142 degC, hotter than the jacket may get" in problem


def test_pre_grinding_has_the_same_limits() -> None:
    text = PREPARED.replace("belt_speed: 0.6 m/s, load: 200 N", "belt_speed: 1.4 m/s, load: 460 N")
    found = problems(text)
    assert [line.split(": ")[1] for line in found] == ["belt_speed", "load"]
    assert all(line.startswith("r.yaml:11:") for line in found)


def test_a_load_too_near_to_touching_is_reported_with_the_least_and_its_source() -> None:
    assert problems(with_line("[100 N, 200 N]", "[5 N, 14.9 N, 15 N]")) == [
        f"r.yaml:9:{column}: load: {load} is too near to touching, which is 10 N, to be held"
        f" (expected at least 15 N: 1.5 x loops.load.touch_load {FROM_RIG}"
        for column, load in ((12, "5 N"), (17, "14.9 N"))
    ]


def test_the_least_load_is_that_of_the_rig() -> None:
    (problem,) = problems(SMALL.replace("200 N]", "25 N]"), "loops.load.touch_load=20 N")
    assert problem.startswith("r.yaml:9:") and "25 N is too near to touching" in problem and "at least 30 N" in problem


def test_pre_grinding_has_the_same_least_load() -> None:
    (problem,) = problems(PREPARED.replace("load: 200 N", "load: 10 N"))
    assert problem.startswith("r.yaml:11:62: load: 10 N is too near to touching")


@pytest.mark.parametrize("load", ["0 N", "-10 N"])
def test_an_invalid_load_is_reported_once(load: str) -> None:
    (problem,) = problems(with_line("[100 N, 200 N]", load))
    assert "expected more than 0 N" in problem


def test_a_rest_that_ambient_never_lets_end_is_reported() -> None:
    (problem,) = problems(PREPARED, "sim.ambient=27")
    assert problem.startswith("r.yaml:12:33: until: a wheel at rest does not cool to 27 degC (27 degC: ambient of rig")


def test_the_recipes_own_ambient_comes_first() -> None:
    assert problems(PREPARED + "ambient: 20 degC\n", "sim.ambient=27") == []


def test_a_limit_that_was_overridden_is_the_limit() -> None:
    (problem,) = problems(SMALL, "limits.load=150")
    assert "200 N is more than the rig allows (limit 150 N" in problem


def test_a_grid_with_a_condition_that_wears_a_wheel_out_is_reported() -> None:
    (problem,) = problems(PREPARED + "wheel: {replace_after: 0.2 mm}\n")
    assert problem.startswith("r.yaml:7:5: a condition of this grid wears ")
    assert "more than replace_after, 0.2 mm" in problem


def test_more_wear_than_there_is_rubber_is_reported() -> None:
    (problem,) = problems(PREPARED + "wheel: {replace_after: 17 mm}\n")
    assert problem.endswith("replace_after: 17 mm is more rubber than there is, 16 mm")


MISTAKES = """\
recipe: five mistakes
recipe: twice
specimens:
  - compound: "1#"
measure:
  wheel_speed: 800
  windw: 30 rev
  min_valid: 9
grids:
  - name: load
    slip_velocity: 300 mm/s
    load: [100 N, 500 N]
    temperature: [25 degC, 99 degC]
order: {within: random}
"""


def test_mistakes_of_every_kind_are_reported_at_once_with_line_and_column() -> None:
    assert [line.split(": ")[0] for line in problems(MISTAKES)] == [
        "r.yaml:2:1",
        "r.yaml:6:16",
        "r.yaml:7:3",
        "r.yaml:12:19",
        "r.yaml:13:28",
        "r.yaml:14:17",
    ]


def test_limits_are_found_in_a_grid_whose_other_values_are_wrong() -> None:
    text = with_line("[100 N, 200 N]", "[100, 600 N, oops]")
    assert [line.split(": ")[0] for line in problems(text)] == ["r.yaml:9:12", "r.yaml:9:17", "r.yaml:9:24"]


def test_every_packaged_recipe_can_be_run_on_the_simulated_rig() -> None:
    other_rigs = {"greta", "grosch", "pin-on-disc", "pressure"}
    names = [name for name in recipes.names() if name not in other_rigs]
    assert {name: check(recipes.find(name), rig(), PART) for name in names} == {name: [] for name in names}


def test_the_hot_rig_is_not_refused_before_it_has_tried() -> None:
    hot = rig("sim.friction_heat_fraction=0.5", "sim.belt_conductance=0.3")
    assert check(recipes.find("table2"), hot, PART) == []


def test_a_syntax_error_is_the_only_problem() -> None:
    assert problems("recipe: [x\nspecimens: {")[0].startswith("r.yaml:2:10: not YAML")


fragments = st.sampled_from(
    [
        "[",
        "]",
        "{",
        "}",
        ":",
        "-",
        "\n",
        "  ",
        "#",
        '"',
        "degC",
        "300 mm/s",
        "null",
        "1e9 N",
        "load",
        "grids:",
        "*a",
        "&a",
        "é",
    ]
)


@given(st.integers(0, len(PREPARED)), st.integers(0, 12), fragments)
@settings(max_examples=150, deadline=None)
def test_any_damage_to_a_recipe_is_harmless_or_reported(place: int, cut: int, fragment: str) -> None:
    damaged = PREPARED[:place] + fragment + PREPARED[place + cut :]
    try:
        load_checked(damaged, rig(), PART, "r.yaml")
    except InvalidSource as error:
        assert error.problems
        assert all(problem.line >= 1 and problem.column >= 1 for problem in error.problems)


values = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 5) | st.sampled_from(["", "x", "100 N", "25 degC", "0.3 m/s", "1#"]),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["load", "temperature", "name", "compound", "until", "x"]), inner, max_size=3)
    ),
    max_leaves=6,
)
KEYS = [
    "recipe",
    "specimens",
    "measure",
    "grids",
    "pre_grind",
    "rest",
    "order",
    "wheel",
    "steps",
    "experiment",
    "ambient",
]


@given(st.dictionaries(st.sampled_from(KEYS), values, max_size=6))
@settings(max_examples=200, deadline=None)
def test_any_tree_is_a_recipe_or_reported(tree: dict[str, object]) -> None:
    import json

    try:
        load_checked(json.dumps(tree), rig(), PART, "r.yaml")
    except InvalidSource as error:
        assert error.problems


def test_a_recipe_for_a_rig_of_another_kind_is_refused_for_that_alone() -> None:
    text = "kind: specimen_on_track\ngrids: [{name: slow, track_speed: 1 mm/s}]\n" + SMALL.partition("grids:")[0]
    (problem,) = check(text, rig(), PART, "r.yaml")
    told = 'the recipe is for a rig of kind "specimen_on_track"'
    assert str(problem) == f'r.yaml:1:7: kind: {told}, rig "{rig().name}" is of kind wheel_on_belt'


def test_a_recipe_may_state_the_kind_of_its_rig() -> None:
    assert check("kind: wheel_on_belt\n" + SMALL, rig(), PART) == []


@pytest.mark.parametrize("value", ["much", "-0.1"])
def test_the_replacement_of_a_bound_of_the_budget_is_a_number(value: str) -> None:
    said = f"experiment: {{uncertainty.misalignment_deg: {value}}}\n"
    with pytest.raises(InvalidSource, match=r"misalignment_deg: .* is not a number >= 0"):
        load_checked(SMALL + said, rig(), PART, "r.yaml")


def test_a_setting_that_no_term_of_the_budget_has_is_refused_with_the_nearest() -> None:
    said = "experiment: {uncertainty.misalignment: 0.1}\n"
    with pytest.raises(InvalidSource, match=r"no term of this rig's budget .* mean uncertainty.misalignment_deg\?"):
        load_checked(SMALL + said, rig(), PART, "r.yaml")
