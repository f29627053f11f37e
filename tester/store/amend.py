"""Add to the record of a run that is over: what people say of it afterwards, each word on the disk at once."""

from __future__ import annotations

import sqlite3
from collections.abc import Generator, Iterable
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from tester.base.trouble import in_words
from tester.store.chain import Chain
from tester.store.reader import DATABASE
from tester.store.records import StoredExclusion, StoredRepeat
from tester.store.schema import StoreError, migrate


@contextmanager
def amended(folder: Path) -> Generator[sqlite3.Connection]:
    """Give the record in ``folder`` inside a transaction that is chained and committed at the block's end.

    An older record is brought to the present schema. Raises StoreError.
    """
    path = folder / DATABASE
    try:
        uri = f"{path.absolute().as_uri()}?mode=rw"
        with closing(sqlite3.connect(uri, uri=True, isolation_level=None)) as database:
            # EXTRA: a rollback journal whose deletion is not on the disk would take the row back.
            database.execute("PRAGMA synchronous = EXTRA")
            migrate(database)
            # Not WAL any more, as after the end of a run: the manifest counts what is in the one file. Somebody who
            # reads a record that is still WAL prevents that; then what is committed waits in the log until they leave.
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
    """Record who has acknowledged trips (their numbers) of a run that is over. Raises StoreError."""
    sql = "UPDATE trip SET acknowledged_utc = ?, acknowledged_by = ? WHERE id = ?"
    with amended(folder) as database:
        database.executemany(sql, [(utc, by, one) for one in trips])


_ADD = """
INSERT INTO exclusion (condition, repeat, attempt, excluded, reason, operator, utc, software_version, manifest_before)
VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)
"""


def standing(said: Iterable[StoredExclusion]) -> dict[tuple[int, int, int], StoredExclusion]:
    """Return what is left out at present, by condition, repeat and attempt: the last word on each counts."""
    found: dict[tuple[int, int, int], StoredExclusion] = {}
    for one in said:
        if one.excluded:
            found[one.target] = one
        else:
            found.pop(one.target, None)
    return found


def add_exclusion(folder: Path, said: StoredExclusion) -> None:
    """Add a person's word on a repeat to the record in ``folder``, on the disk when this returns; its id is given here.

    A record of an older schema is brought to the present one. Raises StoreError.
    """
    values = (*said.target, said.excluded, said.reason, said.operator, said.utc, said.software_version)
    with amended(folder) as database:
        database.execute(_ADD, (*values, said.manifest_before))


def problems(said: Iterable[StoredExclusion], repeats: Iterable[StoredRepeat]) -> list[str]:
    """Return what is wrong with a run's exclusions: rows that are gone, and such that speak of no committed repeat."""
    listed = list(said)
    committed = {repeat.target for repeat in repeats}
    found = [f"exclusion {number} is gone" for number in _gaps([one.id for one in listed])]
    for one in listed:
        if one.target not in committed:
            found.append(f"exclusion {one.id} speaks of condition {one.condition}, repeat {one.repeat}, "
                         f"attempt {one.attempt}, which is not committed")  # fmt: skip
    return found


def _gaps(ids: list[int]) -> list[int]:
    return sorted(set(range(1, max(ids, default=0) + 1)) - set(ids))
