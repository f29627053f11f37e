"""Wall time of a run: the price of a dry run on this computer before it begins, and the time left during a run."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator
from contextlib import suppress
from datetime import datetime
from importlib.util import find_spec
from itertools import islice
from math import fsum
from pathlib import Path
from statistics import median
from typing import Final

from tester.base.clock import monotonic
from tester.inputs.recipe.time_estimate import Estimate
from tester.store.journal_records import LEAP
from tester.store.record_schema import StoreError
from tester.store.run_folders import run_folders
from tester.store.run_reader import RunReader

PLAIN: Final = 300.0
"""Rig seconds that are not leapt per second of wall time where no run shows it, in Python: a wheel 255 to 280, a track
350 to 630 (docs/performance.md).
"""
COMPILED: Final = 4.0
"""... and so many times as many where the scan is compiled (docs/performance.md)."""
BESIDE_S: Final = 2.0
"""Wall time for loading, connecting and writing the tables, s [A]."""
NEWEST, COUNTED = 20, 3
"""So many of the newest runs are looked at, and so many of them count."""
PACED: Final = 10.0
"""A run with fewer rig seconds per second of wall time was not simulated as fast as possible [A]."""
SHOWN_S: Final = 1.0
"""The time left is shown after this wall time of work, s [A]."""


def price_s(expected: Estimate, kind: str, under: Path) -> float:
    """Return the wall time of a run in virtual time on this computer, s.

    The newest runs of the kind in the folder ``under`` show the computer's pace; without any, stated figures count.
    """
    paces = list(islice(_paces(kind, under), COUNTED))
    pace = median(paces) if paces else PLAIN * (COMPILED if _compiled() else 1.0)
    return BESIDE_S + (expected.rig_seconds - expected.leapt_s) / pace


def _compiled() -> bool:
    """Return whether the scan is compiled here, without loading it."""
    found = find_spec("tester.machine.engine")
    return found is not None and not str(found.origin).endswith(".py")


def _paces(kind: str, under: Path) -> Iterator[float]:
    """Yield the rig seconds per second of wall time, without leaps, of the simulated runs of a kind on this computer,
    the newest first.
    """
    for folder in sorted(run_folders(under), reverse=True)[:NEWEST]:
        with suppress(StoreError), RunReader(folder) as reader:
            run, sessions = reader.run(), reader.sessions()
            here = run.info.simulated and run.info.kind == kind and [one.host for one in sessions] == [platform.node()]
            if not here or not run.ended_utc:
                continue
            took = datetime.fromisoformat(run.ended_utc) - datetime.fromisoformat(run.info.started_utc)
            scanned_s = run.rig_seconds - fsum(map(float, reader.event_data(LEAP)))
            if scanned_s > PACED * took.total_seconds() > 0.0:
                yield scanned_s / took.total_seconds()


class WallTime:
    """The wall time left of a run, by its pace so far; time in which no work was done does not count."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        """Begin before the first look. ``clock``: s."""
        self._clock = clock
        self._at_s = self._done_s = self._first_s = 0.0
        self._wall_s = -1.0
        """Wall time in which work was done; below 0 before the first look."""

    def left_s(self, done_s: float, left_s: float) -> float | None:
        """Return the wall time left, s; None in the first second. ``done_s``, ``left_s``: rig time of the work."""
        now = self._clock()
        if self._wall_s < 0.0:
            self._wall_s, self._first_s = 0.0, done_s
        elif done_s > self._done_s:
            self._wall_s += now - self._at_s
        self._at_s, self._done_s = now, done_s
        return left_s * self._wall_s / (done_s - self._first_s) if self._wall_s >= SHOWN_S else None
