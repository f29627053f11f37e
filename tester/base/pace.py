"""The pace of a run in real time: seconds since it began, and waiting for absolute deadlines."""

from __future__ import annotations

from threading import Event

from tester.base import clock

LATE_S = 0.005
"""A wait that ends this late has seen the whole process stand still, s: its other threads are as late [A]."""


class Pace:
    """A clock that starts now, and waits by it."""

    def __init__(self) -> None:
        """Start at 0."""
        self._origin_s = clock.monotonic()

    def now(self) -> float:
        """Return the seconds since the start."""
        return clock.monotonic() - self._origin_s

    def wait_until(self, due_s: float) -> bool:
        """Return at ``due_s`` (s); True where something urgent has ended the wait."""
        clock.sleep_until(self._origin_s + due_s)
        return False


class UrgentPace(Pace):
    """The pace of a run on a machine: edges stamp what arrives by its clock, and something urgent ends a wait."""

    def __init__(self, catch_up_s: float = 0.0) -> None:
        """Start at 0. ``catch_up_s``: what threads that receive need to fetch what came while the process stood."""
        super().__init__()
        self._urgent = Event()
        self._catch_up_s = catch_up_s

    def wait_until(self, due_s: float) -> bool:
        """Return at ``due_s`` (s), or with True as soon as something urgent has arrived since the last wait began.

        After a wait that ended late the receiving threads get a moment first: the scan would take data for stale that
        is there already.
        """
        delay = due_s - self.now()
        if delay > 0.0 and not self._urgent.is_set():
            self._urgent.wait(delay)
        if self._catch_up_s and self.now() - due_s > LATE_S:
            clock.sleep_until(clock.monotonic() + self._catch_up_s)
        urgent = self._urgent.is_set()
        self._urgent.clear()
        return urgent

    def hurry(self) -> None:
        """End the wait under way, or the next one: from any thread."""
        self._urgent.set()
