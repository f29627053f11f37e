"""Repeats that a person leaves out of a mean, or takes in again: rows that are only ever added to a run's record."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tester.store.amend import amended
from tester.store.records import StoredExclusion, StoredRepeat

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
