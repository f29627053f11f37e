"""The pre-flight list: the checks before motion begins that need no connection to the rig.

While the rig is connected, its own checks (guard, safety chain, mounted specimen) are added (``RunWatch.preflight``).
The list is shown before a drive is armed. No check in it prevents a start: the session, the arming and the interlocks
do.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import date, timedelta
from pathlib import Path

from tester.base.screen import Check
from tester.inputs.rig import CalibrationConfig, Rig
from tester.machine.run_parts import History, Left
from tester.machine.served import ServedKind
from tester.results.run_results import results_of
from tester.run.latch import made_on
from tester.service.disk_watch import disk_check
from tester.service.state_view import Alarm, DiskView
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, run_folders
from tester.store.run_reader import RunReader

SOON = timedelta(days=30)
"""A certificate that expires within this time is shown with its date [A]: a laboratory needs weeks for a
calibration.
"""


@dataclass(frozen=True, slots=True)
class Past:
    """The outcome of the newest stored run, and what it left on its rig."""

    status: str
    reason: str
    left: Left


def past_of(runs: Path, kind: ServedKind) -> Past | None:
    """Return the outcome of the newest readable run in a folder and what it left on the rig; None if there is no run.

    Runs on rigs of another kind are skipped: they left nothing on this rig.
    """
    for folder in reversed(list(run_folders(runs))):
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            results = results_of(reader)
            if results.run.info.kind != kind.machine.kind:
                continue
            return Past(results.status.value, results.run.reason, kind.left(reader, folder.name))
    return None


NEWEST_RUNS = 50
"""Number of newest runs in which to search for one on this rig that mounted something [A]."""


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


def known_checks(
    rig: Rig,
    disk: DiskView,
    alarms: Iterable[Alarm],
    past: Past | None,
    latched: str,
    now_utc: str,
    history: History | None = None,
) -> tuple[Check, ...]:
    """Return the list without the checks of the connected rig.

    ``latched``: why nothing may start; ``now_utc``: the wall clock; ``history``: what stored runs show about the rig,
    None until they have been read.
    """
    return (
        disk_check(disk),
        alarms_check(alarms),
        last_run_check(past, latched),
        calibration_check(rig.certificates(), now_utc, simulated=rig.simulated),
        *(history.checks(rig, past.left if past is not None else None, now_utc) if history is not None else ()),
    )


def alarms_check(alarms: Iterable[Alarm]) -> Check:
    """Return the check whether alarms are active or unacknowledged."""
    names = [alarm.name for alarm in alarms]
    return Check("alarms", not names, f"{len(names)} in the list: {', '.join(names)}" if names else "none")


def last_run_check(past: Past | None, latched: str) -> Check:
    """Return the check of how the last run ended; a trip fails it until the trip is acknowledged."""
    if past is None:
        return Check("last run", None if not latched else False, latched or "none is stored")
    if past.status == RunStatus.INTERRUPTED:
        return Check("last run", None, "was cut off: r resumes it")
    text = past.status + (f": {past.reason}" if past.reason else "")
    if latched:
        return Check("last run", False, f"{text}; not acknowledged")
    return Check("last run", True if past.status == RunStatus.DONE else None, text)


def calibration_check(calibration: CalibrationConfig, now_utc: str, *, simulated: bool) -> Check:
    """Return the check whether every certificate in the rig file is valid; missing entries are listed."""
    if simulated:
        return Check("calibration", True, "simulated sensors need none")
    today = date.fromisoformat(now_utc[:10])
    over: list[str] = []
    soon: list[str] = []
    unknown: list[str] = []
    ends = calibration.ends()
    for name, end in ends.items():
        if end is None:
            unknown.append(name)
        elif end < today:
            over.append(f"{name} ended {end}")
        elif end - today <= SOON:
            soon.append(f"{name} ends {end}")
    texts = [*over, *soon, *([f"not in the rig file: {', '.join(unknown)}"] if unknown else [])]
    if not texts:
        texts = [f"in date until {min(end for end in ends.values() if end is not None)}"]
    return Check("calibration", False if over else None if unknown else True, "; ".join(texts))
