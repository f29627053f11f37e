"""The record of manual mode: each stay has its own journal."""

from __future__ import annotations

from pathlib import Path

from tester.base import clock
from tester.inputs.rig import Rig
from tester.inputs.rig.sensors import quantities_on
from tester.machine.manual import NAME
from tester.run.folder import make_folder
from tester.run.kinds import recipe_part
from tester.run.latch import MANUAL_RUNS
from tester.run.part_run import Unsampled
from tester.run.provenance import accepted_risks
from tester.store.reader import DATABASE
from tester.store.records import RunInfo
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
