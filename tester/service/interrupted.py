"""Stored runs that were cut off: they have no end, and no process works on them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, run_status, under_way
from tester.store.run_reader import RunReader

NEWEST_RUNS = 200
"""Number of newest runs in which to search for interrupted ones."""


def interrupted_runs(runs: Path) -> Iterator[str]:
    """Yield the names of interrupted runs in a folder: runs without an end, at which no process works."""
    folders = sorted(runs.iterdir(), reverse=True)[:NEWEST_RUNS] if runs.is_dir() else []
    for folder in reversed(folders):
        if is_interrupted(folder):
            yield folder.name


def is_interrupted(folder: Path) -> bool:
    """Return whether a folder holds an interrupted run."""
    if not (folder / DATABASE).is_file() or under_way(folder) is not None:
        return False
    with suppress(StoreError), RunReader(folder) as reader:
        return run_status(reader.run().status, held=False, missing=False) is RunStatus.INTERRUPTED
    return False
