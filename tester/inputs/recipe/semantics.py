"""Checks that a recipe makes sense by itself, beyond the form of each value; no rig is involved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import prod
from typing import NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from tester.analysis import left_out, terms
from tester.base.axes import Axis, AxisValue, plain
from tester.base.source import Location, Problem, Tree, Value
from tester.base.units import show, shown
from tester.inputs.recipe.axis_lists import MAX_CONDITIONS
from tester.inputs.recipe.grid_settings import (
    DEFAULT_MIN_VALID,
    LEAST_REPEATS,
    at_most_of,
    extents_of,
    values_of,
)
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe, grid_model

Part = TypeVar("Part", bound=BaseModel)


class Parts(NamedTuple):
    """Valid parts of a recipe: the defaults, and grids with their index in the file."""

    measure: MeasureModel | None
    grids: list[tuple[int, GridModel]]


def semantic_problems(recipe: Recipe | None, tree: Tree, part: RecipePart) -> list[Problem]:
    """Return the contradictions in the values of a recipe for a kind of rig, with positions.

    ``recipe`` None: part of it is invalid; then its valid parts are checked.
    """
    parts = _salvaged(tree, part) if recipe is None else Parts(recipe.measure, list(enumerate(recipe.grids)))
    problems = [*_whole(recipe, tree, part), *part.whole(recipe, tree), *_names(parts.grids, tree)]
    problems += _bounds(recipe, tree)
    if parts.measure is not None:
        problems += _measure(parts.measure, None, ("measure",), tree)
        for index, grid in parts.grids:
            at = ("grids", index)
            problems += _measure(parts.measure, grid, at, tree)
            problems += _axes(grid, at, tree)
            problems += part.sense(parts.measure, grid, at, tree)
        problems += _shared(parts.measure, parts.grids, tree, part)
        problems += _combined(parts.measure, parts.grids, tree)
    return sorted(set(problems))


def _salvaged(tree: Tree, part: RecipePart) -> Parts:
    """Return the parts of an invalid recipe that are valid apart from unknown keys."""
    top = tree.data if isinstance(tree.data, dict) else {}
    listed = top.get("grids")
    model = grid_model(part.axes, part.grid)
    grids = [(index, _known(model, entry)) for index, entry in enumerate(listed if isinstance(listed, list) else [])]
    measure = _known(part.measure, top.get("measure"))
    return Parts(measure, [(index, grid) for index, grid in grids if grid is not None])


def _known(model: type[Part], data: Value) -> Part | None:
    """Return a mapping's known keys as a model; None where they are invalid."""
    if not isinstance(data, dict):
        return None
    names = {info.alias or name for name, info in model.model_fields.items()}
    try:
        return model.model_validate({key: value for key, value in data.items() if key in names})
    except ValidationError:
        return None


def axis_values(measure: MeasureModel, grid: GridModel) -> dict[str, tuple[AxisValue, ...]]:
    """Return the values of a grid's axes by name, in the order in which they nest, each value once."""
    return {name: values_of(grid.axes[name], measure, grid) for name in grid.axes.nested}


def _whole(recipe: Recipe | None, tree: Tree, part: RecipePart) -> Iterator[Problem]:
    top = tree.data if isinstance(tree.data, dict) else {}
    if top.get("grids") and top.get("measure") is None:
        yield tree.problem(("grids",), f"measure is missing{_due(part)}")
    if recipe is None or recipe.measure is None:
        return
    sizes = [prod(map(len, axis_values(recipe.measure, grid).values())) for grid in recipe.grids]
    count = sum(sizes) * len(recipe.specimens) * recipe.replicates
    if count > MAX_CONDITIONS:
        yield tree.problem(("grids",), f"{count} conditions are too many for one recipe (at most {MAX_CONDITIONS})")


def _bounds(recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
    """Refuse a replacement of a bound of the budget that is no suitable number."""
    for key, value in (recipe.experiment if recipe is not None else {}).items():
        if key.startswith(terms.PREFIX):
            try:
                terms.setting_of(key, value)
            except ValueError as error:
                yield tree.problem(("experiment", key), str(error))


def _due(part: RecipePart) -> str:
    """Return the least content of ``measure``, in words: an example of each axis that has no default there."""
    due = [axis for axis in part.axes if axis.in_measure]
    examples = ", ".join(f"{axis.name}: {plain(axis.default)} {axis.unit}" for axis in due if axis.default is not None)
    return f' (expected at least "{examples}" in it)' if examples else ""


def _names(grids: list[tuple[int, GridModel]], tree: Tree) -> Iterator[Problem]:
    seen: set[str] = set()
    for index, grid in grids:
        if grid.name in seen:
            yield tree.problem(("grids", index, "name"), f"there is a grid {shown(grid.name)} already")
        seen.add(grid.name)


def _measure(measure: MeasureModel, grid: GridModel | None, at: Location, tree: Tree) -> Iterator[Problem]:
    """Compare repeats, windows and bands with each other, where the place ``at`` states at least one of them itself."""
    section = measure if grid is None else grid
    stated = section.model_fields_set

    def place(*names: str) -> Location:
        return (*at, next((name for name in names if name in stated), names[-1]))

    asked, min_valid = section.repeats or measure.repeats, section.min_valid or measure.min_valid
    repeats, most = asked.at_least, at_most_of(asked)
    if stated & {"repeats", "min_valid"} and min_valid is not None and min_valid > repeats:
        yield tree.problem(place("min_valid", "repeats"), f"min_valid, {min_valid}, is more than repeats, {repeats}")
    if "repeats" in stated and min_valid is None and repeats < DEFAULT_MIN_VALID:
        message = f"a value without a flag needs {DEFAULT_MIN_VALID} valid repeats unless min_valid is lower"
        expected = f"(expected repeats of at least {DEFAULT_MIN_VALID}, or min_valid)"
        yield tree.problem((*at, "repeats"), f"{message} {expected}")
    if stated & {"repeats", "until"} and (section.until or measure.until) is not None and most < LEAST_REPEATS:
        message = f"until needs {LEAST_REPEATS} repeats to know the repeatability, and at most {most} are made"
        expected = f"(expected at_most: {LEAST_REPEATS} or more in repeats)"
        yield tree.problem(place("until", "repeats"), f"{message} {expected}")
    window, longest = extents_of(measure, grid)
    if stated & {"window", "extend_to"} and longest and (longest.unit != window.unit or longest.value < window.value):
        message = f"extend_to, {longest}, is to be at least the window, {window}, in the same unit"
        yield tree.problem(place("extend_to", "window"), message)
    soak, band = section.soak or measure.soak, section.temperature_band or measure.temperature_band
    if stated & {"soak", "temperature_band"} and soak.within > band:
        message = f"soak.within, {soak.within:g} K, is wider than temperature_band, {band:g} K"
        yield tree.problem((*place("soak", "temperature_band"), "within"), message)


def _combined(measure: MeasureModel, grids: list[tuple[int, GridModel]], tree: Tree) -> Iterator[Problem]:
    """Refuse ``combine: paper``, the closest two of three, unless three repeats must count."""
    if measure.combine != "paper":
        return
    used = {(grid.repeats or measure.repeats).at_least for _, grid in grids}
    for count in sorted(used - {left_out.CLOSEST_OF}):
        message = f"combine: paper takes the closest two of {left_out.CLOSEST_OF} repeats, and {count} are asked for"
        yield tree.problem(("measure", "combine"), f"{message} (expected repeats: {left_out.CLOSEST_OF})")


def _axes(grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
    for axis in grid.axes:
        seen: set[AxisValue] = set()
        for index, value in enumerate(listed(grid, axis)):
            if value in seen:
                shown_value = value if isinstance(value, str) else show(value, axis.recipe_unit)
                yield tree.problem((*at, axis.name, index), f"{axis.name}: {shown_value} is listed twice")
            seen.add(value)


def listed(grid: GridModel, axis: Axis) -> Sequence[AxisValue]:
    """Return an axis as a grid lists it; empty where it is left to ``measure``."""
    return getattr(grid, axis.name) or ()


def _shared(
    measure: MeasureModel, grids: list[tuple[int, GridModel]], tree: Tree, part: RecipePart
) -> Iterator[Problem]:
    """Refuse two grids that share a condition and measure it differently: it is measured once."""
    grids = [grid for grid in grids if not grid[1].measure_again]
    settings = [part.settings(measure, grid) for _, grid in grids]
    if len(set(settings)) < 2:
        return
    axes = [
        {name: frozenset(values_of_axis) for name, values_of_axis in axis_values(measure, grid).items()}
        for _, grid in grids
    ]
    for first, second in combinations(range(len(grids)), 2):
        shared = all(values & axes[second][name] for name, values in axes[first].items())
        if shared and settings[first] != settings[second]:
            message = f"shares conditions with grid {shown(grids[first][1].name)} but measures them differently"
            problem = f"{message}; a shared condition is measured once, unless a grid has measure_again: true"
            yield tree.problem(("grids", grids[second][0]), problem)
