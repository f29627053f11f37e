"""Tickers: they call a run's tick at the right times, in simulated or real time."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Generator
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass
from math import ceil, floor
from typing import Final, Protocol

from tester.base import clock
from tester.base.clock import Pace
from tester.base.processes import RealTimePriority

POLL_S: float = 0.02
"""Period of ``poll``, s of wall time: the greatest delay of a STOP from a screen. Also a variable where it is compiled:
a measurement sets 0, polls after every tick, and does not depend on the computer's speed.
"""
LEAVE_S: Final = 0.008
"""No poll begins within this time before a due tick, s. At 100 Hz the poll then follows a tick, and may take long."""


class Ticked(Protocol):
    """Something that a ticker ticks."""

    @property
    def finished(self) -> bool:
        """Whether nothing is left to do."""
        ...

    @property
    def waiting(self) -> bool:
        """Whether a prompt waits; simulated time then stops until the answer."""
        ...

    def tick(self, now: float) -> float:
        """Do everything due at ``now``; return the latest time of the next call (s)."""
        ...


class TickedWorld(Protocol):
    """A simulated rig, which must be advanced before each tick."""

    def advance(self, now: float) -> None:
        """Advance the rig to ``now`` (s)."""
        ...

    @property
    def urgent_s(self) -> float:
        """Time of the next arrival that the scan should not wait for (inf = none)."""
        ...


@dataclass(slots=True)
class TickStatistics:
    """How punctual the ticks were (real time only), s."""

    ticks: int = 0
    late_max_s: float = 0.0
    overruns: int = 0
    """Ticks that came after the next tick was due."""

    def note(self, late_s: float) -> None:
        """Count a tick and its lateness; a tick that something urgent brought forward is not late."""
        self.ticks += 1
        if late_s > self.late_max_s:
            self.late_max_s = late_s


def next_tick(now: float, wanted: float, urgent: float) -> float:
    """Return the time of the next tick: the earlier of ``wanted`` and ``urgent``, on a grid of microseconds, always
    after ``now``.

    Simulated time is counted, not measured: on the grid, equal runs have exactly equal times.
    """
    due = ceil((wanted if wanted < urgent else urgent) * 1e6 - 1e-3)
    soonest = floor(now * 1e6 + 0.5) + 1
    return (due if due > soonest else soonest) / 1e6


class Leaping(Protocol):
    """Something that leaps time in which only heat flows (``tester.machine.leaps``)."""

    def after(self, now: float, later: float) -> float:
        """Return the time of the next tick after that at ``now``, ``later`` or, after a leap, a time after it."""
        ...


def run_simulated(
    engine: Ticked,
    world: TickedWorld,
    *,
    lapse: float | None,
    poll: Callable[[float], None],
    leaps: Leaping | None = None,
) -> float:
    """Tick to the end in simulated time; return the rig seconds.

    ``lapse``: rig seconds per second of wall time; None: as fast as possible. ``leaps``: leaps quiet time; only
    without ``lapse``. ``poll`` is called about every ``POLL_S``
    of wall time (display, commands), also between two ticks; it must not block for long.
    """
    now = 0.0
    origin = clock.monotonic()
    poll_due = origin
    with collector_at_rest(), scan_first() if lapse is not None else nullcontext(), in_time(lapse):
        while not engine.finished:
            world.advance(now)
            wanted = engine.tick(now)
            later = next_tick(now, wanted, world.urgent_s)
            wall = clock.monotonic()
            if wall >= poll_due - LEAVE_S:  # poll now instead of waking up again: never before a tick that is due
                poll(now)
                poll_due = wall + POLL_S
            if engine.waiting:
                asked = clock.monotonic()
                while engine.waiting:
                    poll(now)
                    clock.sleep_until(clock.monotonic() + POLL_S)
                origin += clock.monotonic() - asked  # do not catch up on the time a person took
            if lapse is not None:
                poll_due = _wait(origin + later / lapse, now, poll, poll_due)
            elif leaps is not None:
                later = leaps.after(now, later)
            now = later
    return now


def run_real_time(
    engine: Ticked,
    world: TickedWorld | None,
    *,
    poll: Callable[[float], None],
    statistics: TickStatistics,
    pace: Pace | None = None,
) -> float:
    """Tick to the end in real time on absolute deadlines; return the duration, s.

    ``world``: a simulated rig in the same process, or None with hardware on the wire. ``pace``: the clock that stamps
    arrivals and can end a wait early; by default one that starts now.
    """
    pace = pace or Pace()
    now = due = poll_due = pace.now()
    with collector_at_rest(), scan_first():
        while not engine.finished:
            poll_due = _wait_paced(pace, due, now, poll, poll_due)
            now = pace.now()
            statistics.note(now - due)
            if world is not None:
                world.advance(now)
            due = engine.tick(now)
            if world is not None:
                due = min(due, world.urgent_s)
            wall = pace.now()
            if due < wall:
                statistics.overruns += 1
            if wall >= poll_due - LEAVE_S * pace.times:  # poll now instead of waking up again
                poll(now)
                poll_due = wall + POLL_S * pace.times
    return pace.now()


SWITCH_S: Final = 0.0005
"""Longest time for which another thread (recorder, reception) may delay a due scan, s (Python's default: 5 ms)."""


@contextmanager
def scan_first() -> Generator[None, None, None]:
    """Give the scan's thread the interpreter within ``SWITCH_S`` of its request."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    try:
        yield
    finally:
        sys.setswitchinterval(before)


@contextmanager
def in_time(lapse: float | None) -> Generator[None, None, None]:
    """Keep a simulated rig punctual by real-time priority, if the system grants it.

    ``lapse``: as in ``run_simulated``. Above 1 no priority is requested, because the run then uses all the processor's
    time and would leave none for other processes.
    """
    if lapse is None or lapse > 1.0:
        yield
        return
    with closing(RealTimePriority()):
        yield


def _wait(deadline: float, now: float, poll: Callable[[float], None], poll_due: float) -> float:
    """Wait until a deadline of the wall clock, polling meanwhile; return when the next poll is due."""
    while True:
        wall = clock.monotonic()
        if wall >= poll_due and deadline - wall > LEAVE_S:
            poll(now)
            poll_due = wall + POLL_S
        if max(poll_due, wall) + LEAVE_S >= deadline:
            clock.sleep_until(deadline)
            return poll_due
        clock.sleep_until(poll_due)


def _wait_paced(pace: Pace, due: float, now: float, poll: Callable[[float], None], poll_due: float) -> float:
    """Wait until ``due`` or something urgent, polling meanwhile; return when the next poll is due."""
    poll_s, leave_s = POLL_S * pace.times, LEAVE_S * pace.times
    while True:
        at = pace.now()
        if at >= poll_due and due - at > leave_s:
            poll(now)
            poll_due = at + poll_s
        last = max(poll_due, at) + leave_s >= due
        if pace.wait_until(due if last else poll_due) or last:
            return poll_due


class collector_at_rest:  # noqa: N801 - reads as a statement
    """Keeps the cyclic garbage collector away from the scan: existing objects are frozen, automatic collection is off.

    Reference counting still frees nearly everything; the young generations are collected when the block ends.
    """

    def __enter__(self) -> None:
        """Freeze existing objects and stop automatic collection."""
        gc.collect(1)  # skip the many old objects, because STOP would wait: garbage among them stays for a while
        gc.freeze()
        gc.disable()

    def __exit__(self, *_: object) -> None:
        """Restore automatic collection."""
        gc.enable()
        gc.unfreeze()
