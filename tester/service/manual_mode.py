"""Manual mode in the service: the journal of each stay in it, and what the store knows to be on the rig."""

from __future__ import annotations

import sqlite3
from contextlib import suppress
from pathlib import Path

from tester.base import clock
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.machine.manual import NAME
from tester.machine.served import Left, ServedKind
from tester.run.folder import make_folder
from tester.run.kind_lookup import recipe_part
from tester.run.latch import MANUAL_RUNS, made_on
from tester.run.part_run import Unsampled
from tester.run.provenance import accepted_risks
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.records import RunInfo
from tester.store.run_folders import run_folders
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter


def open_record(runs: Path, rig: Rig, operator: str, accept_risk: str = "") -> RunWriter:
    """Return the journal of one stay in manual mode: a record of its own, without samples, in ``runs/.manual``.

    It is not a run: it holds commands, modes, trips and tares, and no list of runs shows it. Raises OSError,
    sqlite3.Error, StoreError.
    """
    folder = make_folder(runs / MANUAL_RUNS, NAME)
    writer = Unsampled(folder / DATABASE, quantities_on(rig), clock=clock.monotonic, utc=clock.utc_now)
    started_utc = clock.utc_now()
    part = recipe_part(rig)
    info = RunInfo(folder.name, NAME, "", rig.text, started_utc, rig.simulated, part.kind, part.axes, operator=operator,
                   metadata=accepted_risks(rig, accept_risk))  # fmt: skip
    writer.begin_run(info, [], [])
    return writer


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
