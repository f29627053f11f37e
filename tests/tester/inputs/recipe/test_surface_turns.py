"""Several surfaces in one recipe: one after the other, each named in one place."""

from __future__ import annotations

import pytest

from tester.inputs.recipe.conditions import conditions_of
from tester.inputs.recipe.loader import check
from tester.inputs.recipe.surface_turns import in_turns, surface_among
from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.schema import wheel_settings
from tests.tester.inputs.recipe.texts import SMALL, recipe, rig

BELTS = SMALL.replace("    slip_velocity:", "    surface: [belt A, belt B]\n    slip_velocity:", 1)


def test_the_conditions_of_a_surface_stay_together_in_the_order_of_the_recipe() -> None:
    conditions = conditions_of(recipe(BELTS), wheel_settings)
    belt_among = surface_among(AXES)
    turns = in_turns(conditions, belt_among)
    assert [{belt_among(one.values) for one in turn} for turn in turns] == [{"belt A"}, {"belt B"}]
    assert all([one.row for one in turn] == sorted(one.row for one in turn) for turn in turns)
    assert sum(map(len, turns)) == len(conditions)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BELTS + "abrasive: {name: road}\n", "abrasive: the grids name surfaces (expected one of both)"),
        (
            BELTS + "  - {name: more, slip_velocity: 100 mm/s, load: 100 N, temperature: 40 degC}\n",
            "surface is missing: another grid names its own (expected one in every grid)",
        ),
    ],
)
def test_surfaces_are_named_in_one_place(text: str, message: str) -> None:
    (problem,) = check(text, rig(), PART, "r.yaml")
    assert str(problem).endswith(message)
