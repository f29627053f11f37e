"""Free space where runs are stored: measured every few seconds, with an alarm if it is low or the disk hangs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from tester.base import clock
from tester.base.screen import Check
from tester.service.alarms import AlarmList, Cause
from tester.service.state_view import DiskView
from tester.store.disk import MARGIN, FreeRoom

EVERY_S = 10.0
"""Period of measurements, s."""
FIRST_S = 1.0
"""How long the service waits at its start for the first measurement, s."""
LOW_BYTES = 500_000_000
"""Less than this counts as low, whatever the run needs [A]: one compound of Table 2 takes some tens of MB."""
_CONSEQUENCE = "a run that cannot be recorded is stopped"


class DiskWatch:
    """Measures the free space under a folder, raises alarms about it, and gives notice when the space becomes low.
    """

    def __init__(self, runs: Path, alarms: AlarmList, notify: Callable[[str], None]) -> None:
        """Start the first measurement and wait briefly for it. ``notify`` is called with the free space in words."""
        self._runs = runs
        self._alarms = alarms
        self._notify = notify
        self._low = False
        self._due_s = clock.monotonic() + EVERY_S
        self._room = FreeRoom(runs)
        self._room.look()
        self._room.wait(FIRST_S)

    def view(self, now_s: float, needed: int) -> DiskView:
        """Return the present state, and set its alarms. ``now_s``: rig time; ``needed``: bytes that the run will
        take.
        """
        if clock.monotonic() >= self._due_s:
            self._due_s = clock.monotonic() + EVERY_S
            self._room.look()
        silent = Cause("disk silent", 2, f"{self._runs} does not report its free space", _CONSEQUENCE)
        self._alarms.set(self._room.hangs, silent, now_s)
        free, least = self._room.free, max(LOW_BYTES, MARGIN * needed)
        if free is None:
            return DiskView(None, needed, self._low)
        was_low, self._low = self._low, free < least
        text = f"{free / 1e6:.0f} MB free"
        full = Cause("disk nearly full", 2, text, _CONSEQUENCE, value=free / 1e6, limit=least / 1e6, unit="MB")
        self._alarms.set(self._low, full, now_s)
        if self._low and not was_low:
            self._notify(text)
        return DiskView(free, needed, self._low)


def disk_check(disk: DiskView) -> Check:
    """Return the check whether there is room to record a run."""
    if disk.free is None:
        return Check("disk space", None, "the disk does not report its free space")
    return Check("disk space", not disk.low, f"{disk.free / 1e9:.1f} GB free")
