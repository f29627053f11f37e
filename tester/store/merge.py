"""Merges the records of a run's parts into the run's own: one run whose times follow one another.

A part is recorded separately, from time 0 and with keys from 1. This module copies it into the run's database after the
earlier parts: times (``record_schema.TIMES``) increase by the rig seconds of those parts, keys (``TABLES``) by the
number of keys assigned so far. Other columns only hold values.
"""

from __future__ import annotations

import sqlite3
import zlib
from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tester.analysis.results import Judgement
from tester.base.quantities import KEY, TIME
from tester.store.chain import Cell, Chain
from tester.store.record_file import DATABASE
from tester.store.record_schema import TIMES, StoreError, migrate
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import LEVEL, unpack_array
from tester.store.sql import column_names, update


@dataclass(frozen=True, slots=True)
class Merged:
    """Columns with keys. ``key`` is numbered through the run (None: the part's own keys are valid in the run);
    ``repeat`` refers to a repeat's key.
    """

    key: str | None = None
    repeat: str | None = None


TABLES: dict[str, Merged] = {
    "piece": Merged(),
    "repeat": Merged(key="id"),
    "burst": Merged(repeat="repeat_id"),
    "sample_block": Merged(key="id", repeat="repeat_id"),
    "event": Merged(key="sequence"),
    "prompt": Merged(key="id"),
    "tare": Merged(key="id", repeat="repeat_id"),
    "wear_check": Merged(key="id"),
    "soak": Merged(key="id"),
    "trip": Merged(key="id"),
    "bus_statistic": Merged(key="id"),
    "device_parameter": Merged(key="id"),
    "truth": Merged(key="id"),
    "travel": Merged(key="id", repeat="repeat_id"),
}
"""Tables that a run in progress fills, in the order in which they refer to each other. ``condition`` is updated. The
other tables belong to the whole run, and parts do not fill them.
"""

LEFT = (*TIMES["condition"], "status", "reason", "warming_k_s", "holdable_band_k", *column_names(Judgement))
"""Columns of a condition's final state."""

_DIGITS = 6
"""Rig times are multiples of a microsecond (tester.machine.tickers); the sum of two is rounded to that."""


class Merge:
    """Adds parts to a run's database, each in a transaction of its own; use in a ``with`` block.

    It first deletes the result of an earlier merge, so that a merge may be repeated after a crash or a resumed part.
    Raises sqlite3.Error and StoreError. It never writes to the parts.
    """

    def __init__(self, folder: Path) -> None:
        """Open the merge; ``folder``: the run's, whose ``run.db`` already contains the run and its conditions."""
        self.rig_seconds = 0.0
        self._connection = sqlite3.connect(folder / DATABASE, isolation_level=None)
        try:
            # Sync the deletion of a rollback journal as well: a journal that came back would undo the merge.
            self._connection.execute("PRAGMA synchronous = EXTRA")
            migrate(self._connection)
            with RunReader(folder) as reader:
                self._channels = reader.quantities()
            self._chain = Chain(self._connection)
            with self._transaction():
                for table in reversed(TABLES):
                    self._connection.execute(f"DELETE FROM {table}")
                self._connection.execute("UPDATE run SET overruns = 0")
        except (sqlite3.Error, StoreError):
            self._connection.close()
            raise

    def __enter__(self) -> Merge:
        """Return the merge."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self._connection.close()

    def add(self, part: Path) -> None:
        """Append the part whose record is in the folder ``part``."""
        with RunReader(part) as reader:
            run, channels = reader.run(), reader.quantities()
        if channels.names != self._channels.names:
            raise StoreError(f"part {part.name} was recorded with other channels than its run")
        with closing(sqlite3.connect(f"{(part / DATABASE).absolute().as_uri()}?mode=ro", uri=True)) as source:
            bases = {table: self._last(table) for table, kind in TABLES.items() if kind.key is not None}
            with self._transaction():
                for table in TABLES:
                    self._copy(source, table, bases)
                self._update_conditions(source)
                self._connection.execute("UPDATE run SET overruns = overruns + ?", (run.overruns,))
        self.rig_seconds = self._later(self.rig_seconds, run.rig_seconds)

    def finish(self, status: str, reason: str, ended_utc: str) -> None:
        """Store the end of the whole run."""
        end = {"status": status, "reason": reason, "rig_seconds": self.rig_seconds, "ended_utc": ended_utc}
        with self._transaction():
            self._connection.execute(*update("run", end, {}))

    # -- rows -------------------------------------------------------------------------------------------------

    def _copy(self, source: sqlite3.Connection, table: str, bases: dict[str, int]) -> None:
        kind = TABLES[table]
        rows = source.execute(f"SELECT * FROM {table} ORDER BY rowid")
        names = [column[0] for column in rows.description]
        times = [names.index(name) for name in TIMES.get(table, ())]
        key = names.index(kind.key) if kind.key is not None else -1
        repeat = names.index(kind.repeat) if kind.repeat is not None else -1
        data = names.index("data") if table == "sample_block" else -1

        def moved() -> Iterator[list[Cell]]:
            for stored in rows:
                row: list[Cell] = list(stored)
                for i in times:
                    row[i] = self._moved(row[i])
                if key >= 0:
                    row[key] = _raised(row[key], bases[table])
                if repeat >= 0:
                    row[repeat] = _raised(row[repeat], bases["repeat"])
                if data >= 0:
                    row[data] = self._block(row[data], bases["repeat"])
                yield row

        marks = ", ".join("?" * len(names))
        self._connection.executemany(f"INSERT INTO {table} ({', '.join(names)}) VALUES ({marks})", moved())

    def _update_conditions(self, source: sqlite3.Connection) -> None:
        for condition, started, ended, *rest in source.execute(f"SELECT condition, {', '.join(LEFT)} FROM condition"):
            left = dict(zip(LEFT, (self._moved(started), self._moved(ended), *rest), strict=True))
            self._connection.execute(*update("condition", left, {"condition": condition}))

    def _block(self, data: Cell, base: int) -> Cell:
        """Return a block of samples with later times and higher keys."""
        # The first part keeps its times and keys.
        if not isinstance(data, bytes) or (base == 0 and self.rig_seconds == 0.0):
            return data
        width, time_at = len(self._channels.names), self._channels.index(TIME)
        rows = len(zlib.decompress(data)) // (8 * width)
        table = unpack_array(data, rows, width).copy()
        table[time_at] = np.round(table[time_at] + self.rig_seconds, _DIGITS)
        keys = table[self._channels.index(KEY)]
        keys += base * (keys > 0.0)
        return zlib.compress(table.astype("<f8").tobytes(), LEVEL)

    def _moved(self, time_s: Cell) -> Cell:
        return self._later(time_s, self.rig_seconds) if isinstance(time_s, int | float) else time_s

    @staticmethod
    def _later(time_s: float, by_s: float) -> float:
        return round(time_s + by_s, _DIGITS)

    def _last(self, table: str) -> int:
        return self._connection.execute(f"SELECT coalesce(max({TABLES[table].key}), 0) FROM {table}").fetchone()[0]

    @contextmanager
    def _transaction(self) -> Generator[None]:
        """Commit everything that the block does, chained, or nothing."""
        connection = self._connection
        connection.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._chain.seal()
            connection.execute("COMMIT")
        finally:
            if connection.in_transaction:
                connection.execute("ROLLBACK")


def _raised(key: Cell, base: int) -> Cell:
    """Return a key of the run; 0 means no repeat and is not changed."""
    return key + base if isinstance(key, int) and key > 0 else key
