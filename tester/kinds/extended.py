"""The classes of a kind that extends another kind by a laboratory's own interlock rows or axes (``Kind.extended``).

They are made once for each kind. Their objects are pickled with the kind's name, so that other processes find it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

from tester.base.axes import Axes, Axis
from tester.base.screen import axis_views
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.rig import Rig
from tester.inputs.rig.config import section_of
from tester.inputs.rig.parameter import SECTION
from tester.kinds import find
from tester.machine.interlock_table import InterlockSheet, InterlockTable
from tester.machine.row import Interlock
from tester.machine.served import ServedKind

Rows = tuple[Interlock[Any], ...]


def sheet_with(sheet: InterlockSheet, rows: Rows) -> InterlockSheet:
    """Return a sheet with further rows ahead of its own."""
    return replace(sheet, rows=(*rows, *sheet.rows))


@cache
def rig_with(name: str, base: Any, rows: Rows) -> type[Rig]:
    """Return a rig class with further rows ahead of its table's, and their keys in its section ``interlocks``.

    ``name``: of the kind. Raises TypeError for a rig class without a table to evaluate (``Rig.table``).
    """
    if not isinstance(getattr(base, "table", None), InterlockTable):
        raise TypeError(f"{name}: {base.__name__} has no interlock table that rows could join")
    table = InterlockTable((*rows, *base.table.rows), base.table.operation)
    section = section_of("Section", table.parameters, __name__)

    def reduced(rig: Rig) -> tuple[Any, ...]:
        return _rig_again, (name, *_values_of(rig))

    members: dict[str, Any] = {
        "__module__": __name__,
        "__doc__": base.__doc__,
        "__annotations__": {SECTION: section},
        "__reduce__": reduced,
        "table": table,
        "parameters": table.parameters,
        "watched": table.channels,
        "section": section,
    }
    return dataclass(frozen=True, slots=True, kw_only=True)(type("ExtendedRig", (base,), members))


def _values_of(rig: Any) -> tuple[dict[str, Any], dict[str, float]]:
    section = getattr(rig, SECTION)
    return (
        {field.name: getattr(rig, field.name) for field in fields(rig) if field.name != SECTION},
        {field.name: getattr(section, field.name) for field in fields(section)},
    )


def _rig_again(name: str, values: dict[str, Any], interlocks: dict[str, float]) -> Rig:
    kind: Any = find(name).rig()
    return kind(**values, **{SECTION: kind.section(**interlocks)})


@cache
def recipe_with(name: str, part: RecipePart, further: tuple[Axis, ...]) -> RecipePart:
    """Return a part for recipes with further axes ahead of its own."""
    axes = Axes((*further, *part.axes), blocks=part.axes.blocks)

    def reduced(_: RecipePart) -> tuple[Any, ...]:
        return _recipe_again, (name,)

    members: dict[str, Any] = {"__module__": __name__, "__reduce__": reduced, "kind": name, "axes": axes}
    return type("ExtendedPart", (type(part),), members)()


def _recipe_again(name: str) -> RecipePart:
    part = find(name).recipe
    assert part is not None  # the pickled part came from this kind
    return part()


@cache
def served_with(served: ServedKind, part: RecipePart) -> ServedKind:
    """Return a kind's answers to a service, with the axes of a part for recipes."""
    machine = replace(served.machine, axes=axis_views(part.axes))
    return type("ExtendedService", (type(served),), {"__module__": __name__, "machine": machine})()
