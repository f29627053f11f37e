"""Rows evaluated only after a change of their inputs, compared with their evaluation in every scan."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from math import inf, nan
from typing import Any

from tester.machine.interlock_table import InterlockTable, Loops, RigTable, written
from tester.machine.row import SELDOM

OWN = ("seen", "seen_held")
"""Fields of the inputs that no row may read."""


def places(parts: Sequence[Any]) -> list[tuple[Any, str, object]]:
    """Return every number, state and text of the inputs of a kind's rows: the object, the field's name, its value."""
    return [
        (part, field.name, getattr(part, field.name))
        for part in parts
        if is_dataclass(part)
        for field in fields(part)
        if field.name not in OWN and isinstance(getattr(part, field.name), bool | int | float | str)
    ]


def other(value: object, numbers: random.Random) -> object:
    """Return another value of the same type, as a rig may report it."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return "" if value else "faulty"
    number = float(value) if isinstance(value, int | float) else 0.0
    return numbers.choice([nan, inf, -inf, 0.0, 100.0, -100.0, number + 1.0, number - 1.0])


def expect_every_scan(
    table: InterlockTable, view: Any, parts: Sequence[Any], also: Callable[[random.Random], None] | None = None
) -> None:
    """Change whatever the inputs hold, a value a scan: each row holds in every scan in which its condition does,
    and both ways of comparing rows agree.

    ``parts``: the objects of the inputs; ``also``: changes everything else.
    """
    rows = [row for row in table.rows if row.when is SELDOM]
    each = [([row], Loops([row], view.parameters).any_holds, written([row], view.parameters)) for row in table.rows]
    each.append((list(table.rows), Loops(table.rows, view.parameters).any_holds, written(table.rows, view.parameters)))
    numbers, evaluated = random.Random(1), RigTable(table, view.parameters)
    usual = places(parts)
    found: set[str] = set()
    for _ in range(1500):
        for part, name, value in usual:  # among many faults no row depends on one value alone
            setattr(part, name, value)
        for _ in range(10):
            part, name, value = numbers.choice(usual)
            setattr(part, name, other(value, numbers))
            if also is not None:
                also(numbers)
            held = table.names_of(evaluated.held(view))
            expected = {row.name for row in rows if row.holds(view)}
            assert expected == {row.name for row in rows if row.name in held}
            found |= expected
        for some, looped, straight in each:
            assert looped(view) == straight(view) == any(row.holds(view) for row in some)
    assert found == {row.name for row in rows}
