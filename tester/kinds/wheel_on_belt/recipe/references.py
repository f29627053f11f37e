"""The reference condition of this machine: its setpoint, and checks of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final, cast

from tester.analysis.left_out import CLOSEST_OF
from tester.base.source import Location, Problem, Tree
from tester.base.units import shown
from tester.inputs.recipe.conditions import Condition
from tester.inputs.recipe.recipe_schema import grid_model
from tester.inputs.recipe.reference_section import REFERENCE
from tester.inputs.recipe.semantics import axis_values
from tester.kinds.wheel_on_belt.recipe.schema import (
    REFERENCE_HELD,
    ReferenceModel,
    WheelGrid,
    WheelRecipe,
    WheelSettings,
    wheel_settings,
)

AT: Final[Location] = (REFERENCE,)
"""Its place in a recipe."""


def as_grid(reference: ReferenceModel, recipe: WheelRecipe) -> WheelGrid:
    """Return a reference condition as a grid of one condition."""
    values = {name: [getattr(reference, name)] for name in REFERENCE_HELD}
    speed = None if reference.wheel_speed is None else [reference.wheel_speed]
    others: dict[str, Any] = {"name": REFERENCE, "wheel_speed": speed, "repeats": reference.repeats}
    return cast("WheelGrid", grid_model(recipe.axes, recipe.part.grid).model_construct(**values, **others))


def reference_condition(recipe: WheelRecipe) -> Condition[WheelSettings] | None:
    """Return a recipe's reference condition; None where it has none. Its row is for the plan to give."""
    if recipe.reference is None or recipe.measure is None or not recipe.grids:
        return None
    grid = as_grid(recipe.reference, recipe)
    (values,) = zip(*axis_values(recipe.measure, grid).values(), strict=True)
    how = wheel_settings(recipe.measure, grid)
    # It is there to be compared with itself: fewer repeats are no reason for a flag, and each gets as many.
    how = replace(how, min_valid=min(how.min_valid, how.repeats), until_percent=None)
    return Condition(values, 0, REFERENCE, how)


def reference_problems(recipe: WheelRecipe, tree: Tree) -> Iterator[Problem]:
    """Yield what makes no sense in a recipe's reference condition, whatever the rig."""
    reference, measure = recipe.reference, recipe.measure
    if reference is None:
        return
    if not recipe.grids or measure is None:
        yield tree.problem(AT, "reference: there is nothing to measure between references (expected grids)")
        return
    for index, grid in enumerate(recipe.grids):
        if grid.name == REFERENCE:
            message = f"a grid {shown(REFERENCE)} would be taken for the reference condition (expected another name)"
            yield tree.problem(("grids", index, "name"), message)
    if reference.compound is not None and reference.wheel is None:
        message = "compound: a reference on whichever wheel is on has that wheel's compound (expected wheel with it)"
        yield tree.problem((*AT, "compound"), message)
    if measure.combine == "paper" and reference.repeats is not None and reference.repeats.at_least != CLOSEST_OF:
        message = f"repeats: combine: paper takes the closest two of {CLOSEST_OF} (expected {CLOSEST_OF})"
        yield tree.problem((*AT, "repeats"), message)
    yield from recipe.part.sense(measure, as_grid(reference, recipe), AT, tree)
