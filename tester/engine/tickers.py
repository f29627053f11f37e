"""Who calls the tick, and when. Two tickers, one tick: simulated time and real time."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import Protocol

from tester import clock

POLL_S = 0.02
"""Period of ``poll``, s of wall time: a STOP from a screen is heard within it."""
LEAVE_S = 0.002
"""No poll begins this shortly before a tick is due, s."""


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


class World(Protocol):
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


def next_tick(now: float, wanted: float, urgent: float) -> float:
    """Return the next tick's time: the earlier of both, on a grid of microseconds, and always after ``now``.

    Simulated time is counted, not measured: on a grid, equal runs have equal times to the last bit.
    """
    due = ceil((wanted if wanted < urgent else urgent) * 1e6 - 1e-3)
    soonest = round(now * 1e6) + 1
    return (due if due > soonest else soonest) / 1e6


def run_simulated(engine: Ticked, world: World, *, lapse: float | None, poll: Callable[[float], None]) -> float:
    """Run to the end in simulated time; return the rig seconds.

    ``lapse``: rig seconds per second of wall time, or None for as fast as it goes. ``poll`` is called about every
    ``POLL_S`` of wall time (display, commands), between two ticks as well; it must not block for long.
    """
    now = 0.0
    origin = clock.monotonic()
    poll_due = origin
    with collector_at_rest():
        while not engine.finished:
            world.advance(now)
            wanted = engine.tick(now)
            later = next_tick(now, wanted, world.urgent_s)
            if lapse is not None:
                poll_due = _wait(origin + later / lapse, now, poll, poll_due)
            wall = clock.monotonic()
            if wall >= poll_due:
                poll(now)
                poll_due = wall + POLL_S
            if engine.waiting:
                asked = clock.monotonic()
                while engine.waiting:
                    poll(now)
                    clock.sleep_until(clock.monotonic() + POLL_S)
                origin += clock.monotonic() - asked  # a person's time is not made up for
            now = later
    return now


def run_real_time(
    engine: Ticked, world: World | None, *, poll: Callable[[float], None], statistics: TickStatistics
) -> float:
    """Run to the end in real time on absolute deadlines; return the seconds it took.

    ``world``: a simulated rig in the same process, or None when hardware is on the wire.
    """
    origin = clock.monotonic()
    now = due = 0.0
    poll_due = origin
    with collector_at_rest():
        while not engine.finished:
            poll_due = _wait(origin + due, now, poll, poll_due)
            now = clock.monotonic() - origin
            statistics.ticks += 1
            statistics.late_max_s = max(statistics.late_max_s, now - due)
            if world is not None:
                world.advance(now)
            due = engine.tick(now)
            if world is not None:
                due = min(due, world.urgent_s)
            if due < clock.monotonic() - origin:
                statistics.overruns += 1
            wall = clock.monotonic()
            if wall >= poll_due:
                poll(now)
                poll_due = wall + POLL_S
    return clock.monotonic() - origin


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


class collector_at_rest:  # noqa: N801 - reads as a statement
    """Keep the cyclic garbage collector away from the scan: what exists is frozen, automatic runs are off.

    Reference counting still frees nearly everything; the young generations are collected by hand when the block ends.
    """

    def __enter__(self) -> None:
        """Freeze what exists and stop automatic collection."""
        gc.collect()
        gc.freeze()
        gc.disable()

    def __exit__(self, *_: object) -> None:
        """Restore."""
        gc.enable()
        gc.unfreeze()
