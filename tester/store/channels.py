"""A record's own table of channels, which defines its samples and means without the code of its kind of rig."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from tester.base.quantities import Channel, Figure, Quantities, Roles, Screen
from tester.store.chain import Cell
from tester.store.sql import columns_in, insert

COLUMNS = ("position", "name", "unit", "label", "source", "mean", "decimals", "whole", "shown_name", "shown_unit",
           "scale", "role", "block", "screen")  # fmt: skip
"""Columns of the table ``channel``. ``role``: words of _ROLES, joined; ``block`` beside the role ``turn``; ``screen``:
JSON."""

_FIGURES = ("low", "high", "limit")
_ALONG, _ACROSS, _NORMAL, _TURN, _TEMPERATURE, _SLIDING = _ROLES = (
    "along", "across", "normal", "turn", "temperature", "sliding",
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
    roles = Roles(
        tuple(along), holder[_NORMAL], holder[_TURN], blocks[0], holder.get(_TEMPERATURE, ""), holder.get(_SLIDING, "")
    )
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
    figures: dict[str, Any] = {name: Figure(**stored[name]) for name in _FIGURES if stored[name] is not None}
    return Screen(**{**stored, **figures})


def recorded_channels(connection: sqlite3.Connection) -> Quantities | None:
    """Return the channels of an open record, None for a new one; raises sqlite3.Error.

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

    A repeat gets a column for the mean of each averaged channel, a tare one for its zero. Raises ValueError for a
    channel with the name of another column.
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
