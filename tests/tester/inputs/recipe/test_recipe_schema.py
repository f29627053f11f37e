"""Keys of a grid are the names of the kind's axes."""

from __future__ import annotations

from math import prod

import pytest
from pydantic import ValidationError

from tester.base.source import read_tree
from tester.base.validation import problems_of
from tester.inputs.recipe.recipe_schema import grid_model
from tester.inputs.recipe.semantics import axis_values
from tests.tester.inputs.recipe.texts import SMALL, recipe, with_line
from tests.tester.inputs.recipe.track import TRACK, TrackPart


def test_an_axis_of_choices_takes_one_or_a_list_and_may_be_left_out() -> None:
    given = {"name": "a", "track_speed": "1 mm/s", "temperature": ["20 degC"]}
    model = grid_model(TRACK)
    assert model.model_validate(given).model_dump()["interface"] == ["dry"]
    assert model.model_validate(given | {"interface": "wet"}).model_dump()["interface"] == ["wet"]
    found = model.model_validate(given | {"interface": ["talc", "dry"]}).model_dump()
    assert (found["interface"], found["track_speed"]) == (["talc", "dry"], [0.001])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("interface: wett", 'interface: "wett" is not accepted, did you mean wet?'),
        ("interface: 3", "interface: "),
        ("track_speed: 2 m/s", "track_speed: 2 m/s is too large (expected at most 0.01 m/s)"),
        ("slip_velocity: 1 m/s", 'unknown key "slip_velocity"'),
    ],
)
def test_a_value_that_an_axis_refuses_is_reported_with_its_position(line: str, message: str) -> None:
    given = {"name": "name: a", "track_speed": "track_speed: 1 mm/s", "temperature": "temperature: 20 degC"}
    given[line.partition(":")[0]] = line
    text = "recipe: r\nspecimens: [{compound: a}]\ngrids:\n  - " + "\n    ".join(given.values()) + "\n"
    tree, _ = read_tree(text, "r.yaml")
    model = TrackPart().model()
    with pytest.raises(ValidationError) as refused:
        model.model_validate(tree.data)
    problems = [str(one) for one in problems_of(refused.value, tree, model)]
    assert len(problems) == 1 and message in problems[0], problems


def test_a_schema_lists_choices_for_editors() -> None:
    properties = grid_model(TRACK).model_json_schema()["properties"]
    assert properties["interface"]["anyOf"][0] == {"enum": ["dry", "wet", "talc"]}
    assert list(properties)[:4] == ["name", "track_speed", "temperature", "interface"]


def test_an_axis_that_a_grid_leaves_out_is_as_in_measure_or_at_its_default() -> None:
    found = recipe(with_line("wheel_speed: 0.8 m/s", "wheel_speed: 0.6 m/s", SMALL))
    assert found.measure is not None
    values = axis_values(found.measure, found.grids[0])
    assert (values["wheel_speed"], values["camber"], list(values)[-1]) == ((0.6,), (0.0,), "temperature")
    assert prod(map(len, values.values())) == 4
