"""Adds people's later decisions to the record of a finished run, each on disk at once."""

from __future__ import annotations

import sqlite3
from collections.abc import Generator, Iterable
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from tester.base.trouble import in_words
from tester.store.chain import Chain
from tester.store.journal_records import StoredExclusion
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError, migrate
from tester.store.records import StoredRepeat
from tester.store.sql import columns_in, insert, update


@contextmanager
def amended(folder: Path) -> Generator[sqlite3.Connection]:
    """Yield the record in ``folder`` inside a transaction, which is chained and committed at the block's end.

    An older record is migrated to the present schema. Raises StoreError.
    """
    path = folder / DATABASE
    try:
        uri = f"{path.absolute().as_uri()}?mode=rw"
        with closing(sqlite3.connect(uri, uri=True, isolation_level=None)) as database:
            # EXTRA: if the deletion of a rollback journal were not yet on disk, the journal would undo the row after a
            # power cut.
            database.execute("PRAGMA synchronous = EXTRA")
            migrate(database)
            # Leave WAL mode, as at the end of a run, because the manifest covers a single file. A reader of a record
            # still in WAL mode prevents that; the commit then waits in the log until the reader leaves.
            with suppress(sqlite3.OperationalError):
                database.execute("PRAGMA journal_mode = DELETE")
            chain = Chain(database)
            database.execute("BEGIN IMMEDIATE")
            yield database
            chain.seal()
            database.execute("COMMIT")
    except sqlite3.Error as error:
        raise StoreError(f"{path} cannot be written: {in_words(error)}") from error


def acknowledge_trips(folder: Path, trips: Iterable[int], by: str, utc: str) -> None:
    """Store who acknowledged trips (given by number) of a finished run. Raises StoreError."""
    with amended(folder) as database:
        for trip in trips:
            database.execute(*update("trip", {"acknowledged_utc": utc, "acknowledged_by": by}, {"id": trip}))


def standing(exclusions: Iterable[StoredExclusion]) -> dict[tuple[int, int, int], StoredExclusion]:
    """Return the exclusions now in force, by condition, repeat and attempt: the last decision on each counts."""
    present: dict[tuple[int, int, int], StoredExclusion] = {}
    for exclusion in exclusions:
        if exclusion.excluded:
            present[exclusion.target] = exclusion
        else:
            present.pop(exclusion.target, None)
    return present


def add_exclusion(folder: Path, exclusion: StoredExclusion) -> None:
    """Add a person's decision on a repeat to the record in ``folder``; assign its id. It is on disk when this returns.

    A record of an older schema is migrated to the present one. Raises StoreError.
    """
    with amended(folder) as database:
        database.execute(*insert("exclusion", columns_in(exclusion) | {"id": None}))


def problems(exclusions: Iterable[StoredExclusion], repeats: Iterable[StoredRepeat]) -> list[str]:
    """Return faults of a run's exclusions: missing rows, and rows for repeats that are not committed."""
    listed = list(exclusions)
    committed = {repeat.target for repeat in repeats}
    ids = {exclusion.id for exclusion in listed}
    faults = [f"exclusion {number} is gone" for number in range(1, max(ids, default=0)) if number not in ids]
    for exclusion in listed:
        if exclusion.target not in committed:
            which = f"condition {exclusion.condition}, repeat {exclusion.repeat}, attempt {exclusion.attempt}"
            faults.append(f"exclusion {exclusion.id} names {which}, which is not committed")
    return faults
