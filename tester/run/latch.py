"""An unacknowledged trip, stored in the run, blocks the next start on a real rig, even after a restart.

The service asks for an acknowledgement. In the foreground the next start is the acknowledgement.
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
from tester.results.run_files import MANIFEST, manifest_problems, write_all
from tester.store.amend import acknowledge_trips
from tester.store.journal_records import StoredTrip
from tester.store.record_schema import StoreError
from tester.store.run_folders import run_folders, under_way
from tester.store.run_reader import RunReader

MANUAL_RUNS = ".manual"
"""Folder beside the runs for the journals of manual mode."""
NEWEST_RUNS = 50
"""Number of newest runs, and of newest stays in manual mode, in which to search for trips [A]."""


@dataclass(frozen=True, slots=True)
class OpenTrip:
    """An unacknowledged trip, and the folder of its run."""

    folder: Path
    trip: StoredTrip

    def __str__(self) -> str:
        """Return interlock, run and time as text."""
        compared = f" ({self.trip.compared})" if self.trip.compared else ""
        return f"{self.trip.interlock}{compared} in {self.folder.name}, {self.trip.utc}"


def made_on(rig: Rig, reader: RunReader) -> bool:
    """Return whether a stored run was made on a rig of this name; the rest of its file may have changed since."""
    info = reader.run().info
    if info.simulated is not rig.simulated:
        return False
    try:
        tree = load_tree(info.rig_text, "rig.yaml").data
    except InvalidSource:
        return False
    return isinstance(tree, dict) and tree.get("rig") == rig.name


def open_trips(runs: Path, rig: Rig, own: Path | None = None) -> list[OpenTrip]:
    """Return the unacknowledged trips on a real rig. A simulated rig has none, because it is new at every start.

    Skips runs under way, except ``own``.
    """
    return [] if rig.simulated else [*_found(runs, rig, own)]


def _found(runs: Path, rig: Rig, own: Path | None) -> Iterator[OpenTrip]:
    newest = slice(None, -NEWEST_RUNS - 1, -1)
    for folder in (*[*run_folders(runs)][newest], *[*run_folders(runs / MANUAL_RUNS)][newest]):
        if folder != own and under_way(folder) is not None:
            continue
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            trips = [trip for trip in reader.trips() if not trip.acknowledged_utc]
            if trips and made_on(rig, reader):
                yield from (OpenTrip(folder, trip) for trip in trips)


def acknowledge(found: Sequence[OpenTrip], by: str, own: Path | None = None) -> None:
    """Record who acknowledged the trips, and write tables and manifest of their runs again, except for ``own``.

    If a folder differs from its manifest, the manifest stays: a new one would hide the difference. Raises StoreError,
    OSError.
    """
    for folder in dict.fromkeys(trip.folder for trip in found):
        sound = folder != own and (folder / MANIFEST).is_file() and not _problems(folder)
        acknowledge_trips(folder, [trip.trip.id for trip in found if trip.folder == folder], by, clock.utc_now())
        if sound:
            write_all(folder)


def _problems(folder: Path) -> list[str]:
    try:
        return manifest_problems(folder)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        return [str(error)]
