"""Real time: lateness of ticks beside a bare absolute-deadline loop, with and without a busy core.

Both loops have real-time priority where it is granted, like a run on a machine, so that other processes on this
computer do not determine the figures. The rig slides (the rate of that state is 100 Hz). "1 kHz" is the tick with SYNC
and polls every 10th: wires and drivers are served every millisecond, a scan follows every 10 ms.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Generator, Sequence
from contextlib import ExitStack, closing, contextmanager, nullcontext
from dataclasses import dataclass, field
from math import ceil
from typing import NamedTuple

from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most, ratio
from bench.live import SLIDING_RECIPE, LiveRun, live_run
from bench.stopwatch import cpu_ns
from tester.base import clock
from tester.base.processes import RealTimePriority
from tester.machine.tickers import TickStatistics, collector_at_rest, run_real_time


class Rate(NamedTuple):
    """A rate with its limits: maximum CPU share of a core in %; ``every_tick``: no tick is missed."""

    name: str
    period_s: float
    share_percent: float
    every_tick: bool


RATES = (Rate("100 Hz", 0.01, 3.0, True), Rate("1 kHz", 0.001, 15.0, False))
"""At 1 kHz the bare loop also misses ticks on a machine without real-time scheduling: there the limit is on the
ratio."""
LATENESS_LIMIT = 2.0
"""Limit of the 99th percentile relative to the bare loop's."""

_TINY_S = 1e-6

SPIN = "while True: pass"


@dataclass(slots=True)
class Punctuality:
    """The result of one stretch of real time."""

    late_s: list[float] = field(default_factory=list[float])
    missed: int = 0
    cpu_share: float = 0.0
    seconds: float = 0.0
    tripped: str = ""
    """Why the rig stopped early: late scans make data stale."""

    @property
    def p99_us(self) -> float:
        """99th percentile of the lateness, in us."""
        return percentile(self.late_s, 0.99) * 1e6


@dataclass(slots=True)
class Columns:
    """The runs of one rate beside one neighbour."""

    bare: list[Punctuality] = field(default_factory=list[Punctuality])
    rig: list[Punctuality] = field(default_factory=list[Punctuality])


class RealTimeRig:
    """A live run as the real-time ticker drives it: shifted to begin at 0, ending after a while, every tick recorded.

    Implements both sides of ``run_real_time``: the ticked object and the simulated rig. ``period_s``: the longest time
    between two ticks.
    """

    def __init__(self, live: LiveRun, seconds: float, period_s: float) -> None:
        """Begin at the live run's present time."""
        self.live = live
        self.seconds = seconds
        self.period_s = period_s
        self.found = Punctuality()
        self.finished = False
        self._origin = live.now
        self._due = 0.0
        self._used = 0

    waiting = False

    @property
    def urgent_s(self) -> float:
        """Arrival time of urgent data, to be processed before the next scan."""
        return self.live.world.urgent_s - self._origin

    def advance(self, now: float) -> None:
        """Let the simulated rig live until ``now``."""
        self.live.world.advance(now + self._origin)

    def tick(self, now: float) -> float:
        """Tick, record the lateness, and return when the next tick is due."""
        live, origin, found = self.live, self._origin, self.found
        if not found.late_s:
            self._used = cpu_ns()
        due, self._due = self._due, 0.0
        late = now - due
        found.late_s.append(late)
        found.missed += late >= self.period_s
        wanted = live.run.tick(now + origin) - origin
        live.now = now + origin
        if now >= self.seconds or live.engine.control.state.trip is not None:
            self._end(now)
        # Counted from this tick: on a separate grid each period of the scans would take two ticks.
        following = min(wanted, max(due + self.period_s, now) + _TINY_S)
        self._due = min(following, self.urgent_s)
        return following

    def _end(self, now: float) -> None:
        self.finished = True
        self.found.seconds = now
        self.found.cpu_share = (cpu_ns() - self._used) * 1e-9 / now
        trip = self.live.engine.control.state.trip
        if trip is not None:
            self.found.tripped = trip.name


class Rigs:
    """Provides a sliding rig; replaces one that tripped."""

    def __init__(self) -> None:
        """No rig yet."""
        self._stack = ExitStack()
        self._live: LiveRun | None = None

    def sliding(self, seconds: float) -> LiveRun:
        """Return a rig whose wheel slides for another ``seconds``."""
        live = self._live
        if live is None or live.engine.control.state.trip is not None:
            self.close()
            live = self._live = self._stack.enter_context(live_run(SLIDING_RECIPE))
        live.slide(seconds)
        return live

    def close(self) -> None:
        """Release the rig."""
        self._stack.close()


def measure(effort: Effort) -> list[Figure]:
    """Return lateness, ratio, CPU share and missed ticks for both rates, alone and beside a busy core."""
    seconds = effort.pick(20.0, 3.0)
    figures: list[Figure] = []
    with closing(Rigs()) as rigs:
        for neighbour in ("idle", "one busy core"):
            with busy_core() if neighbour != "idle" else nullcontext():
                for rate in RATES:
                    columns = Columns()
                    for _ in range(effort.runs):
                        columns.bare.append(bare_loop(seconds, rate.period_s))
                        columns.rig.append(rig_loop(rigs.sliding(seconds + 5.0), seconds, rate.period_s))
                    figures += _figures(f"{rate.name}, {neighbour}", columns, rate)
    return figures


def bare_loop(seconds: float, period_s: float) -> Punctuality:
    """Only wait for absolute deadlines."""
    found = Punctuality()
    with collector_at_rest(), closing(RealTimePriority()):
        used = cpu_ns()
        origin = clock.monotonic()
        for number in range(round(seconds / period_s)):
            due = number * period_s
            clock.sleep_until(origin + due)
            late = clock.monotonic() - origin - due
            found.late_s.append(late)
            found.missed += late >= period_s
        found.cpu_share = (cpu_ns() - used) * 1e-9 / (clock.monotonic() - origin)
    return found


def rig_loop(live: LiveRun, seconds: float, period_s: float) -> Punctuality:
    """Let the real-time ticker drive a sliding rig."""
    rig = RealTimeRig(live, seconds, period_s)
    # Collect garbage here: the ticker's own collection would make the first tick late.
    with collector_at_rest(), closing(RealTimePriority()):
        run_real_time(rig, rig, poll=_no_poll, statistics=TickStatistics())
    if live.run.finished or not (live.sliding or rig.found.tripped):
        raise TopicFailedError(f"not sliding throughout: {live.run.outcome.value} {live.run.reason}")
    return rig.found


@contextmanager
def busy_core() -> Generator[None, None, None]:
    """Keep one core busy with a process of its own."""
    process = subprocess.Popen([sys.executable, "-c", SPIN])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def percentile(values: Sequence[float], share: float) -> float:
    """Return the smallest value that ``share`` of all values do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, ceil(share * len(ordered)) - 1)]


def _figures(name: str, columns: Columns, rate: Rate) -> list[Figure]:
    bare, rig = columns.bare, columns.rig
    p99_bare, p99_rig = [one.p99_us for one in bare], [one.p99_us for one in rig]
    latest_bare, latest_rig = [max(one.late_s) * 1e6 for one in bare], [max(one.late_s) * 1e6 for one in rig]
    shares = tuple(100.0 * one.cpu_share for one in rig)
    missed = float(sum(one.missed for one in rig))
    trips = [one.tripped for one in rig if one.tripped]
    return [
        Figure(f"{name}: bare loop, p99 late", "us", tuple(p99_bare)),
        Figure(f"{name}: rig, p99 late", "us", tuple(p99_rig)),
        ratio(f"{name}: rig / bare loop, p99 late", p99_rig, p99_bare, at_most(LATENESS_LIMIT)),
        Figure(f"{name}: bare loop, latest", "us", tuple(latest_bare)),
        Figure(f"{name}: rig, latest", "us", tuple(latest_rig)),
        Figure(f"{name}: CPU share", "% of a core", shares, at_most(rate.share_percent)),
        Figure(
            f"{name}: missed ticks",
            f"in {sum(one.seconds for one in rig):.0f} s",
            (missed,),
            at_most(0.0, worst=True) if rate.every_tick else None,
            f"the bare loop missed {sum(one.missed for one in bare)}",
        ),
        Figure(f"{name}: trips", "", (float(len(trips)),), at_most(0.0, worst=True), ", ".join(trips)),
    ]


def _no_poll(_: float) -> None:
    """Show nothing."""
