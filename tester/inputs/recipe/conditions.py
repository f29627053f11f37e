"""From grids to conditions: the setpoints of a specimen, their order, and the metadata of the experiment.

A condition that several grids share is measured once, unless a grid has ``measure_again``. Blocks of one temperature
ascend, because cooling takes far longer than heating.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Final, Generic, NamedTuple, TypeAlias, TypeVar

from tester.analysis import left_out, terms
from tester.analysis.pressure import area_metadata
from tester.base.axes import AxisValue, Setpoint, condition_words
from tester.inputs.recipe.plan import Settings
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, OrderModel, Recipe
from tester.inputs.recipe.semantics import axis_values
from tester.inputs.recipe.specimen_section import specimen_metadata

MERGED_SHOWN: Final = 3
"""Most conditions that a sentence about two grids lists; it counts the rest."""
Procedure = TypeVar("Procedure", bound=Settings)
"""A kind's description of how a condition is measured."""
BlockValue: TypeAlias = Callable[[tuple[AxisValue, ...]], float]
"""Returns the value of the axis of blocks among a condition's values."""


class Condition(NamedTuple, Generic[Procedure]):
    """One condition of a specimen: its values, its row in the recipe's order (from 1) and its first grid."""

    values: tuple[AxisValue, ...]
    """Values of a setpoint, which distinguish the conditions of a specimen."""
    row: int
    grid: str
    settings: Procedure


def conditions_of(
    recipe: Recipe, settings: Callable[[MeasureModel, GridModel], Procedure]
) -> list[Condition[Procedure]]:
    """Return a specimen's conditions in the recipe's order: grid after grid, the axis of blocks innermost.

    Each setpoint occurs once, except in a grid with ``measure_again``. ``settings`` is that of the recipe's kind
    (``RecipePart.settings``): how a grid is measured.
    """
    measure = recipe.measure
    if measure is None:
        return []
    conditions: list[Condition[Procedure]] = []
    seen: set[tuple[AxisValue, ...]] = set()
    for grid in recipe.grids:
        how = settings(measure, grid)
        for values in product(*axis_values(measure, grid).values()):
            if not grid.measure_again:
                if values in seen:
                    continue
                seen.add(values)
            conditions.append(Condition(values, len(conditions) + 1, grid.name, how))
    return conditions


class MergedConditions(NamedTuple):
    """Conditions of a grid that also occur in an earlier one, ``measured_in``, and are measured only there."""

    grid: str
    measured_in: str
    conditions: tuple[Setpoint, ...]
    """Setpoints without a compound."""

    def sentence(self) -> str:
        """Return a sentence that lists the merged conditions and names the recipe key that measures them again."""
        count = len(self.conditions)
        what, them = ("1 condition", "it") if count == 1 else (f"{count} conditions", "them")
        listed = [condition_words(condition, compound=False) for condition in self.conditions[:MERGED_SHOWN]]
        more = [f"{count - MERGED_SHOWN} more"] if count > MERGED_SHOWN else []
        return (
            f"grid {self.grid} shares {what} with grid {self.measured_in}, which alone measures {them}: "
            f"{'; '.join([*listed, *more])} (measure_again: true in the grid measures {them} again)"
        )

    def as_data(self) -> dict[str, object]:
        """Return the same as plain data: names of the grids, and the setpoints by field."""
        setpoints = [
            {axis.field: condition.value(axis.name) for axis in condition.axes} for condition in self.conditions
        ]
        return {"grid": self.grid, "measured_in": self.measured_in, "conditions": setpoints}


def merged_of(recipe: Recipe) -> Iterator[MergedConditions]:
    """Yield the conditions of each grid that are measured in an earlier one."""
    measure, grids = recipe.measure, [grid for grid in recipe.grids if not grid.measure_again]
    if measure is None or len(grids) < 2:
        return
    first: dict[tuple[AxisValue, ...], str] = {}
    for grid in grids:
        shared: dict[str, list[Setpoint]] = {}
        for values in product(*axis_values(measure, grid).values()):
            measured_in = first.setdefault(values, grid.name)
            if measured_in != grid.name:
                shared.setdefault(measured_in, []).append(Setpoint("", values, recipe.axes))
        yield from (MergedConditions(grid.name, name, tuple(listed)) for name, listed in shared.items())


def ordered(
    conditions: Sequence[Condition[Procedure]], held: BlockValue, order: OrderModel, specimen: int, replicate: int
) -> list[list[Condition[Procedure]]]:
    """Return the conditions grouped by the axis of blocks, ascending, each group in the order of the recipe."""
    groups: dict[float, list[Condition[Procedure]]] = {}
    for condition in conditions:
        groups.setdefault(held(condition.values), []).append(condition)
    blocks = [groups[temperature] for temperature in sorted(groups)]
    if order.within == "snake":
        # Back and forth: a temperature begins with the setpoints at which the one before it ended.
        return [block[::-1] if number % 2 else block for number, block in enumerate(blocks)]
    if order.within == "shuffled":
        for block in blocks:
            # A random stream of its own for each block: another temperature in the recipe leaves this order unchanged.
            key = f"{order.seed}/{specimen}/{replicate}/{held(block[0].values)!r}"
            random.Random(key).shuffle(block)
    return blocks


def metadata_of(recipe: Recipe) -> dict[str, str]:
    """Return the recipe's metadata of the experiment, as text, in columns named with their units."""
    result: dict[str, str] = {}
    if recipe.abrasive is not None:
        result["abrasive"] = recipe.abrasive.name
        if recipe.abrasive.mesh is not None:
            result["abrasive_mesh"] = str(recipe.abrasive.mesh)
        if recipe.abrasive.id is not None:
            result["abrasive_id"] = recipe.abrasive.id
    if recipe.contact is not None:
        result |= area_metadata(recipe.contact.area, recipe.contact.source)
    result |= specimen_metadata(recipe)
    if recipe.humidity is not None:
        result["humidity_percent"] = f"{recipe.humidity:g}"
    if recipe.ambient is not None:
        result["ambient_c"] = f"{recipe.ambient:g}"
    if recipe.measure is not None and recipe.measure.combine != "mean":
        result[left_out.COMBINE] = recipe.measure.combine
    for key, value in recipe.experiment.items():
        # A key that replaces a bound of the budget keeps its name: the analysis looks for it.
        result[key if key.startswith(terms.PREFIX) else f"experiment.{key}"] = value
    return result
