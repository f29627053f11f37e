"""A kind's axes and budget as rows of the record, and a condition's setpoint as columns of ``condition``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from math import inf, isfinite
from typing import Any, cast

from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Acts, Term
from tester.base.axes import Axes, AxisValue, Setpoint, axes_from
from tester.store.statements import Statement, Value, insert

_COLUMNS = {"column": "column_name", "default": "default_value"}
"""Fields of an axis whose names SQL keeps for itself."""


def axis_rows(axes: Axes) -> Iterator[Statement]:
    """Yield the statements that give a new record its axes: a row of ``axis`` and a column of ``condition`` each."""
    for position, (one, data) in enumerate(zip(axes, axes.as_data(), strict=True)):
        row = {_COLUMNS.get(name, name): cast("Value", value) for name, value in data.items()}
        yield insert("axis", {"position": position} | row | {"choices": "\n".join(one.choices)})
        yield f"ALTER TABLE condition ADD COLUMN {one.field} {'TEXT' if one.choices else 'REAL'}", ()


def axes_of(rows: Iterable[Mapping[str, object]]) -> Axes:
    """Return the axes that a record's table has, by position."""
    fields = {column: field for field, column in _COLUMNS.items()}
    found = [{fields.get(name, name): value for name, value in row.items()} for row in rows]
    return axes_from(row | {"choices": str(row["choices"]).splitlines()} for row in found)


def setpoint_columns(setpoint: Setpoint) -> dict[str, Value]:
    """Return what is held as columns of ``condition``."""
    held: dict[str, Value] = {one.field: setpoint.value(one.name) for one in setpoint.axes}
    return {"compound": setpoint.compound} | held


def setpoint_of(row: Mapping[str, object], axes: Axes) -> Setpoint:
    """Return what is held by a row of ``condition``."""
    held: dict[str, AxisValue] = {}
    for one in axes:
        value = row[one.field]
        held[one.name] = value if isinstance(value, str | float) else float("nan")
    return axes.setpoint(str(row["compound"]), **held)


def budget_rows(terms: Iterable[Term], known: Iterable[KnownSlope]) -> Iterator[Statement]:
    """Yield the statements that put them on record."""
    for position, one in enumerate(terms):
        row: dict[str, Value] = asdict(one) | {"acts": one.acts.value, "df": one.df if isfinite(one.df) else None}
        yield insert("budget_term", {"position": position} | row)
    for position, one in enumerate(known):
        yield insert("known_slope", {"position": position} | asdict(one))


def term_of(row: Mapping[str, object]) -> Term:
    """Return a term from its row; raises ValueError for what is none."""
    given = {name: value for name, value in row.items() if name not in ("position", "acts", "df")}
    df = row["df"]
    values = cast("dict[str, Any]", given)  # numbers and texts, as the table's columns have them
    return Term(**values, acts=Acts(str(row["acts"])), df=df if isinstance(df, float) else inf)
