"""Finds out from the store what is on the rig: manual mode has no prompt to mount anything."""

from __future__ import annotations

import sqlite3
from contextlib import suppress
from pathlib import Path

from tester.inputs.rig import Rig
from tester.machine.served import Left, ServedKind
from tester.run.latch import made_on
from tester.store.catalogue import run_folders
from tester.store.reader import RunReader
from tester.store.schema import StoreError

NEWEST_RUNS = 50
"""Number of newest runs searched for one on this rig that mounted something [A]."""


def left_on_rig(runs: Path, rig: Rig, kind: ServedKind) -> Left | None:
    """Return what the newest run on a rig left on it; None if unknown."""
    for folder in list(run_folders(runs))[: -NEWEST_RUNS - 1 : -1]:
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            if not made_on(rig, reader):
                continue
            left = kind.left(reader, folder.name)
            if left.known:
                return left if left.usable(rig) else None
    return None
