"""Who calls the tick, and when. Two tickers, one tick: simulated time and real time."""

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

POLL_S: Final = 0.02
"""Period of ``poll``, s of wall time: a STOP from a screen is heard within it."""
LEAVE_S: Final = 0.008
"""No poll begins this shortly before a tick is due, s: at 100 Hz it follows a tick, and may take long."""


class Ticked(Protocol):
    """What a ticker drives."""

    @property
    def finished(self) -> bool:
        """Nothing is left to do."""
        ...

    @property
    def waiting(self) -> bool:
        """A person is asked: simulated time stands still until the answer is there."""
        ...

    def tick(self, now: float) -> float:
        """Do what is due at ``now``; return when to be called again at the latest (s)."""
        ...


class TickedWorld(Protocol):
    """A simulated rig: it must be brought up to date before each tick."""

    def advance(self, now: float) -> None:
        """Let the rig live until ``now`` (s)."""
        ...

    @property
    def urgent_s(self) -> float:
        """When something arrives that the scan should not wait for (inf = nothing on its way)."""
        ...


@dataclass(slots=True)
class TickStatistics:
    """How punctual the ticks were (real time only), s."""

    ticks: int = 0
    late_max_s: float = 0.0
    overruns: int = 0
    """Ticks that came later than their successor was due."""

    def note(self, late_s: float) -> None:
        """Count a tick that came this late; one that something urgent brought forward is not late."""
        self.ticks += 1
        if late_s > self.late_max_s:
            self.late_max_s = late_s


def next_tick(now: float, wanted: float, urgent: float) -> float:
    """Return the next tick's time: the earlier of both, on a grid of microseconds, and always after ``now``.

    Simulated time is counted, not measured: on a grid, equal runs have equal times to the last bit.
    """
    due = ceil((wanted if wanted < urgent else urgent) * 1e6 - 1e-3)
    soonest = floor(now * 1e6 + 0.5) + 1
    return (due if due > soonest else soonest) / 1e6


def run_simulated(engine: Ticked, world: TickedWorld, *, lapse: float | None, poll: Callable[[float], None]) -> float:
    """Run to the end in simulated time; return the rig seconds.

    ``lapse``: rig seconds per second of wall time, or None for as fast as it goes. ``poll`` is called about every
    ``POLL_S`` of wall time (display, commands), between two ticks as well; it must not block for long.
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
            if wall >= poll_due - LEAVE_S:  # now rather than with a wake-up of its own: never before a tick that is due
                poll(now)
                poll_due = wall + POLL_S
            if engine.waiting:
                asked = clock.monotonic()
                while engine.waiting:
                    poll(now)
                    clock.sleep_until(clock.monotonic() + POLL_S)
                origin += clock.monotonic() - asked  # a person's time is not made up for
            if lapse is not None:
                poll_due = _wait(origin + later / lapse, now, poll, poll_due)
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
    """Run to the end in real time on absolute deadlines; return the seconds it took.

    ``world``: a simulated rig in the same process, or None when hardware is on the wire. ``pace``: the clock that
    stamps what arrives, and what ends a wait early; by default one that starts now.
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
            if wall >= poll_due - LEAVE_S:  # now rather than with a wake-up of its own
                poll(now)
                poll_due = wall + POLL_S
    return pace.now()


SWITCH_S: Final = 0.0005
"""How long another thread (recorder, reception) may keep the interpreter from a scan that is due, s (Python: 5 ms)."""


@contextmanager
def scan_first() -> Generator[None, None, None]:
    """Let the scan have the interpreter soon after it asks for it."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    try:
        yield
    finally:
        sys.setswitchinterval(before)


@contextmanager
def in_time(lapse: float | None) -> Generator[None, None, None]:
    """Keep a simulated rig's time as a machine's is kept: before every ordinary process, where that is granted.

    ``lapse`` as in ``run_simulated``. Faster than a machine lives (above 1) nothing is asked for: such a run takes
    what the processor gives, and would leave nothing to others.
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
    while True:
        at = pace.now()
        if at >= poll_due and due - at > LEAVE_S:
            poll(now)
            poll_due = at + POLL_S
        last = max(poll_due, at) + LEAVE_S >= due
        if pace.wait_until(due if last else poll_due) or last:
            return poll_due


class collector_at_rest:  # noqa: N801 - reads as a statement
    """Keep the cyclic garbage collector away from the scan: what exists is frozen, automatic runs are off.

    Reference counting still frees nearly everything; the young generations are collected by hand when the block ends.
    """

    def __enter__(self) -> None:
        """Freeze what exists and stop automatic collection."""
        gc.collect(1)  # the old ones are many, and STOP would wait for them: what is garbage there stays a while
        gc.freeze()
        gc.disable()

    def __exit__(self, *_: object) -> None:
        """Restore."""
        gc.enable()
        gc.unfreeze()
