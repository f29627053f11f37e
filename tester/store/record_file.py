"""A run's database, opened for reading only.

If a run is still being written, or was interrupted, everything committed so far can be read.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal, Self

from tester.base.quantities import Quantities
from tester.store import record_schema
from tester.store.chain import Cell, ChainFound, inspect
from tester.store.kind_rows import recorded_channels
from tester.store.record_schema import NotBegunError, StoreError
from tester.store.sql import Record, Row, record, text, whole

DATABASE = "run.db"


def _read_only(path: Path) -> sqlite3.Connection:
    """Return a read-only connection; raises sqlite3.Error."""
    uri = f"{path.absolute().as_uri()}?mode=ro"
    connection = sqlite3.connect(uri, uri=True)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.OperationalError:
        # A power cut at the very beginning or end of a run leaves a rollback journal, which a reader must not apply.
        connection.close()
        with closing(sqlite3.connect(path)) as repairing:
            repairing.execute("SELECT count(*) FROM sqlite_master")
        connection = sqlite3.connect(uri, uri=True)
    connection.row_factory = sqlite3.Row
    return connection


class RecordFile:
    """A run's database, from its folder or its ``run.db``; use it in a ``with`` block or close it.

    Raises StoreError for a missing database, or one that this version cannot read.
    """

    def __init__(self, path: Path) -> None:
        """Open the record for reading."""
        self.path = path / DATABASE if path.is_dir() else path
        self._copy: TemporaryDirectory[str] | None = None
        self._quantities: Quantities | None = None
        if not self.path.is_file():
            raise StoreError(f"no run in {path}")
        try:
            self._connection = self._opened()
        except sqlite3.Error as error:
            raise StoreError(f"{self.path} cannot be read: {error}") from error

    def _opened(self) -> sqlite3.Connection:
        connection = _read_only(self.path)
        try:
            version = record_schema.version_of(connection)
        except StoreError as error:
            connection.close()
            raise StoreError(f"{self.path}: {error}") from error
        if version == record_schema.VERSION:
            return connection
        # The database was created, but the program ended before the schema was committed.
        if version == 0:
            connection.close()
            raise NotBegunError(f"{self.path}: the run was not begun")
        # An older record stays unchanged, so that its manifest remains valid; a copy is migrated to the present schema.
        self._copy = TemporaryDirectory(prefix="tester-", ignore_cleanup_errors=True)
        with closing(connection), closing(sqlite3.connect(Path(self._copy.name) / DATABASE)) as present:
            connection.backup(present)
            record_schema.migrate(present)
        return _read_only(Path(self._copy.name) / DATABASE)

    def __enter__(self) -> Self:
        """Return the reader."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()
        if self._copy is not None:
            self._copy.cleanup()

    def quantities(self) -> Quantities:
        """Return the record's own channels; raises StoreError."""
        if self._quantities is None:
            try:
                self._quantities = recorded_channels(self._connection)
            except (sqlite3.Error, ValueError) as error:
                raise StoreError(f"{self.path} cannot be read: {error}") from error
            if self._quantities is None:
                raise NotBegunError(f"{self.path}: the run was not begun")
        return self._quantities

    def rows(self, sql: str, values: tuple[Cell, ...] = ()) -> Iterator[Row]:
        try:
            for row in self._connection.execute(sql, values):
                yield dict(row)
        except sqlite3.Error as error:
            raise StoreError(f"{self.path} cannot be read: {error}") from error

    def records(self, kind: type[Record], rest: str, values: tuple[Cell, ...] = ()) -> Iterator[Record]:
        """Yield the records of a table; ``rest``: the rest of the query, with table, condition and order."""
        return (record(kind, row) for row in self.rows(f"SELECT * FROM {rest}", values))

    def record_head(self) -> str:
        """Return the last head of the record's chain, hexadecimal."""
        last = self.rows("SELECT lower(hex(head)) AS head FROM chain ORDER BY seq DESC LIMIT 1")
        return next((text(row, "head") for row in last), "")

    def chain(self) -> ChainFound:
        """Compare every row with the record's chain and return the result."""
        factory, self._connection.row_factory = self._connection.row_factory, None
        try:
            return inspect(self._connection)
        except (sqlite3.Error, TypeError, ValueError) as error:
            raise StoreError(f"{self.path}: the chain cannot be read: {error}") from error
        finally:
            self._connection.row_factory = factory

    def integrity_problems(self) -> list[str]:
        """Return the faults that SQLite's own check reports; empty for an intact file."""
        report = [text(row, "integrity_check") for row in self.rows("PRAGMA integrity_check")]
        return [] if report == ["ok"] else report

    def count(self, table: Literal["repeat", "condition", "sample_block", "event"], where: str = "1") -> int:
        """Return how many rows a table has."""
        return next(whole(row, "n") for row in self.rows(f"SELECT count(*) AS n FROM {table} WHERE {where}"))
