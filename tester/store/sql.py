"""The record's entries as SQL: statements that belong together, and the promise that they are on disk."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from hashlib import sha256

from tester.analysis.results import Judgement, RepeatResult
from tester.store.records import Calibration

Value = str | int | float | None
Statement = tuple[str, tuple[Value, ...]]

_JUDGEMENT_FIELDS = tuple(field.name for field in fields(Judgement))


class Ticket:
    """A promise of a commit: ``done`` once COMMIT has returned, ``error`` if it failed."""

    __slots__ = ("done", "error")

    def __init__(self, *, done: bool = False) -> None:
        """Start open, or done where there is nothing to wait for."""
        self.done = done
        self.error: str | None = None


@dataclass(slots=True)
class Batch:
    """Statements that belong together. An urgent batch is committed without waiting for the second to end."""

    statements: Sequence[Statement]
    ticket: Ticket
    urgent: bool = False


def insert(table: str, values: Mapping[str, Value], verb: str = "INSERT") -> Statement:
    """Return an INSERT of ``values`` (by column name)."""
    marks = ", ".join("?" * len(values))
    return f"{verb} INTO {table} ({', '.join(values)}) VALUES ({marks})", tuple(values.values())


def text_sha256(text: str) -> str:
    """Return the SHA-256 of a text's UTF-8 bytes, hexadecimal."""
    return sha256(text.encode()).hexdigest()


def calibration_sha256(calibration: Iterable[Calibration]) -> str:
    """Return the SHA-256 for comparing two calibrations."""
    return text_sha256("".join(f"{c.device}\t{c.quantity}\t{c.value}\t{c.unit}\n" for c in calibration))


def columns_in(record: object, names: Iterable[str]) -> dict[str, Value]:
    """Return a record's fields of these names as columns."""
    return {name: getattr(record, name) for name in names}


def calibration_rows(figures: Iterable[Calibration], session: int) -> list[Statement]:
    """Return the INSERTs of a session's calibration."""
    return [
        insert(
            "calibration",
            {"session": session, "device": c.device, "quantity": c.quantity, "value": c.value, "unit": c.unit},
        )
        for c in figures
    ]


@dataclass(frozen=True, slots=True)
class Judged:
    """A condition's judgement, and its repeats after it: result by key."""

    condition: int
    judgement: Judgement
    repeats: Mapping[int, RepeatResult]


def judged_rows(judged: Judged | None) -> Iterator[Statement]:
    """Yield the UPDATEs of a judged condition and its repeats; nothing without a judgement."""
    if judged is None:
        return
    figures = columns_in(judged.judgement, _JUDGEMENT_FIELDS)
    assignments = ", ".join(f"{name} = ?" for name in figures)
    yield f"UPDATE condition SET {assignments} WHERE condition = ?", (*figures.values(), judged.condition)
    sql = "UPDATE repeat SET status = ?, reason = ?, drift_percent = ?, bound_percent = ? WHERE id = ?"
    for key, r in judged.repeats.items():
        yield sql, (r.status.value, r.reason, r.drift_percent, r.bound_percent, key)
