"""Pressures in a recipe: a grid's ``pressure`` in place of its ``load``, over the area that the recipe or the rig file
states.

They become loads as soon as the file is read: schema, checks against the rig and the plan know loads alone. A load has
the place of its pressure in the file.
"""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field, ValidationError

from tester.analysis.pressure import LOAD
from tester.base.source import Location, Problem, Tree, Value
from tester.base.units import Quantity, UnitError, as_text
from tester.base.validation import Section, problems_of
from tester.inputs.recipe.axis_lists import Listed
from tester.inputs.rig import Rig
from tester.inputs.rig.contact import LONGEST

PRESSURE: Final = "pressure"
CONTACT: Final = "contact"
AREA: Final = "area"
DIGITS: Final = 9
"""Significant digits of a load made of a pressure: the product's own, without the noise of a float."""
_N_PER_PA_MM2: Final = 1e-6


class ContactSection(Section, frozen=True):
    """What the load is spread over."""

    area: Annotated[float, Quantity("mm2", gt=0, le=1e5)]
    """nominal area of contact of every specimen, in place of the rig file's: load over area is the pressure"""
    source: Annotated[str, Field(max_length=LONGEST)] = ""
    """where the area comes from, such as "die of 10 mm x 10 mm" """


class _Pressures(Section, frozen=True):
    """A grid's pressures, in Pa."""

    pressure: Annotated[list[float], Listed("Pa", gt=0)]


def with_area(tree: Tree, rig: Rig) -> Tree:
    """Return a recipe's tree with the area that counts: its own ``contact``, else that of the rig's file, if any."""
    top = tree.data
    if rig.contact is None or not isinstance(top, dict) or CONTACT in top:
        return tree
    stated: Value = {AREA: as_text(rig.contact.area, "mm2"), "source": rig.contact.source}
    return Tree(tree.name, tree.text, {**top, CONTACT: stated}, tree.positions, tree.keys)


def with_loads(tree: Tree) -> tuple[Tree, list[Problem]]:
    """Return a recipe's tree with the loads of its pressures, and what is wrong with these."""
    top = tree.data
    grids = top.get("grids") if isinstance(top, dict) else None
    if not isinstance(top, dict) or not isinstance(grids, list):
        return tree, []
    problems: list[Problem] = []
    positions, changed = dict(tree.positions), list(grids)
    for index, grid in enumerate(grids):
        at: Location = ("grids", index, PRESSURE)
        if not isinstance(grid, dict) or PRESSURE not in grid:
            continue
        loads, found = _loads(tree, grid, at)
        problems += found
        rest: dict[str, Value] = {key: value for key, value in grid.items() if key != PRESSURE}
        changed[index] = {**rest, LOAD: loads} if loads else rest
        for place in range(len(loads)):
            positions[("grids", index, LOAD, place)] = tree.position((*at, place))
        positions[("grids", index, LOAD)] = tree.position(at)
    return Tree(tree.name, tree.text, {**top, "grids": changed}, positions, tree.keys), problems


def _loads(tree: Tree, grid: dict[str, Value], at: Location) -> tuple[list[Value], list[Problem]]:
    """Return the loads of a grid's pressures as texts, and why there are none."""
    if LOAD in grid:
        return [], [tree.problem(at, f"{PRESSURE}: the grid has a load, too (expected one of both)")]
    below = {place[2:]: where for place, where in tree.positions.items() if place[: len(at)] == at}
    own = Tree(tree.name, tree.text, {PRESSURE: grid[PRESSURE]}, below)
    try:
        pressures_pa = _Pressures.model_validate(own.data).pressure
    except ValidationError as error:
        return [], problems_of(error, own, _Pressures)
    area_mm2 = _area_mm2(tree)
    if area_mm2 is None:
        why = (
            f"no area is known to spread a load over (expected {CONTACT}: {{area: 100 mm2}} in the recipe, that section"
            " with its source in the rig file, or load)"
        )
        return [], [tree.problem(at, f"{PRESSURE}: {why}")]
    return [as_text(float(f"{one * area_mm2 * _N_PER_PA_MM2:.{DIGITS}g}"), "N") for one in pressures_pa], []


def _area_mm2(tree: Tree) -> float | None:
    """Return the recipe's area; None where there is none that can be read."""
    contact = tree.data.get(CONTACT) if isinstance(tree.data, dict) else None
    written = contact.get(AREA) if isinstance(contact, dict) else None
    try:
        return Quantity("mm2", gt=0.0).read(written)
    except UnitError:
        return None
