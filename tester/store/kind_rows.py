"""A kind's axes and budget as rows of the record, and a condition's setpoint as columns of ``condition``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import inf, isfinite
from typing import Any, cast

from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Acts, Term
from tester.base.axes import Axes, AxisValue, Setpoint, axes_from
from tester.store.chain import Cell
from tester.store.sql import Statement, columns_in, insert

_COLUMNS = {"column": "column_name", "default": "default_value"}
"""Fields of an axis whose names are reserved words of SQL."""


def axis_rows(axes: Axes) -> Iterator[Statement]:
    """Yield the statements that add the axes to a new record: a row of ``axis`` and a column of ``condition`` each."""
    for position, (axis, data) in enumerate(zip(axes, axes.as_data(), strict=True)):
        row = {_COLUMNS.get(name, name): cast("Cell", value) for name, value in data.items()}
        yield insert("axis", {"position": position} | row | {"choices": "\n".join(axis.choices)})
        yield f"ALTER TABLE condition ADD COLUMN {axis.field} {'TEXT' if axis.choices else 'REAL'}", ()


def axes_of(rows: Iterable[Mapping[str, object]]) -> Axes:
    """Return the axes in a record's table, by position."""
    fields = {column: field for field, column in _COLUMNS.items()}
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
    """Yield the statements that store them."""
    for position, term in enumerate(terms):
        acts: dict[str, Cell] = {"acts": term.acts.value, "df": term.df if isfinite(term.df) else None}
        yield insert("budget_term", {"position": position} | columns_in(term) | acts)
    for position, slope in enumerate(known):
        yield insert("known_slope", {"position": position} | columns_in(slope))


def term_of(row: Mapping[str, object]) -> Term:
    """Return a term from its row; raises ValueError for an invalid row."""
    columns = {name: value for name, value in row.items() if name not in ("position", "acts", "df")}
    df = row["df"]
    values = cast("dict[str, Any]", columns)  # numbers and texts, of the types of the table's columns
    return Term(**values, acts=Acts(str(row["acts"])), df=df if isinstance(df, float) else inf)
