"""Records as rows, and rows as records: columns, statements, values, and statements that are committed together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cache
from hashlib import sha256
from typing import TYPE_CHECKING, TypeVar

from tester.analysis.results import Judgement, RepeatResult
from tester.store.chain import Cell
from tester.store.records import NAN, Calibration

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Statement = tuple[str, tuple[Cell, ...]]
Row = Mapping[str, Cell]
Record = TypeVar("Record", bound="DataclassInstance")

_TYPES = {
    "str": "TEXT NOT NULL", "int": "INTEGER NOT NULL", "bool": "INTEGER NOT NULL CHECK ({name} IN (0, 1))",
    "float": "REAL", "str | None": "TEXT", "int | None": "INTEGER", "float | None": "REAL",
}  # fmt: skip
"""SQL by the type of a record's field. A float may be NaN, which SQLite stores as NULL. A field of any other type has
no column of its own."""


class Ticket:
    """A promise of a commit: ``done`` is set once COMMIT has returned, ``error`` if it failed."""

    __slots__ = ("done", "error")

    def __init__(self, *, done: bool = False) -> None:
        """Begin open, or ``done`` if there is nothing to wait for."""
        self.done = done
        self.error: str | None = None


@dataclass(slots=True)
class Batch:
    """Statements that belong together. An urgent batch is committed at once, not at the next regular commit."""

    statements: Sequence[Statement]
    ticket: Ticket
    urgent: bool = False


def create(table: str, *columns: str | type[DataclassInstance], constraint: str = "") -> str:
    """Return a CREATE TABLE.

    A text in ``columns`` is a column, used as written; a record class gives a column for each of its fields that no
    text defines. The default of a text field or a whole-number field is the column's default.
    """
    lines = {column.split()[0]: column for column in columns if isinstance(column, str)}
    for record in columns:
        if not isinstance(record, str):
            for field in fields(record):
                if str(field.type) in _TYPES:
                    lines.setdefault(field.name, _column(field.name, str(field.type), field.default))
    listed = ",\n    ".join([*lines.values(), *([constraint] if constraint else [])])
    return f"CREATE TABLE {table} (\n    {listed}\n);\n"


def _column(name: str, kind: str, default: object) -> str:
    column = f"{name} {_TYPES[kind].format(name=name)}"
    if default is MISSING or default is None or isinstance(default, float):
        return column
    return f"{column} DEFAULT {int(default)}" if isinstance(default, int) else f"{column} DEFAULT '{default}'"


@cache
def column_names(record: type[DataclassInstance]) -> tuple[str, ...]:
    """Return the names of a record class's fields that have columns."""
    return tuple(field.name for field in fields(record) if str(field.type) in _TYPES)


def columns_in(record: DataclassInstance) -> dict[str, Cell]:
    """Return a record's fields as columns."""
    return {name: getattr(record, name) for name in column_names(type(record))}


def insert(table: str, values: Mapping[str, Cell], verb: str = "INSERT") -> Statement:
    """Return an INSERT of ``values`` (by column name)."""
    marks = ", ".join("?" * len(values))
    return f"{verb} INTO {table} ({', '.join(values)}) VALUES ({marks})", tuple(values.values())


def update(table: str, values: Mapping[str, Cell], where: Mapping[str, Cell]) -> Statement:
    """Return an UPDATE to ``values`` of the rows that match ``where``, both by column name; of every row if ``where``
    is empty.
    """
    assignments = ", ".join(f"{name} = ?" for name in values)
    condition = " AND ".join(f"{name} = ?" for name in where)
    sql = f"UPDATE {table} SET {assignments}" + (f" WHERE {condition}" if condition else "")
    return sql, (*values.values(), *where.values())


def text(row: Row, name: str) -> str:
    """Return a text, "" for NULL."""
    value = row[name]
    return "" if value is None else str(value)


def number(row: Row, name: str) -> float:
    """Return a number, NaN for NULL."""
    value = row[name]
    return float(value) if isinstance(value, int | float) else NAN


def whole(row: Row, name: str) -> int:
    """Return a whole number, 0 for NULL."""
    value = row[name]
    return int(value) if isinstance(value, int | float) else 0


def flag(row: Row, name: str) -> bool:
    """Return a truth value; False for NULL."""
    return bool(row[name])


def blob(row: Row, name: str) -> bytes:
    """Return bytes; empty for NULL."""
    value = row[name]
    return value if isinstance(value, bytes) else b""


_READERS: Mapping[str, Callable[[Row, str], object]] = {"str": text, "float": number, "int": whole, "bool": flag}
"""Reader by the type of a record's field."""


def record(kind: type[Record], row: Row, **known: object) -> Record:
    """Return a record whose fields are the row's columns of the same names, except those in ``known``.

    NULL becomes None in a field that may be None.
    """
    values = dict(known)
    for name, type_name, optional in _types(kind):
        if name not in known:
            values[name] = None if optional and row[name] is None else _READERS[type_name](row, name)
    build: Callable[..., Record] = kind
    return build(**values)


@cache
def _types(kind: type[DataclassInstance]) -> list[tuple[str, str, bool]]:
    """Return the name of each field, the name of its type, and whether it may be None."""
    types = [(field.name, str(field.type)) for field in fields(kind)]
    return [(name, kind.removesuffix(" | None"), kind.endswith(" | None")) for name, kind in types]


def text_sha256(text: str) -> str:
    """Return the SHA-256 of a text's UTF-8 bytes, hexadecimal."""
    return sha256(text.encode()).hexdigest()


def calibration_sha256(calibration: Iterable[Calibration]) -> str:
    """Return the SHA-256 for comparing two calibrations."""
    return text_sha256("".join(f"{c.device}\t{c.quantity}\t{c.value}\t{c.unit}\n" for c in calibration))


def calibration_rows(figures: Iterable[Calibration], session: int) -> list[Statement]:
    """Return the INSERTs of a session's calibration."""
    return [insert("calibration", {"session": session} | columns_in(figure)) for figure in figures]


@dataclass(frozen=True, slots=True)
class Judged:
    """A condition's judgement, and the repeats as judged: result by key."""

    condition: int
    judgement: Judgement
    repeats: Mapping[int, RepeatResult]


def judged_rows(judged: Judged | None) -> Iterator[Statement]:
    """Yield the UPDATEs of a judged condition and its repeats; nothing if there is no judgement."""
    if judged is None:
        return
    yield update("condition", columns_in(judged.judgement), {"condition": judged.condition})
    for key, r in judged.repeats.items():
        values = {"status": r.status.value, "reason": r.reason, "drift_percent": r.drift_percent}
        yield update("repeat", values | {"bound_percent": r.bound_percent}, {"id": key})
