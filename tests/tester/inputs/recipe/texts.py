"""Recipes as text, for the tests of this package."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from tester.base.source import InvalidSource, read_tree
from tester.inputs.recipe.loader import LoadedRecipe, validated
from tester.inputs.recipe.recipe_part import RecipePart
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.schema import WheelRecipe, for_wheels
from tester.kinds.wheel_on_belt.rig import RigConfig

SMALL = """\
recipe: small
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
grids:
  - name: load
    slip_velocity: 300 mm/s
    load: [100 N, 200 N]
    temperature: [40 degC, 25 degC]
"""

PREPARED = (
    SMALL
    + """\
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
rest: {at_least: 20 min, until: 25 degC, within: 2 degC}
"""
)


def load_recipe(source: Path | str, part: RecipePart, name: str | None = None) -> LoadedRecipe:
    """Read a recipe file (Path) or text (str) without a rig; raises InvalidSource with every problem."""
    tree, problems = read_tree(source, name)
    recipe, more = validated(tree, part)
    if recipe is None or problems or more:
        raise InvalidSource([*problems, *more])
    return LoadedRecipe(recipe, tree)


@cache
def rig(*overrides: str, accept_risk: str = "") -> RigConfig:
    """Return the simulated rig, with overrides as for --set; ``accept_risk`` as for --accept-risk."""
    return RigConfig.of(load_rig("sim", list(overrides), accept_risk))


def real_rig() -> RigConfig:
    """Return a rig like the simulated one, but real: people need time there, and any compound is accepted."""
    return replace(rig(), simulated=False)


def recipe(text: str) -> WheelRecipe:
    """Return a valid recipe."""
    return for_wheels(load_recipe(text, PART, "r.yaml").recipe)


def with_line(old: str, new: str, text: str = SMALL) -> str:
    """Return a recipe text with one piece replaced."""
    assert text.count(old) == 1
    return text.replace(old, new)
