"""A trip that nobody has acknowledged latches a hardware rig, whoever comes next: it stands in the run's record.

The service asks for an acknowledgement, also after a restart. In the foreground the next start is the acknowledgement.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from tester.base import clock
from tester.base.source import InvalidSource, load_tree
from tester.inputs.rig import Rig
from tester.results import write_all
from tester.results.manifest import MANIFEST, manifest_problems
from tester.store.amend import acknowledge_trips
from tester.store.catalogue import run_folders, under_way
from tester.store.reader import RunReader
from tester.store.records import StoredTrip
from tester.store.schema import StoreError

MANUAL_RUNS = ".manual"
"""Folder beside the runs for the journals of manual mode."""
NEWEST_RUNS = 50
"""So many runs, and stays in manual mode, are looked at, the newest first [A]."""


@dataclass(frozen=True, slots=True)
class OpenTrip:
    """A trip that nobody has acknowledged, and the run that has it."""

    folder: Path
    trip: StoredTrip

    def __str__(self) -> str:
        """Say which."""
        compared = f" ({self.trip.compared})" if self.trip.compared else ""
        return f"{self.trip.interlock}{compared} in {self.folder.name}, {self.trip.utc}"


def made_on(rig: Rig, reader: RunReader) -> bool:
    """Tell whether a stored run was made on a rig of this name: the rest of its file may have changed since."""
    info = reader.run().info
    if info.simulated is not rig.simulated:
        return False
    try:
        tree = load_tree(info.rig_text, "rig.yaml").data
    except InvalidSource:
        return False
    return isinstance(tree, dict) and tree.get("rig") == rig.name


def open_trips(runs: Path, rig: Rig, own: Path | None = None) -> list[OpenTrip]:
    """Return the trips on a hardware rig that nobody has acknowledged; a simulated one is new at every start.

    Runs under way are left out, but for ``own``.
    """
    return [] if rig.simulated else [*_found(runs, rig, own)]


def _found(runs: Path, rig: Rig, own: Path | None) -> Iterator[OpenTrip]:
    newest = slice(None, -NEWEST_RUNS - 1, -1)
    for folder in (*[*run_folders(runs)][newest], *[*run_folders(runs / MANUAL_RUNS)][newest]):
        if folder != own and under_way(folder) is not None:
            continue
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            trips = [one for one in reader.trips() if not one.acknowledged_utc]
            if trips and made_on(rig, reader):
                yield from (OpenTrip(folder, one) for one in trips)


def acknowledge(found: Sequence[OpenTrip], by: str, own: Path | None = None) -> None:
    """Record who has acknowledged trips, and make tables and manifest of their runs anew, but for ``own``.

    A folder that is not as its manifest says keeps its manifest: a new one would hide that. Raises StoreError, OSError.
    """
    for folder in dict.fromkeys(one.folder for one in found):
        sound = folder != own and (folder / MANIFEST).is_file() and not _problems(folder)
        acknowledge_trips(folder, [one.trip.id for one in found if one.folder == folder], by, clock.utc_now())
        if sound:
            write_all(folder)


def _problems(folder: Path) -> list[str]:
    try:
        return manifest_problems(folder)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        return [str(error)]
