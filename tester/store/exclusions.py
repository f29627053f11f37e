"""Repeats that a person leaves out of a mean, or takes in again: rows that are only ever added to a run's record."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from contextlib import closing, suppress
from pathlib import Path

from tester.store.chain import Chain
from tester.store.reader import DATABASE
from tester.store.records import StoredExclusion, StoredRepeat
from tester.store.schema import StoreError, migrate
from tester.trouble import in_words

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
            values = (*said.target, said.excluded, said.reason, said.operator, said.utc, said.software_version)
            database.execute("BEGIN IMMEDIATE")
            database.execute(_ADD, (*values, said.manifest_before))
            chain.seal()
            database.execute("COMMIT")
    except sqlite3.Error as error:
        raise StoreError(f"{path} cannot be written: {in_words(error)}") from error


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
