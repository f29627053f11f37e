"""A run's record as the campaign reads it: directly from SQLite, only what identifies a condition or a repeat.

It uses none of the product's code: a parser that relies on the product's own tables cannot find errors in them.
"""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tests.campaigns.agreement.facts import Subject, printed

_REFERENCE_KEY, _REFERENCE_GRID = "reference_every", "reference"


@dataclass(frozen=True, slots=True)
class RecordedAxis:
    """An axis of the recipe's conditions, with all headings used for it."""

    name: str
    field: str
    unit: str
    scale: float
    headings: frozenset[str]


@dataclass(frozen=True, slots=True)
class RecordedCondition:
    """A condition: its numbers and its setpoint, in the axes' displayed units."""

    number: int
    row: int
    replicate: int
    compound: str
    grid: str
    setpoint: Mapping[str, float | str]
    asked: int
    began_s: float | None
    ended_s: float | None


@dataclass(frozen=True)
class Record:
    """A run's record."""

    folder: Path
    kind: str
    rig_seconds: float
    axes: tuple[RecordedAxis, ...]
    conditions: tuple[RecordedCondition, ...]
    repeats: frozenset[tuple[int, int]]
    """Condition and number of every repeat that was committed."""
    specimens: int
    has_references: bool
    simulated: bool

    @property
    def name(self) -> str:
        """Return the name of the run's folder."""
        return self.folder.name

    @property
    def is_one_part(self) -> bool:
        """Return whether all of the run was on one simulated rig, by one clock."""
        return self.specimens == 1 and len(self.rows) == len(self.conditions)

    @property
    def run(self) -> Subject:
        """Return the run itself as a subject."""
        return "run", self.name

    @cached_property
    def rows(self) -> dict[int, list[RecordedCondition]]:
        """Return the replicates of each row of the recipe's table, in recipe order."""
        rows: dict[int, list[RecordedCondition]] = {}
        for condition in self.conditions:
            rows.setdefault(condition.row, []).append(condition)
        return rows

    def is_reference(self, row: int) -> bool:
        """Return whether a row is a reference condition."""
        return self.has_references and self.rows[row][0].grid == _REFERENCE_GRID

    def of_condition(self, number: int) -> Subject:
        """Return a condition as a subject."""
        return "condition", self.name, number

    def of_row(self, row: int) -> Subject:
        """Return a row as a subject: its condition if it has no replicates."""
        replicates = self.rows[row]
        if len(replicates) == 1:
            return self.of_condition(replicates[0].number)
        return "row", self.name, row

    def of_repeat(self, condition: int, repeat: int) -> Subject:
        """Return a repeat as a subject."""
        return "repeat", self.name, condition, repeat

    def axis_of(self, heading: str) -> RecordedAxis | None:
        """Return the axis of a heading."""
        plain = plain_heading(heading)
        return next((axis for axis in self.axes if plain in axis.headings), None)

    def matching(self, compound: str, cells: Mapping[str, str]) -> list[int]:
        """Return the rows with a compound ("": any) whose setpoint has these cells by the axes' names."""
        return [
            row
            for row, replicates in self.rows.items()
            if (not compound or replicates[0].compound == compound)
            and all(_equal(replicates[0].setpoint[name], cell) for name, cell in cells.items())
        ]

    def in_words(self, text: str, shared: str = "") -> list[int]:
        """Return the rows whose compound and setpoint a text names: "1#, 300 mm/s, 100 N, 25 degC".

        An axis that the text does not mention matches any value. ``shared``: what the text leaves out.
        """
        parts = [part.strip() for part in f"{text}, {shared}".split(",") if part.strip()]
        return [row for row, replicates in self.rows.items() if _is_named(replicates[0], self.axes, parts)]


def _is_named(condition: RecordedCondition, axes: Sequence[RecordedAxis], parts: Sequence[str]) -> bool:
    named = [part for part in parts if part != condition.compound]
    return all(any(_is_at(condition, axis, part) for axis in axes) for part in named)


def _is_at(condition: RecordedCondition, axis: RecordedAxis, part: str) -> bool:
    """Return whether a part of a condition's text, "300 mm/s" or "sideslip 10 deg", is the setpoint of an axis."""
    value = condition.setpoint.get(axis.name)
    if value is None or isinstance(value, str):
        return value == part
    match = re.fullmatch(rf"(?:[a-z ]+ )?([-+.e\d]+) {re.escape(axis.unit)}", part)
    return match is not None and _equal(value, match.group(1))


def plain_heading(heading: str) -> str:
    """Return a heading in lower case with single spaces."""
    return re.sub(r"\s+", " ", heading.replace("\u00a0", " ").replace("_", " ")).strip().lower()


def _equal(value: float | str, cell: str) -> bool:
    if isinstance(value, str):
        return value == cell.strip()
    number = printed(cell)
    return number is not None and abs(number[0] - value) <= 1e-6 * max(abs(value), 1.0)


def read_record(folder: Path) -> Record:
    """Read the record of a run's folder; raises sqlite3.Error."""
    with closing(sqlite3.connect(f"file:{folder / 'run.db'}?mode=ro", uri=True)) as database:
        database.row_factory = sqlite3.Row
        run = database.execute("SELECT * FROM run").fetchone()
        axes = tuple(_axis(row) for row in database.execute("SELECT * FROM axis ORDER BY position"))
        conditions = tuple(
            _condition(row, axes) for row in database.execute("SELECT * FROM condition ORDER BY row, condition")
        )
        committed = "SELECT DISTINCT condition, repeat FROM repeat WHERE status NOT IN ('open', 'void')"
        repeats = frozenset((row[0], row[1]) for row in database.execute(committed))
        (specimens,) = database.execute("SELECT count(*) FROM specimen").fetchone()
        references = database.execute("SELECT 1 FROM metadata WHERE key = ?", (_REFERENCE_KEY,)).fetchone()
    return Record(
        folder, run["kind"], run["rig_seconds"] or 0.0, axes, conditions, repeats, specimens, references is not None,
        bool(run["simulated"]),
    )  # fmt: skip


def _axis(row: sqlite3.Row) -> RecordedAxis:
    unit = {"degC": "°C", "deg": "°"}.get(row["unit"], row["unit"])
    name = str(row["name"])
    headings = {row["column_name"], row["header"], row["title"], f"{name} ({unit})", name}
    plain = frozenset(plain_heading(str(text)) for text in headings)
    return RecordedAxis(name, row["field"], row["unit"], row["scale"], plain)


def _condition(row: sqlite3.Row, axes: Sequence[RecordedAxis]) -> RecordedCondition:
    setpoint = {
        axis.name: row[axis.field] if isinstance(row[axis.field], str) else row[axis.field] * axis.scale
        for axis in axes
        if row[axis.field] is not None
    }
    return RecordedCondition(
        row["condition"], row["row"], row["replicate"], row["compound"], row["grid"], setpoint, row["repeats"],
        row["started_s"], row["ended_s"],
    )  # fmt: skip
