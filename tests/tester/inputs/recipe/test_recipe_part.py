"""A kind without a wheel brings its part: sections, checks, steps and words of its own, everything else is there."""

from __future__ import annotations

import json
import pickle

import pytest

from tester.base.source import InvalidSource
from tester.base.validation import editor_text
from tester.inputs.recipe.plan import Plan, Stand
from tester.inputs.recipe.plan_text import json_chunks, lines
from tester.inputs.recipe.time_estimate import estimate
from tests.tester.inputs.recipe.texts import load_recipe
from tests.tester.inputs.recipe.track import TrackPart, TrackRecipe

TEXT = """\
recipe: slow
kind: track
specimens:
  - compound: A
run_in: {distance: 50 mm}
measure: {repeats: 3, window: 10 s}
grids:
  - name: all
    track_speed: [0.001 mm/s, 1 mm/s]
    interface: [dry, wet]
    temperature: [20 degC, -10 degC]
"""
PART = TrackPart()


def planned() -> Plan:
    return PART.expand(load_recipe(TEXT, PART).recipe, None)


def test_a_section_of_the_kind_is_read_and_any_other_refused() -> None:
    found = load_recipe(TEXT, PART).recipe
    assert isinstance(found, TrackRecipe) and found.run_in is not None and found.run_in.distance == 50.0
    with pytest.raises(InvalidSource, match='unknown key "pre_grind"'):
        load_recipe(TEXT + "pre_grind: {duration: 1 s}\n", PART)


def test_a_refusal_of_the_kind_is_reported_at_the_value() -> None:
    with pytest.raises(InvalidSource, match=r"r.yaml:9:31: track_speed: 0.006 m/s heats the rubber"):
        load_recipe(TEXT.replace("1 mm/s]", "6 mm/s]"), PART, "r.yaml")


def test_a_recipe_without_grids_has_nothing_to_do() -> None:
    with pytest.raises(InvalidSource, match="there is nothing to do: no grids"):
        load_recipe("recipe: r\nspecimens: [{compound: A}]\n", PART)


def test_conditions_ascend_by_the_axis_of_blocks_with_choices_among_them() -> None:
    held = [step.setpoint for step in planned().conditions()]
    assert [one.number("temperature") for one in held] == [-10.0] * 4 + [20.0] * 4
    assert {one.value("interface") for one in held} == {"dry", "wet"}


def test_a_plan_uses_the_words_of_the_kind() -> None:
    plan = planned()
    told = list(lines(plan, estimate(plan, PART.estimator(None)), PART))  # type: ignore[arg-type]
    assert told[1].split("  ")[1] == "run in 50 mm" and told[-3:] == [
        "conditions        8, 24 repeats",
        "rig time          5 min (4 min to 6 min in 95 % of runs)",
        "sliding distance  0 m",
    ]


def test_the_json_of_a_plan_has_the_axes_and_steps_of_the_kind() -> None:
    plan = planned()
    found = json.loads("".join(json_chunks(plan, estimate(plan, PART.estimator(None)), PART)))  # type: ignore[arg-type]
    first, second = found["steps"][:2]
    assert first == {"kind": "run_in", "index": 0, "seconds": 60.0, "distance_mm": 50.0}
    assert (second["track_speed_m_s"], second["interface"], second["window"]) == (1e-6, "dry", "10 s")
    assert found["kind"] == "track" and not any("wheel" in key for key in (*found, *second))


def test_finished_conditions_are_not_left_to_do() -> None:
    left = PART.remaining(planned(), Stand(frozenset({1, 2, 3})))
    assert [one.condition for one in left.conditions()] == [4, 5, 6, 7, 8]


def test_a_recipe_goes_to_another_process_and_is_of_the_same_class_there() -> None:
    found = load_recipe(TEXT, PART).recipe
    again = pickle.loads(pickle.dumps(found))  # noqa: S301 - our own
    assert again == found and type(again) is type(found)


def test_editors_get_a_schema_with_the_sections_of_the_kind() -> None:
    properties = json.loads(editor_text(PART.model()))["properties"]
    assert "run_in" in properties and "pre_grind" not in properties
    assert properties["kind"]["default"] == "track"
