"""What a kind defines, as rows of the record: channels, axes, budget. Reading a stored run needs no code of its kind.

Each axis of a condition's setpoint becomes a column of ``condition``; the mean of each averaged channel becomes a
column of ``repeat``.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from math import inf, isfinite
from typing import Any, cast

from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Acts, Term
from tester.base.axes import Axes, AxisValue, Setpoint, axes_from
from tester.base.quantities import Channel, Figure, Quantities, Roles, Screen
from tester.store.chain import Cell
from tester.store.sql import Statement, columns_in, insert

COLUMNS = ("position", "name", "unit", "label", "source", "mean", "decimals", "whole", "shown_name", "shown_unit",
           "scale", "role", "block", "screen")  # fmt: skip
"""Columns of the table ``channel``. ``role``: words of _ROLES, joined; ``block``: belongs to the role ``turn``;
``screen``: JSON.
"""

_FIGURES = ("low", "high", "limit", "lower")
_ALONG, _ACROSS, _NORMAL, _TURN, _TEMPERATURE, _SLIDING, _DEPTH, _CORE = _ROLES = (
    "along", "across", "normal", "turn", "temperature", "sliding", "depth", "core",
)  # fmt: skip


def channel_rows(quantities: Quantities) -> list[dict[str, Cell]]:
    """Return a row of the table ``channel`` for each channel, in order."""
    roles = quantities.roles
    by_role = {
        _ALONG: roles.friction[0],
        _ACROSS: roles.friction[1] if len(roles.friction) > 1 else "",
        _NORMAL: roles.normal,
        _TURN: roles.turn,
        _TEMPERATURE: roles.temperature,
        _SLIDING: roles.sliding,
        _DEPTH: roles.depth,
        _CORE: roles.core,
    }
    rows: list[dict[str, Cell]] = []
    for position, quantity in enumerate(quantities):
        row: dict[str, Cell] = columns_in(quantity) | {
            "position": position,
            "shown_name": quantity.column,
            "role": " ".join(role for role, name in by_role.items() if name == quantity.name),
            "block": roles.block if quantity.name == roles.turn else None,
            "screen": "" if quantity.screen is None else json.dumps(asdict(quantity.screen)),
        }
        rows.append({name: row[name] for name in COLUMNS})
    return rows


def quantities_of(rows: Iterable[Mapping[str, object]]) -> Quantities:
    """Return the channels from their rows, in order; raises ValueError, KeyError, TypeError for unusable rows."""
    listed = list(rows)
    holder = {role: str(row["name"]) for row in listed for role in str(row["role"]).split()}
    blocks = [float(str(row["block"])) for row in listed if row["block"] is not None]
    along = [holder[role] for role in (_ALONG, _ACROSS) if role in holder]
    further = {role: holder.get(role, "") for role in (_TEMPERATURE, _SLIDING, _DEPTH, _CORE)}
    roles = Roles(tuple(along), holder[_NORMAL], holder[_TURN], blocks[0], **further)
    return Quantities(tuple(map(_channel, listed)), roles)


def _channel(row: Mapping[str, object]) -> Channel:
    return Channel(
        name=str(row["name"]),
        unit=str(row["unit"]),
        label=str(row["label"]),
        source=str(row["source"]),
        mean=int(str(row["mean"])),
        decimals=int(str(row["decimals"])),
        whole=bool(row["whole"]),
        column=str(row["shown_name"]),
        shown_unit=str(row["shown_unit"]),
        scale=float(str(row["scale"])),
        screen=_screen(str(row["screen"])),
    )


def _screen(text: str) -> Screen | None:
    if not text:
        return None
    stored = json.loads(text)
    figures: dict[str, Any] = {name: Figure(**stored[name]) for name in _FIGURES if stored.get(name) is not None}
    return Screen(**{**stored, **figures})


def recorded_channels(connection: sqlite3.Connection) -> Quantities | None:
    """Return the channels of an open record; None if the record is new. Raises sqlite3.Error.

    Raises ValueError for an unreadable table of channels.
    """
    rows_found = connection.execute(f"SELECT {', '.join(COLUMNS)} FROM channel ORDER BY position").fetchall()
    if not rows_found:
        return None
    try:
        return quantities_of([dict(zip(COLUMNS, tuple(row), strict=True)) for row in rows_found])
    except (KeyError, TypeError) as error:
        raise ValueError(f"the table of channels cannot be read: {error}") from error


def add_channels(connection: sqlite3.Connection, quantities: Quantities) -> None:
    """Add the channels to a new record, inside a transaction: their rows, and columns of repeats and tares for their
    values.

    The table of repeats receives a column for the mean of each averaged channel, that of tares a column for its zero.
    Raises ValueError for a channel with the name of another column.
    """
    for row in channel_rows(quantities):
        connection.execute(*insert("channel", row))
    for table in ("repeat", "tare"):
        taken = {row[1] for row in connection.execute(f"PRAGMA main.table_info({table})")}
        for quantity in quantities.averaged:
            if quantity.name in taken:
                raise ValueError(
                    f"channel {quantity.name}: a {table} has another column of this name, rename the channel"
                )
            connection.execute(f"ALTER TABLE {table} ADD COLUMN {quantity.name} REAL")


_RENAMED = {"column": "column_name", "default": "default_value"}
"""Fields of an axis whose names are reserved words of SQL."""


def axis_rows(axes: Axes) -> Iterator[Statement]:
    """Yield the statements that add the axes to a new record: for each axis a row of ``axis`` and a column of
    ``condition``.
    """
    for position, (axis, data) in enumerate(zip(axes, axes.as_data(), strict=True)):
        row = {_RENAMED.get(name, name): cast("Cell", value) for name, value in data.items()}
        yield insert("axis", {"position": position} | row | {"choices": "\n".join(axis.choices)})
        yield f"ALTER TABLE condition ADD COLUMN {axis.field} {'TEXT' if axis.textual else 'REAL'}", ()


def axes_of(rows: Iterable[Mapping[str, object]]) -> Axes:
    """Return the axes in a record's table, by position."""
    fields = {column: field for field, column in _RENAMED.items()}
    axes_data = [{fields.get(name, name): value for name, value in row.items()} for row in rows]
    return axes_from(row | {"choices": str(row["choices"]).splitlines()} for row in axes_data)


def setpoint_columns(setpoint: Setpoint) -> dict[str, Cell]:
    """Return a setpoint as columns of ``condition``."""
    columns: dict[str, Cell] = {axis.field: setpoint.value(axis.name) for axis in setpoint.axes}
    return {"compound": setpoint.compound} | columns


def setpoint_of(row: Mapping[str, object], axes: Axes) -> Setpoint:
    """Return the setpoint in a row of ``condition``."""
    values: dict[str, AxisValue] = {}
    for axis in axes:
        value = row[axis.field]
        values[axis.name] = value if isinstance(value, str | float) else float("nan")
    return axes.setpoint(str(row["compound"]), **values)


def budget_rows(terms: Iterable[Term], known: Iterable[KnownSlope]) -> Iterator[Statement]:
    """Yield the statements that store the terms of the budget and the known slopes."""
    for position, term in enumerate(terms):
        acts: dict[str, Cell] = {"acts": term.acts.value, "df": term.df if isfinite(term.df) else None}
        yield insert("budget_term", {"position": position} | columns_in(term) | acts)
    for position, slope in enumerate(known):
        yield insert("known_slope", {"position": position} | columns_in(slope))


def term_of(row: Mapping[str, object]) -> Term:
    """Return a term from its row; raises ValueError for an invalid row."""
    columns = {name: value for name, value in row.items() if name not in ("position", "acts", "df")}
    df = row["df"]
    values = cast("dict[str, Any]", columns)  # numbers and texts, of the same types as the table's columns
    return Term(**values, acts=Acts(str(row["acts"])), df=df if isinstance(df, float) else inf)
