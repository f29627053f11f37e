"""Grids to conditions: what a specimen is measured at, in which order, and what is said of the experiment.

A condition that several grids share is measured once. Blocks of one temperature ascend, because cooling takes far
longer than heating.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from itertools import product
from typing import Generic, NamedTuple, TypeAlias, TypeVar

from tester.analysis import closest, terms
from tester.axes import AxisValue
from tester.recipe.schema import GridModel, MeasureModel, OrderModel, Recipe
from tester.recipe.semantics import axis_values
from tester.recipe.settings import Settings

Procedure = TypeVar("Procedure", bound=Settings)
"""How a condition is measured, as a kind says it."""
BlockValue: TypeAlias = Callable[[tuple[AxisValue, ...]], float]
"""Takes what the axis of blocks is held at out of a condition's values."""


class Condition(NamedTuple, Generic[Procedure]):
    """One condition of a specimen: what is held, its row in the recipe's order (from 1) and its first grid."""

    values: tuple[AxisValue, ...]
    """Of a setpoint: what tells conditions of a specimen apart."""
    row: int
    grid: str
    settings: Procedure


def conditions_of(
    recipe: Recipe, settings: Callable[[MeasureModel, GridModel], Procedure]
) -> list[Condition[Procedure]]:
    """Return a specimen's distinct conditions in the recipe's order: grid after grid, the axis of blocks innermost.

    ``settings``: of the recipe's kind (``RecipePart.settings``), how a grid is measured.
    """
    measure = recipe.measure
    if measure is None:
        return []
    found: dict[tuple[AxisValue, ...], tuple[str, Procedure]] = {}
    for grid in recipe.grids:
        entry = (grid.name, settings(measure, grid))
        for values in product(*axis_values(measure, grid).values()):
            found.setdefault(values, entry)
    return [Condition(values, row, grid, how) for row, (values, (grid, how)) in enumerate(found.items(), start=1)]


def ordered(
    conditions: Sequence[Condition[Procedure]], held: BlockValue, order: OrderModel, specimen: int, replicate: int
) -> list[list[Condition[Procedure]]]:
    """Return the conditions grouped by the axis of blocks, ascending, each group in the order that is asked for."""
    groups: dict[float, list[Condition[Procedure]]] = {}
    for condition in conditions:
        groups.setdefault(held(condition.values), []).append(condition)
    blocks = [groups[temperature] for temperature in sorted(groups)]
    if order.within == "snake":
        # Back and forth: a temperature begins with the setpoints at which the one before it ended.
        return [block[::-1] if number % 2 else block for number, block in enumerate(blocks)]
    if order.within == "shuffled":
        for block in blocks:
            # A stream of its own per block: another temperature in the recipe leaves this one's order alone.
            key = f"{order.seed}/{specimen}/{replicate}/{held(block[0].values)!r}"
            random.Random(key).shuffle(block)
    return blocks


def metadata_of(recipe: Recipe) -> dict[str, str]:
    """Return what the recipe says about the experiment, as text, in columns named with their units."""
    result: dict[str, str] = {}
    if recipe.abrasive is not None:
        result["abrasive"] = recipe.abrasive.name
        if recipe.abrasive.mesh is not None:
            result["abrasive_mesh"] = str(recipe.abrasive.mesh)
        if recipe.abrasive.id is not None:
            result["abrasive_id"] = recipe.abrasive.id
    if recipe.humidity is not None:
        result["humidity_percent"] = f"{recipe.humidity:g}"
    if recipe.ambient is not None:
        result["ambient_c"] = f"{recipe.ambient:g}"
    if recipe.measure is not None and recipe.measure.combine != "mean":
        result[closest.KEY] = recipe.measure.combine
    for key, value in recipe.experiment.items():
        # What replaces a bound of the budget keeps its name: the analysis looks for it.
        result[key if key.startswith(terms.PREFIX) else f"experiment.{key}"] = value
    return result
