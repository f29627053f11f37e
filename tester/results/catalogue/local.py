"""The index next to the runs: one SQLite file that is rebuilt from the runs whenever it is missing."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import TypeVar

from tester.results.catalogue.entries import CatalogueError, ConditionEntry, RunEntry, WantedRuns

INDEX = ".catalogue.db"

_VERSION = 1

_RUN = tuple(field.name for field in fields(RunEntry))
_CONDITION = tuple(field.name for field in fields(ConditionEntry))

_SCHEMA = f"""
CREATE TABLE run ({", ".join(_RUN)}, PRIMARY KEY (origin, name));
CREATE TABLE condition (origin, name, {", ".join(_CONDITION)}, PRIMARY KEY (origin, name, condition));
"""

Entry = TypeVar("Entry", RunEntry, ConditionEntry)


class LocalIndex:
    """A catalogue in ``.catalogue.db`` under the folder of the runs; in memory where that cannot be written."""

    def __init__(self, under: Path) -> None:
        """Open the index, or make it, which also replaces a damaged one or one of another version."""
        path = under / INDEX
        try:
            self._connection = _opened(path)
        except sqlite3.OperationalError:
            self._connection = _opened(None)  # the folder is read-only, or missing
        except sqlite3.DatabaseError:
            # Damaged, or of another version: it is rebuilt from the runs.
            with suppress(OSError):
                path.unlink()
            self._connection = _opened(path)

    def fingerprints(self, origin: str) -> dict[str, str]:
        return dict(self._connection.execute("SELECT name, fingerprint FROM run WHERE origin = ?", (origin,)))

    def put(self, run: RunEntry, conditions: Iterable[ConditionEntry]) -> None:
        """Store a run, in place of any earlier entry; raises CatalogueError."""
        try:
            with self._connection:
                self._delete(run.origin, run.name)
                self._insert("run", [getattr(run, name) for name in _RUN])
                for condition in conditions:
                    self._insert(
                        "condition", [run.origin, run.name, *(getattr(condition, name) for name in _CONDITION)]
                    )
        except sqlite3.Error as error:
            raise CatalogueError(f"the index of the runs cannot be written: {error}") from error

    def remove(self, origin: str, name: str) -> None:
        with self._connection:
            self._delete(origin, name)

    def runs(self, wanted: WantedRuns) -> list[RunEntry]:
        where: list[str] = ["1"]
        values: list[str] = []
        for value, condition in (
            (wanted.compound, "instr(char(10) || compounds || char(10), char(10) || ? || char(10)) > 0"),
            (wanted.since, "started_utc >= ?"),
            (wanted.until, "started_utc <= ?"),
            (wanted.recipe, "instr(lower(recipe), lower(?)) > 0"),
        ):
            if value:
                where.append(condition)
                values.append(value)
        sql = f"SELECT * FROM run WHERE {' AND '.join(where)} ORDER BY started_utc, name"
        return [RunEntry(**dict(zip(_RUN, row, strict=True))) for row in self._connection.execute(sql, values)]

    def conditions(self, run: RunEntry) -> list[ConditionEntry]:
        sql = f"SELECT {', '.join(_CONDITION)} FROM condition WHERE origin = ? AND name = ? ORDER BY condition"
        rows = self._connection.execute(sql, (run.origin, run.name))
        return [ConditionEntry(**dict(zip(_CONDITION, row, strict=True))) for row in rows]

    def close(self) -> None:
        self._connection.close()

    def _delete(self, origin: str, name: str) -> None:
        for table in ("run", "condition"):
            self._connection.execute(f"DELETE FROM {table} WHERE origin = ? AND name = ?", (origin, name))

    def _insert(self, table: str, values: list[object]) -> None:
        self._connection.execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(values))})", values)


def _opened(path: Path | None) -> sqlite3.Connection:
    connection = sqlite3.connect(":memory:" if path is None else path)
    try:
        version: int = connection.execute("PRAGMA user_version").fetchone()[0]
        if version != _VERSION:
            if version or connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                raise sqlite3.DatabaseError("an index of another version")
            connection.executescript(f"BEGIN;{_SCHEMA}PRAGMA user_version = {_VERSION};COMMIT;")
    except sqlite3.Error:
        connection.close()
        raise
    return connection
