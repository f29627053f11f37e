"""Anything may happen in any order: faults that come and go, commands of the operator, time."""

from __future__ import annotations

from functools import cache

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from sim.faults import Injection
from sim.faults.kinds import Expected
from sim.faults.language import FaultTime
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.stage import RUNNING, Stage
from tests.campaigns.faults.wheel_harm import SAFE_S, Truth

SHORT_RUN, LONG_RUN = (14, 12), (400, 20)
"""(examples, steps each) of the default run and of the campaign."""
NAMES = tuple(
    name for name, kind in CATALOGUE.items()
    if not kind.slow and not kind.force_stays and kind.reaction in (Expected.TRIP, Expected.RIDE, Expected.MAY)
)  # fmt: skip


@cache
def beginnings() -> tuple[Stage, ...]:
    """Return stages of the short recipe, one in the middle of each step."""
    moments = [moment for moment in rehearse("short")[0] if moment.phase == "middle"]
    found: list[Stage] = []

    def keep(moment: Moment, twins: Twins) -> None:
        stage = twins.copy()
        if stage.copyable:
            stage.run.stays_latched = True
            found.append(stage)

    visit("short", moments, keep)
    return tuple(found)


class AnythingHappens(RuleBasedStateMachine):
    """A run from the middle of some step on. Single faults: another one only when the last has gone."""

    stage: Stage

    @initialize(place=st.integers(0, 1000))
    def begin(self, place: int) -> None:
        """Take over a run."""
        stages = beginnings()
        self.stage = stages[place % len(stages)].copy()
        self.stopped_s = float("inf")
        self.faulty_until_s = 0.0

    @rule(seconds=st.sampled_from((0.02, 0.1, 0.5, 2.0)))
    def wait(self, seconds: float) -> None:
        """Let time pass."""
        stage = self.stage
        until = stage.next_s + seconds
        while stage.next_s < until:
            self._watch(stage.tick())

    @rule(name=st.sampled_from(NAMES), lasts_s=st.sampled_from((0.05, 0.3, 1.5)))
    def fail(self, name: str, lasts_s: float) -> None:
        """Let something fail for a while."""
        now = self.stage.next_s
        if now < self.faulty_until_s:
            return
        self.faulty_until_s = now + lasts_s
        self.stage.inject(Injection(FaultTime(at_s=now), CATALOGUE[name], lasts_s=lasts_s))

    @rule()
    def hold(self) -> None:
        """Hold."""
        self.stage.run.request_hold()

    @rule()
    def release(self) -> None:
        """Release."""
        self.stage.run.request_release()

    @rule(fast=st.booleans())
    def stop(self, fast: bool) -> None:
        """Stop, possibly repeatedly (I7)."""
        self.stage.run.request_stop("stateful", fast=fast)

    @rule()
    def acknowledge(self) -> None:
        """Acknowledge."""
        self.stage.run.request_ack()

    @rule(name=st.sampled_from(("safety chain opened", "belt drive fault", "press drive in local mode")))
    def acknowledge_too_early(self, name: str) -> None:
        """Acknowledge while the cause is still there: this must have no effect (I6)."""
        stage = self.stage
        now = stage.next_s
        if now < self.faulty_until_s or not stage.running:
            return
        self.faulty_until_s = now + 6.0
        stage.inject(Injection(FaultTime(at_s=now), CATALOGUE[name], lasts_s=6.0))
        while stage.next_s < now + 5.0 and stage.mode != "latched":
            self._watch(stage.tick())
        latched = stage.mode == "latched"
        stage.run.request_ack()
        until = stage.next_s + 0.8
        while stage.next_s < until:
            self._watch(stage.tick())
        assert not latched or stage.mode == "latched"

    @invariant()
    def nothing_is_broken(self) -> None:
        """I1, I2, I3, I6, I9, I10 hold in every scan, and the plant shows no harm."""
        if hasattr(self, "stage"):
            assert not self.stage.invariants.broken
            assert not self.stage.observer.found

    def _watch(self, now: float) -> None:
        """Check that every end of a run is safe in time (I5)."""
        stage = self.stage
        if stage.mode in RUNNING or not stage.run.engine.scans:
            self.stopped_s = float("inf")
            return
        self.stopped_s = min(self.stopped_s, now)
        if now - self.stopped_s > SAFE_S and now > self.faulty_until_s + SAFE_S:
            assert not Truth.of(stage.rig).unsafe(creeping=stage.mode == "cooldown")


AnythingHappens.TestCase.settings = settings(
    max_examples=SHORT_RUN[0], stateful_step_count=SHORT_RUN[1], deadline=None, derandomize=True,
    suppress_health_check=tuple(HealthCheck), database=None,
)  # fmt: skip
TestAnythingHappens = AnythingHappens.TestCase
