"""The surfaces of a recipe, where its grids name several: their order, the step that changes one, faults of naming.

A recipe names its only surface in ``abrasive``, or the surfaces of all grids in their axis ``surface``.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeVar

from tester.base.axes import SURFACE, Axes, AxisValue
from tester.base.source import Location, Problem, Tree
from tester.inputs.recipe.conditions import Condition
from tester.inputs.recipe.plan import Settings, Step

Procedure = TypeVar("Procedure", bound=Settings)


@dataclass(frozen=True, slots=True)
class ChangeSurface(Step):
    """A person puts another surface under the rubber, clean and dry."""

    kind: ClassVar[str] = "cover"
    surface: str


def surface_among(axes: Axes) -> Callable[[tuple[AxisValue, ...]], str]:
    """Return a function that finds the surface among a condition's values, "" where it names none."""
    place = axes.places.get(SURFACE)
    return (lambda values: "") if place is None else (lambda values: str(values[place]))


def in_turns(
    conditions: Sequence[Condition[Procedure]], key: Callable[[tuple[AxisValue, ...]], Hashable]
) -> list[list[Condition[Procedure]]]:
    """Return the conditions of one surface after the other, each in the order of the recipe.

    ``key``: what conditions share that are measured without a change, from their values.
    """
    turns = dict[Hashable, list[Condition[Procedure]]]()
    for condition in conditions:
        turns.setdefault(key(condition.values), []).append(condition)
    return list(turns.values())


def surface_problems(tree: Tree) -> Iterator[Problem]:
    """Yield a problem where a recipe names surfaces in two places, or where one of its grids leaves its own out."""
    top = tree.data if isinstance(tree.data, dict) else {}
    grids = top.get("grids")
    listed = grids if isinstance(grids, list) else []
    named = [isinstance(node, dict) and SURFACE in node for node in listed]
    if not any(named):
        return
    if top.get("abrasive") is not None:
        yield tree.problem(("abrasive",), "abrasive: the grids name surfaces (expected one of both)")
    for index, names in enumerate(named):
        if not names:
            at: Location = ("grids", index)
            yield tree.problem(at, "surface is missing: another grid names its own (expected one in every grid)")
