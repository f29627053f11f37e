"""One case of the campaign: a run, a fault at a moment of it, and the verdict."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from math import inf

from sim.faults import Injection
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultTime
from tests.campaigns.faults.recipes import language_of
from tests.campaigns.faults.stage import Stage
from tests.campaigns.faults.wheel_harm import SAFE_S

WATCHED_S = 6.0
"""A fault that does not end the run is watched this long, s of rig time, and 3 s longer than its budget; a slow one
SLOW_S."""
LATCHED_S = SAFE_S + 1.0
"""A stop that does not finish is watched this long."""
SLOW_S = 125.0
MISSED_S = 1.0
"""A fault that only the next connection can detect is watched this long in a run."""
SETTLED_S = 0.5
"""An end state counts as reached when it has lasted this long."""
ROUNDING_S = 0.011
"""Ticks are at most this far apart while something happens; rounding must not miss a budget."""
AFTER_S = 5.0
"""Every tenth end state is watched this much longer, acknowledged, and watched for the same time again."""
EVERY = 10
JUDGED = frozenset((Expected.TRIP, Expected.STOP, Expected.HOLD))
"""Events with a budget."""
HEARTBEAT_S = 0.25
"""A drive detects a missing heartbeat after 200 ms, and the last one left up to 50 ms before a kill."""


@dataclass(frozen=True, slots=True)
class Case:
    """A recipe, a tick of it, its place, and the faults that begin there, as in a script."""

    recipe: str
    tick: int
    place: str
    faults: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.recipe}, tick {self.tick} ({self.place}): {' + '.join(self.faults)}"


@dataclass(slots=True)
class Verdict:
    """The verdict on a case: failures (empty: safe and in time), what tripped, how long it took.

    ``missing``: what the safe state lacked at the end. ``exposed``: every fault with a budget could be noticed at some
    time; ``stayed``: the end state was watched for longer, and acknowledged.
    """

    case: Case
    failures: list[str] = field(default_factory=list[str])
    missing: list[str] = field(default_factory=list[str])
    tripped_by: str = ""
    ended_after_s: float = inf
    exposed: bool = True
    stayed: bool = False
    began_running: bool = False

    @property
    def only_force(self) -> bool:
        """The only failure is that the load stayed on: in time, no harm, no invariant broken, all else safe."""
        return len(self.failures) == 1 and [text.partition(" ")[0] for text in self.missing] == ["force"]


def fault_of(text: str, recipe: str = "") -> Injection:
    """Return a fault of a recipe's kind of machine from its phrase and magnitude. Raises FaultTextError."""
    return language_of(recipe).parse(f"t=0 s: {text}")


def connecting(kind: FaultKind) -> bool:
    """Return whether only the next connection can detect a fault."""
    return kind.exposure.name == "CONNECTING"


def _watched_s(stage: Stage, kinds: tuple[FaultKind, ...]) -> float:
    """Return how long an unending case is watched, s."""
    if any(kind.slow for kind in kinds):
        return SLOW_S
    if stage.run.engine.scans > 0 and all(map(connecting, kinds)):
        return MISSED_S
    return max(WATCHED_S, *(kind.budget_s + SAFE_S for kind in kinds))


class Judge:
    """Watches one stage under its faults, tick by tick."""

    def __init__(self, stage: Stage, case: Case, *, budgets: bool = True, watched_s: float | None = None) -> None:
        """Begin the faults at the stage's next tick; without ``budgets`` only safety is judged.

        ``watched_s``: how long a case without an end is watched, s of rig time; by default, what its faults need.
        """
        self.stage = stage
        self.budgets = budgets
        faults = [fault_of(text, case.recipe) for text in case.faults]
        self.kinds: tuple[FaultKind, ...] = tuple(fault.kind for fault in faults)
        self.verdict = Verdict(case)
        self.onset_s = stage.next_s
        self.ended_s = inf
        self.safe_since_s = inf
        self.committed = stage.ledger.committed
        self._exposures = [stage.exposed(kind) for kind in self.kinds]
        self._exposed_s = [inf] * len(self.kinds)
        self._unexposed = {i for i, kind in enumerate(self.kinds) if kind.reaction in JUDGED}
        self._was_running = stage.running
        self.verdict.began_running = stage.running
        self._after_s = inf
        self._acknowledged = False
        self._stays = zlib.crc32(str(case).encode()) % EVERY == 0
        if self._stays:
            stage.run.stays_latched = True
        stage.inject(*(Injection(FaultTime(at_s=self.onset_s), one.kind, one.value, text=text)
                       for one, text in zip(faults, case.faults, strict=True)))  # fmt: skip
        self.until_s = self.onset_s + (_watched_s(stage, self.kinds) if watched_s is None else watched_s)

    def run(self) -> Verdict:
        """Tick until the verdict is clear."""
        stage = self.stage
        while not self._done(stage.tick()):
            pass
        verdict = self.verdict
        verdict.exposed = not self._unexposed
        verdict.failures += [f"harm: {name}, {text}" for name, text in stage.observer.found.items()]
        verdict.failures += [f"invariant {name}: {text}" for name, text in stage.invariants.broken.items()]
        if stage.trip:
            verdict.tripped_by = stage.trip
            if not stage.ledger.trips:
                verdict.failures.append("a trip is not in the journal")
        return verdict

    def _done(self, now: float) -> bool:
        """Look at one tick; return whether everything is clear."""
        stage = self.stage
        if stage.faulty.killed and self.ended_s == inf:
            self.ended_s = now
        elif self.ended_s == inf and stage.ended:
            self._end(now)
        if self.ended_s == inf:
            late = self._late(now) if self.budgets else ""
            if late:
                self.verdict.failures.append(late)
                return True
            return now >= self.until_s
        if self._after_s < inf:
            return self._after(now)
        if not self._safe(now):
            return False
        if not self._stays or self.verdict.failures:
            return True
        self._after_s = now
        return False

    def _end(self, now: float) -> None:
        self.ended_s = now
        self.verdict.ended_after_s = now - self.onset_s
        self.committed = self.stage.ledger.committed
        normal = self.stage.run.engine.executor.finished
        if not normal:
            self._unexposed.clear()  # detected: nothing else ends a run
        rides = [kind.phrase for kind in self.kinds if kind.reaction is Expected.RIDE]
        if self.budgets and len(rides) == len(self.kinds) and not normal and self._was_running:
            self.verdict.failures.append(f"ended by a fault it should ride through{self._why()}")

    def _late(self, now: float) -> str:
        """Return which budget is missed, or ""."""
        for i, kind in enumerate(self.kinds):
            if kind.reaction not in JUDGED:
                continue
            if now > self.onset_s + kind.lasts_s or not self._exposures[i].now():
                self._exposed_s[i] = inf
                continue
            self._unexposed.discard(i)
            if kind.reaction is Expected.HOLD and (self.stage.mode == "hold" or not self._was_running):
                continue  # a rig that is not up refuses to hold
            self._exposed_s[i] = min(self._exposed_s[i], now)
            if now - max(self._exposed_s[i], self.onset_s) > kind.budget_s + ROUNDING_S:
                return f"missed budget of {kind.budget_s:.2f} s: {kind.phrase}"
        return ""

    def _safe(self, now: float) -> bool:
        """Check that the end state is reached in time and lasts."""
        stage = self.stage
        missing = self._missing()
        if stage.ledger.committed > self.committed and stage.ledger.trips:
            self.verdict.failures.append("a repeat was committed after the trip")
            return True
        if not missing:
            self.safe_since_s = min(self.safe_since_s, now)
            return now - self.safe_since_s >= SETTLED_S and self._at_rest(now)
        self.safe_since_s = inf
        allowed_s = SAFE_S + (HEARTBEAT_S if stage.faulty.killed else 0.0)
        if now - self.ended_s > allowed_s:
            self.verdict.missing = missing
            text = f"not safe {allowed_s:g} s after the end: {', '.join(missing)}{self._why()}"
            self.verdict.failures.append(text)
            return True
        return False

    def _after(self, now: float) -> bool:
        """Check that an end state lasts, and that acknowledging it has no effect."""
        missing = self._missing()
        if missing and self._stops_anew(now):
            return False  # something else trips the creeping wheel now
        if missing:
            when = "acknowledged" if self._acknowledged else "at rest"
            self.verdict.failures.append(f"safe no more, {when}: {', '.join(missing)}{self._why()}")
            return True
        if now < self._after_s + AFTER_S:
            return False
        if self._acknowledged:
            self.verdict.stayed = True
            return True
        self._after_s, self._acknowledged = now, True
        self.stage.run.request_ack()
        return False

    def _stops_anew(self, now: float) -> bool:
        """Return whether another stop has begun and still has time."""
        return self.stage.mode in ("stopping", "fast stop") and now - self.stage.mode_since_s <= SAFE_S

    def _missing(self) -> list[str]:
        return self.stage.missing(self.kinds)

    def _at_rest(self, now: float) -> bool:
        """Return whether control has finished stopping, or has used up its time."""
        stage = self.stage
        settled = stage.run.finished or stage.faulty.killed or stage.mode in ("latched", "idle", "cooldown")
        return settled or now - self.ended_s > LATCHED_S

    def _why(self) -> str:
        trip = self.stage.trip
        return f" (tripped by {trip})" if trip else f" ({self.stage.mode})"
