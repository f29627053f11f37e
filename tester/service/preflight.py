"""The pre-flight list: what a person looks at before motion begins, as far as it is known without the rig.

What the rig itself says (guard, safety chain, wheel) is added while it is connected (``RunWatch.preflight``); the rest
is shown before a drive is armed. Nothing here stops a start: what must, the session, the arming and the interlocks do.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from math import isfinite
from pathlib import Path

from tester.export.results import results_of
from tester.interlocks.heat_ratio import NO_HISTORY, KnownRatio
from tester.rig import CalibrationConfig, RigConfig
from tester.service.state import Alarm, Check, DiskView
from tester.store.catalogue import run_folders
from tester.store.reader import RunReader
from tester.store.records import WheelInfo
from tester.store.schema import StoreError
from tester.store.status import RunStatus

SOON = timedelta(days=30)
"""A certificate that ends within this is named with its date [A]: a laboratory wants weeks for a calibration."""


@dataclass(frozen=True, slots=True)
class Past:
    """What the newest run in the store left: how it ended, the wheel it used last, its newest zero of the load cell."""

    status: str
    reason: str
    wheel: WheelInfo | None
    new_mm: float
    """Diameter of that wheel when it was mounted."""
    tare_utc: str
    """"" where no zero was taken, or nobody knows when."""


def past_of(runs: Path) -> Past | None:
    """Return what the newest readable run below a folder left, None where there is none."""
    for folder in reversed(list(run_folders(runs))):
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            results = results_of(reader)
            run = results.run
            wheel = max(reader.wheels(), key=lambda one: (one.installed_s, one.wheel), default=None)
            new_mm = wheel.installed_diameter_mm if wheel is not None else 0.0
            return Past(results.status.value, run.reason, wheel, new_mm, _tare_utc(reader))
    return None


def _tare_utc(reader: RunReader) -> str:
    """Return the wall clock of the newest zero: that of the first thing recorded after it."""
    at_s = max((tare.t_s for tare in reader.tares() if tare.kind != "check"), default=None)
    if at_s is None:
        return ""
    return next((event.utc for event in reader.events() if event.t_s >= at_s), "")


def known_checks(
    rig: RigConfig,
    disk: DiskView,
    alarms: Iterable[Alarm],
    past: Past | None,
    latched: str,
    now_utc: str,
    heat: KnownRatio = NO_HISTORY,
) -> tuple[Check, ...]:
    """Return the list without the rig's own part. ``latched``: why nothing may start; ``now_utc``: the wall clock;
    ``heat``: what the runs make known of the rig's heat balance."""
    return (
        disk_check(disk),
        alarms_check(alarms),
        last_run_check(past, latched),
        calibration_check(rig.calibration, now_utc, simulated=rig.simulated),
        wheel_check(past),
        zero_check(past, now_utc),
        heat_check(heat, rig),
    )


def disk_check(disk: DiskView) -> Check:
    """Return whether there is room to record a run."""
    if disk.free is None:
        return Check("disk space", None, "the disk does not say how much is free")
    return Check("disk space", not disk.low, f"{disk.free / 1e9:.1f} GB free")


def alarms_check(alarms: Iterable[Alarm]) -> Check:
    """Return whether alarms stand whose cause has not gone, or that nobody has acknowledged."""
    standing = [alarm.name for alarm in alarms]
    return Check("alarms", not standing, f"{len(standing)} standing: {', '.join(standing)}" if standing else "none")


def last_run_check(past: Past | None, latched: str) -> Check:
    """Return how the last run ended; one that tripped is wrong until it is acknowledged."""
    if past is None:
        return Check("last run", None if not latched else False, latched or "none is stored")
    if past.status == RunStatus.INTERRUPTED:
        return Check("last run", None, "was cut off: r goes on with it")
    text = past.status + (f": {past.reason}" if past.reason else "")
    if latched:
        return Check("last run", False, f"{text}; not acknowledged")
    return Check("last run", True if past.status == RunStatus.DONE else None, text)


def calibration_check(calibration: CalibrationConfig, now_utc: str, *, simulated: bool) -> Check:
    """Return whether every certificate that the rig file names is in date; those nobody has entered are named."""
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
    said = [*over, *soon, *([f"not in the rig file: {', '.join(unknown)}"] if unknown else [])]
    if not said:
        said = [f"in date until {min(end for end in ends.values() if end is not None)}"]
    return Check("calibration", False if over else None if unknown else True, "; ".join(said))


def wheel_check(past: Past | None) -> Check:
    """Return what is known of the wheel that is on; a run begins by asking for a fresh one."""
    if past is None or past.wheel is None or not isfinite(past.wheel.diameter_mm):
        return Check("wheel", None, "none on record; a fresh one comes")
    one = past.wheel
    worn = max(past.new_mm - one.diameter_mm, 0.0)
    text = f"{one.compound}, {one.diameter_mm:.2f} mm, {worn:.2f} mm worn off in {one.sliding_m:.0f} m"
    return Check("wheel", None, f"last {text}; a fresh one comes")


def zero_check(past: Past | None, now_utc: str) -> Check:
    """Return how old the zero of the load cell is; a run takes one for each wheel and before each repeat."""
    anew = "taken anew before motion"
    if past is None or not past.tare_utc:
        return Check("zero of the load cell", None, anew)
    try:
        age_s = (datetime.fromisoformat(now_utc) - datetime.fromisoformat(past.tare_utc)).total_seconds()
    except ValueError:
        return Check("zero of the load cell", None, anew)
    return Check("zero of the load cell", None, f"{age_words(age_s)} old; {anew}")


def heat_check(heat: KnownRatio, rig: RigConfig) -> Check:
    """Return from where on heat that nothing shows is told; a history that tightens nothing is worth a look."""
    limits = rig.interlocks
    tighter = heat.share(limits.heat_share, limits.heat_share_known) < limits.heat_share
    return Check("heat balance", tighter or None, heat.told(limits.heat_share, limits.heat_share_known))


def age_words(seconds: float) -> str:
    """Return an age in the largest unit of which there are two."""
    for size, unit in ((86400.0, "d"), (3600.0, "h")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 0.0) / 60.0:.0f} min"
