"""A table of results as data: columns with key, heading, unit and decimals, and the rows that they read.

Files, terminal, report and screens pick columns and render them. The column alone defines its content, its heading and
the digits for people. A column that is added to a table, in its module, appears in every output that its ``views``
name, in the CSV file and in JSON.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from math import isfinite
from typing import Generic, TypeAlias, TypeVar

from tester.analysis.pressure import AREA_MM2, LOAD, pressure_kpa
from tester.base.axes import Axes, Axis
from tester.base.quantities import Channel, Means
from tester.base.words import NONE, Json, decimal, significant
from tester.results.table_cells import Cell, nominal
from tester.store.records import ConditionInfo

Value: TypeAlias = str | int | float | tuple[str, ...] | None
"""Value of a column for a row: NaN and None are no value, a tuple is a list of words."""
R = TypeVar("R")


class Output(StrEnum):
    """An output with room for some of a table's columns."""

    END = "end of a run"
    SHOW = "tester show"
    COVER = "first page of a report"
    REPORT = "table of a report"
    REPEATS = "counts and drift in a report"
    SCREEN = "screen"
    SWEEP = "tables of a sweep"
    COMPARE = "comparison of runs"


@dataclass(frozen=True)  # a generic with slots cannot be made by its parameters (Column[Row](...)) in Python 3.11
class Column(Generic[R]):
    """One column. ``key`` is its name in CSV files and JSON, ``heading`` the text for people, with ``unit``.

    ``value`` reads it from a row, unrounded. For people, numbers have ``decimals`` decimals; None: the form of
    setpoints and counts.
    """

    key: str
    heading: str
    value: Callable[[R], Value]
    unit: str = ""
    decimals: int | None = None
    views: frozenset[Output] = frozenset()
    """Outputs that show it."""
    mark: Callable[[R], str] | None = None
    """Returns the mark behind the number for people (``tester.analysis.results``)."""
    digits: int | None = None
    """Significant digits of numbers that range over decades; in place of ``decimals``."""
    stored: bool = True
    """Whether CSV and JSON have it; a shorter form of other columns is for people only."""
    narrow: str = ""
    """Heading with unit for narrow places; "" the same as elsewhere."""
    beside: str = ""
    """Key of the column that it follows where that one comes first."""

    @property
    def head(self) -> str:
        """Return the heading with its unit in brackets."""
        return f"{self.heading} ({self.unit})" if self.unit else self.heading

    @property
    def narrow_head(self) -> str:
        """Return the heading for a narrow place."""
        return self.narrow or self.head

    @property
    def numeric(self) -> bool:
        """Return whether it shows numbers to people."""
        return self.decimals is not None or self.digits is not None

    def mark_at(self, row: R) -> str:
        """Return the mark behind the number."""
        return self.mark(row) if self.mark is not None else ""

    def text(self, row: R) -> str:
        """Return the text for people; a dash where there is no value."""
        value = self.value(row)
        if value is None or value == "" or value == () or (isinstance(value, float) and not isfinite(value)):
            return NONE
        if isinstance(value, tuple):
            return ", ".join(value)
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, str):
            return value
        if self.digits is not None:
            return significant(value, self.digits)
        return (decimal(value, self.decimals) if self.decimals is not None else nominal(value)) + self.mark_at(row)

    def cell(self, row: R) -> Cell:
        """Return the cell of a CSV file."""
        value = self.value(row)
        if isinstance(value, tuple):
            return "; ".join(value)
        return int(value) if isinstance(value, bool) else value

    def as_json(self, row: R) -> Json:
        """Return the value in JSON; null for no value."""
        value = self.value(row)
        if isinstance(value, tuple):
            return [*value]
        return None if isinstance(value, float) and not isfinite(value) else value


def axis_column(axis: Axis, info: Callable[[R], ConditionInfo]) -> Column[R]:
    """Return the column of an axis of conditions; ``info`` returns a row's setpoints."""
    return Column(
        axis.column, axis.name.replace("_", " "), lambda row: axis.of(info(row).setpoint), unit_of(axis),
        narrow=axis.title,
    )  # fmt: skip


def setting_columns(
    axes: Axes,
    info: Callable[[R], ConditionInfo],
    replicate: Callable[[R], Value],
    metadata: Mapping[str, str],
    views: frozenset[Output],
) -> tuple[Column[R], ...]:
    """Return the columns that identify a row's condition, and the pressure of its load where the area is known.

    ``metadata``: of the run; ``views``: outputs that show the pressure.
    """
    found: list[Column[R]] = []
    for axis in axes:
        found.append(axis_column(axis, info))
        if axis.name == LOAD and AREA_MM2 in metadata:
            found.append(Column(
                "pressure_kpa", "pressure", lambda row: pressure_kpa(info(row).setpoint.number(LOAD), metadata), "kPa",
                1, views, beside=axis.column,
            ))  # fmt: skip
    return (
        Column("specimen", "specimen", lambda row: info(row).specimen),
        Column("replicate", "replicate", replicate),
        Column("grid", "grid", lambda row: info(row).grid),
        Column("compound", "compound", lambda row: info(row).compound),
        Column("note", "note", lambda row: info(row).note),
        *found,
    )


def piece_key(worn: str) -> str:
    """Return the key of the column that numbers mounted pieces; ``worn``: the kind's word for a piece.

    Recipes have specimens as well: a kind that wears specimens would otherwise have two columns with the same key.
    """
    return "piece" if worn == "specimen" else worn


def mean_column(channel: Channel, means: Callable[[R], Means], views: frozenset[Output] = frozenset()) -> Column[R]:
    """Return the column of a channel's mean; ``means`` returns a row's means."""
    return Column(
        channel.measured_column, channel.label.lower(), lambda row: channel.scaled(means(row).get(channel.name)),
        channel.read_as, channel.decimals, views,
    )  # fmt: skip


def unit_of(axis: Axis) -> str:
    """Return the unit of an axis as people write it."""
    return {"degC": "°C", "deg": "°"}.get(axis.unit, axis.unit)


@dataclass(frozen=True)
class Table(Generic[R]):
    """Columns, and the rows that they read."""

    columns: tuple[Column[R], ...]
    rows: tuple[R, ...]

    def __getitem__(self, key: str) -> Column[R]:
        """Return the column of a key; raises KeyError."""
        for column in self.columns:
            if column.key == key:
                return column
        raise KeyError(key)

    def of(self, rows: Iterable[R]) -> Table[R]:
        """Return the table of other rows."""
        return replace(self, rows=tuple(rows))

    def view(self, output: Output, first: Iterable[str] = ()) -> Table[R]:
        """Return the table with the columns of an output, after those of the keys ``first``; raises KeyError."""
        shown = [column for column in self.columns if output in column.views]
        leading: list[Column[R]] = []
        for key in first:
            leading += [self[key], *(column for column in shown if column.beside == key)]
        return replace(self, columns=(*leading, *(column for column in shown if column not in leading)))

    def csv(self) -> Iterator[tuple[Cell, ...]]:
        """Yield keys, then the cells of each row."""
        stored = [column for column in self.columns if column.stored]
        yield tuple(column.key for column in stored)
        for row in self.rows:
            yield tuple(column.cell(row) for column in stored)

    def records(self) -> Iterator[dict[str, Json]]:
        """Yield each row as JSON, by keys."""
        stored = [column for column in self.columns if column.stored]
        for row in self.rows:
            yield {column.key: column.as_json(row) for column in stored}

    def texts(self) -> Iterator[tuple[str, ...]]:
        """Yield the texts for people, row by row."""
        for row in self.rows:
            yield tuple(column.text(row) for column in self.columns)
