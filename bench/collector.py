"""Garbage collection while a run is ticked: pauses, and uncollected objects."""

from __future__ import annotations

import gc

from bench.effort import Effort
from bench.figures import Figure, at_most
from bench.live import SLIDING_RECIPE, LiveRun, live_run
from bench.stopwatch import wall_ns
from recipes import find
from tester.machine.tickers import run_simulated

PAUSE_LIMIT_MS = 1.0


class Pauses:
    """Records every collection between the first and the last tick of a run, in ms."""

    def __init__(self) -> None:
        """Record nothing before ``on`` is set."""
        self.on = False
        self.ms: list[float] = []
        self._begun = 0

    def __call__(self, phase: str, info: dict[str, int]) -> None:
        """Callback of the collector (``gc.callbacks``)."""
        if phase == "start":
            self._begun = wall_ns()
        elif self.on:
            self.ms.append((wall_ns() - self._begun) * 1e-6)


class WatchedRun:
    """A run as the ticker drives it, up to ``seconds`` of rig time."""

    waiting = False

    def __init__(self, live: LiveRun, pauses: Pauses, seconds: float) -> None:
        """Begin with a run that is not ticked yet."""
        self.live, self.pauses, self.seconds = live, pauses, seconds
        self.finished = False
        self.objects = 0

    def tick(self, now: float) -> float:
        """Tick; from the first one on, pauses count."""
        if not self.pauses.on:
            self.pauses.on = True
            self.objects = len(gc.get_objects())
        due = self.live.run.tick(now)
        if self.live.run.finished or now >= self.seconds:
            self.finished = True
            self.pauses.on = False
            self.objects = len(gc.get_objects()) - self.objects
        return due


def measure(effort: Effort) -> list[Figure]:
    """Return the worst pause of a run in simulated time, how many there were, and how many objects pile up."""
    worst: list[float] = []
    counts: list[float] = []
    grown: list[float] = []
    text, seconds = _work(effort)
    for _ in range(effort.runs):
        pauses = Pauses()
        with live_run(text) as live:
            watched = WatchedRun(live, pauses, seconds)
            gc.callbacks.append(pauses)
            try:
                taken = run_simulated(watched, live.world, lapse=None, poll=_no_poll)
            finally:
                gc.callbacks.remove(pauses)
        worst.append(max(pauses.ms, default=0.0))
        counts.append(float(len(pauses.ms)))
        grown.append(watched.objects / (taken / 3600.0))
    return [
        Figure("worst pause", "ms", tuple(worst), at_most(PAUSE_LIMIT_MS, worst=True)),
        Figure("collections during a run", "", tuple(counts)),
        Figure("objects left to the collector", "per rig hour", tuple(grown), note="with automatic runs off"),
    ]


def _work(effort: Effort) -> tuple[str, float]:
    """Return a recipe and its duration, rig s."""
    if effort.quick:
        return SLIDING_RECIPE, 300.0
    return find("quickstart").read_text(encoding="utf-8"), 1e9


def _no_poll(_: float) -> None:
    """Show nothing."""
