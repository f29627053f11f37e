"""Which wheel is on the rig, as far as the store knows it: manual mode asks nobody to mount one."""

from __future__ import annotations

import sqlite3
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from tester.campaign.latch import made_on
from tester.rig import RigConfig
from tester.store.catalogue import run_folders
from tester.store.reader import RunReader
from tester.store.records import WheelInfo
from tester.store.schema import StoreError

NEWEST_RUNS = 50
"""So many runs are looked at for one on this rig that mounted a wheel, the newest first [A]."""


@dataclass(frozen=True, slots=True)
class Mounted:
    """The wheel that a run mounted last, as worn as it left it."""

    run: str
    wheel: WheelInfo


def mounted_wheel(runs: Path, rig: RigConfig) -> Mounted | None:
    """Return the wheel that the newest run on a rig left on it; None where there is none to go by.

    One that is worn below the rig's ``least_diameter`` is taken for changed: nothing may be done with it.
    """
    for folder in list(run_folders(runs))[: -NEWEST_RUNS - 1 : -1]:
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
            wheel = max(reader.wheels(), key=lambda one: (one.installed_s, one.wheel), default=None)
            if wheel is None or not made_on(rig, reader):
                continue
            return Mounted(folder.name, wheel) if wheel.diameter_mm >= rig.interlocks.least_diameter_mm else None
    return None


def taken_for(mounted: Mounted | None, diameter_mm: float) -> str:
    """Return which wheel is taken to be on the rig, for people; ``diameter_mm``: what is reckoned with."""
    known = f"as {mounted.run} left it" if mounted is not None else "a new one: no run on this rig says otherwise"
    return f"the wheel is taken to have {diameter_mm:.2f} mm, {known}"
