"""What a recipe must make sense of by itself, beyond the form of each value; no rig is looked at."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import prod
from typing import NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from tester.recipe.schema import LEAST_SPEED_M_S, MAX_CONDITIONS, GridModel, MeasureModel, Recipe
from tester.recipe.settings import (
    DEFAULT_MIN_VALID,
    LEAST_REPEATS,
    at_most_of,
    extents_of,
    settings_of,
    wheel_speeds_of,
)
from tester.source import Location, Problem, Tree, Value
from tester.units import show, shown

Part = TypeVar("Part", bound=BaseModel)

AXES: tuple[tuple[str, str], ...] = (
    ("slip_velocity", "m/s"),
    ("load", "N"),
    ("sideslip", "deg"),
    ("camber", "deg"),
    ("wheel_speed", "m/s"),
    ("temperature", "degC"),
)
"""The axes of a grid with their units, in the order in which they nest: the columns of the paper's table."""


class Parts(NamedTuple):
    """What of a recipe is valid in itself: the defaults, and grids with their index in the file."""

    measure: MeasureModel | None
    grids: list[tuple[int, GridModel]]


def semantic_problems(recipe: Recipe | None, tree: Tree) -> list[Problem]:
    """Return what does not make sense in the values of a recipe, with positions.

    ``recipe`` None: some of it is not valid; then what is valid in itself is looked at.
    """
    parts = _salvaged(tree) if recipe is None else Parts(recipe.measure, list(enumerate(recipe.grids)))
    problems = [*_whole(recipe, tree), *_names(parts.grids, tree)]
    if parts.measure is not None:
        problems += _measure(parts.measure, None, ("measure",), tree)
        for index, grid in parts.grids:
            at = ("grids", index)
            problems += _measure(parts.measure, grid, at, tree)
            problems += _axes(parts.measure, grid, at, tree)
        problems += _shared(parts.measure, parts.grids, tree)
    return sorted(set(problems))


def _salvaged(tree: Tree) -> Parts:
    """Return the parts of an invalid recipe that are valid but for unknown keys."""
    top = tree.data if isinstance(tree.data, dict) else {}
    listed = top.get("grids")
    grids = [(index, _known(GridModel, one)) for index, one in enumerate(listed if isinstance(listed, list) else [])]
    measure = _known(MeasureModel, top.get("measure"))
    return Parts(measure, [(index, grid) for index, grid in grids if grid is not None])


def _known(model: type[Part], data: Value) -> Part | None:
    """Return a mapping's known keys as a model; None where they are not valid."""
    if not isinstance(data, dict):
        return None
    names = {info.alias or name for name, info in model.model_fields.items()}
    try:
        return model.model_validate({key: value for key, value in data.items() if key in names})
    except ValidationError:
        return None


def axis_values(measure: MeasureModel, grid: GridModel) -> tuple[tuple[float, ...], ...]:
    """Return a grid's axes in the order of ``AXES``, each value once."""
    lists = (
        grid.slip_velocity,
        grid.load,
        grid.sideslip,
        grid.camber,
        wheel_speeds_of(measure, grid),
        grid.temperature,
    )
    return tuple(tuple(dict.fromkeys(values)) for values in lists)


def _whole(recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
    top = tree.data if isinstance(tree.data, dict) else {}
    if top.get("grids") and top.get("measure") is None:
        yield tree.problem(("grids",), 'measure is missing (expected at least "wheel_speed: 0.8 m/s" in it)')
    if not top.get("grids") and top.get("pre_grind") is None:
        yield tree.problem((), "there is nothing to do: neither grids nor pre_grind")
    if recipe is None or recipe.measure is None:
        return
    sizes = [prod(map(len, axis_values(recipe.measure, grid))) for grid in recipe.grids]
    count = sum(sizes) * len(recipe.specimens) * recipe.replicates
    if count > MAX_CONDITIONS:
        yield tree.problem(("grids",), f"{count} conditions are too many for one recipe (at most {MAX_CONDITIONS})")


def _names(grids: list[tuple[int, GridModel]], tree: Tree) -> Iterator[Problem]:
    seen: set[str] = set()
    for index, grid in grids:
        if grid.name in seen:
            yield tree.problem(("grids", index, "name"), f"there is a grid {shown(grid.name)} already")
        seen.add(grid.name)


def _measure(measure: MeasureModel, grid: GridModel | None, at: Location, tree: Tree) -> Iterator[Problem]:
    """Hold repeats, windows and bands against each other, where the place ``at`` says one of them itself."""
    own = measure if grid is None else grid
    said = own.model_fields_set

    def place(*names: str) -> Location:
        return (*at, next((name for name in names if name in said), names[-1]))

    asked, given = own.repeats or measure.repeats, own.min_valid or measure.min_valid
    repeats, most = asked.at_least, at_most_of(asked)
    if said & {"repeats", "min_valid"} and given is not None and given > repeats:
        yield tree.problem(place("min_valid", "repeats"), f"min_valid, {given}, is more than repeats, {repeats}")
    if "repeats" in said and given is None and repeats < DEFAULT_MIN_VALID:
        message = f"a value without a flag needs {DEFAULT_MIN_VALID} valid repeats unless min_valid says otherwise"
        expected = f"(expected repeats of at least {DEFAULT_MIN_VALID}, or min_valid)"
        yield tree.problem((*at, "repeats"), f"{message} {expected}")
    if said & {"repeats", "until"} and (own.until or measure.until) is not None and most < LEAST_REPEATS:
        message = f"until needs {LEAST_REPEATS} repeats to know the repeatability, and at most {most} are made"
        expected = f"(expected at_most: {LEAST_REPEATS} or more in repeats)"
        yield tree.problem(place("until", "repeats"), f"{message} {expected}")
    window, longest = extents_of(measure, grid)
    if said & {"window", "extend_to"} and longest and (longest.unit != window.unit or longest.value < window.value):
        message = f"extend_to, {longest}, is to be at least the window, {window}, in the same unit"
        yield tree.problem(place("extend_to", "window"), message)
    soak, band = own.soak or measure.soak, own.temperature_band or measure.temperature_band
    if said & {"soak", "temperature_band"} and soak.within > band:
        message = f"soak.within, {soak.within:g} K, is wider than temperature_band, {band:g} K"
        yield tree.problem((*place("soak", "temperature_band"), "within"), message)


def _axes(measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
    for name, unit in AXES:
        seen: set[float] = set()
        for index, value in enumerate(getattr(grid, name) or ()):
            if value in seen:
                yield tree.problem((*at, name, index), f"{name}: {show(value, unit)} is listed twice")
            seen.add(value)
    for index, slip in enumerate(grid.slip_velocity):
        for wheel in wheel_speeds_of(measure, grid):
            belt = round(wheel - slip, 9)
            if belt < LEAST_SPEED_M_S:
                message = (
                    f"slip_velocity: {show(slip, 'm/s')} leaves {show(belt, 'm/s')} for the belt at a wheel speed of "
                    f"{show(wheel, 'm/s')} (expected at least {LEAST_SPEED_M_S} m/s: a standing belt is never loaded)"
                )
                yield tree.problem((*at, "slip_velocity", index), message)


def _shared(measure: MeasureModel, grids: list[tuple[int, GridModel]], tree: Tree) -> Iterator[Problem]:
    """Refuse two grids that share a condition and measure it differently: it is measured once."""
    settings = [settings_of(measure, grid) for _, grid in grids]
    if len(set(settings)) < 2:
        return
    axes = [tuple(map(frozenset, axis_values(measure, grid))) for _, grid in grids]
    for first, second in combinations(range(len(grids)), 2):
        shared = all(a & b for a, b in zip(axes[first], axes[second], strict=True))
        if shared and settings[first] != settings[second]:
            message = f"shares conditions with grid {shown(grids[first][1].name)} but measures them differently"
            problem = f"{message}; a shared condition is measured once"
            yield tree.problem(("grids", grids[second][0]), problem)
