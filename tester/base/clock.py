"""The only module that reads a clock or sleeps, and the pace of a run. All other code receives its time."""

from __future__ import annotations

import time
from datetime import UTC, datetime, timedelta
from threading import Event


def monotonic() -> float:
    """Return seconds of a clock that never jumps (undefined origin)."""
    return time.monotonic()


def cpu_time() -> float:
    """Return the seconds of CPU time that this process has used."""
    return time.process_time()


def sleep_until(deadline_s: float) -> float:
    """Sleep until the monotonic ``deadline_s``; return the lateness on waking, in s, at least 0.

    An absolute deadline does not accumulate the lateness of earlier waits.
    """
    delay = deadline_s - time.monotonic()
    if delay > 0.0:
        time.sleep(delay)
    return max(0.0, time.monotonic() - deadline_s)


def wall_s() -> float:
    """Return the wall clock in seconds since 1970 (UTC), for deadlines that must survive a restart; never for control.
    """
    return time.time()


def utc_now() -> str:
    """Return the wall clock as ISO 8601 text in UTC, for records only; never for control."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def local_stamp() -> str:
    """Return the local wall clock as a folder-safe text, ``2024-02-21T14-05-09``."""
    return datetime.now().strftime("%Y-%m-%dT%H-%M-%S")


def utc_in(seconds: float) -> str:
    """Return the wall clock ``seconds`` from now as ISO 8601 text in UTC, for people only."""
    return (datetime.now(UTC) + timedelta(seconds=seconds)).isoformat(timespec="seconds").replace("+00:00", "Z")


LATE_S = 0.005
"""A wait that ends this late shows that the whole process was suspended, s: its other threads are as late [A]."""


class Pace:
    """A clock that starts at its creation, with waits until a time on it."""

    def __init__(self, times: float = 1.0) -> None:
        """Start at 0. ``times``: seconds on it in a second, above 1 only for a simulated rig as fast."""
        self.times = times
        self._origin_s = monotonic()

    def now(self) -> float:
        """Return the time since the start, s of this clock."""
        return (monotonic() - self._origin_s) * self.times

    def wait_until(self, due_s: float) -> bool:
        """Return at ``due_s`` (s of this clock); True where an urgent event has ended the wait."""
        sleep_until(self._origin_s + due_s / self.times)
        return False


class UrgentPace(Pace):
    """The pace of a run on a machine: receivers stamp arrivals by its clock, and an urgent event ends a wait."""

    def __init__(self, catch_up_s: float = 0.0, times: float = 1.0) -> None:
        """Start at 0. ``catch_up_s``: real time that receiving threads need to fetch the data that arrived during a
        suspension; ``times``: as for a ``Pace``."""
        super().__init__(times)
        self._urgent = Event()
        self._catch_up_s = catch_up_s

    def wait_until(self, due_s: float) -> bool:
        """Return at ``due_s`` (s of this clock), or with True once an urgent event has come since the last wait began.

        After a late wait the receiving threads get a moment first: otherwise the scan would treat data as stale that
        has already arrived.
        """
        delay = (due_s - self.now()) / self.times
        if delay > 0.0 and not self._urgent.is_set():
            self._urgent.wait(delay)
        if self._catch_up_s and (self.now() - due_s) / self.times > LATE_S:
            sleep_until(monotonic() + self._catch_up_s)
        urgent = self._urgent.is_set()
        self._urgent.clear()
        return urgent

    def hurry(self) -> None:
        """End the present wait, or the next one: from any thread."""
        self._urgent.set()
