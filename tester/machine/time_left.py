"""How far a run is and how long it still takes, from the plan's estimate and what has passed.

Only work counts. While the rig is held, or a person is waited for, neither the share nor the time left moves; once the
run has been given up (a trip, a stop, a failure) nothing of the plan is left to be done, and there is no time left to
tell. Each kind of step has a pace of its own: rests that last what they are told say nothing of conditions that take
twice what was estimated. Times in s of rig time.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Final

from tester.machine.context import Progress
from tester.machine.run import Outcome, Run
from tester.machine.state import Mode
from tester.recipe.estimate import Estimate
from tester.recipe.plan import Plan, Step

PRIOR_S: Final = 300.0
"""The estimate of a kind of step counts as much as this long a measurement of it, s [A]."""
OVERRUN: Final = 0.1
"""A step that takes longer than expected is expected to take this much longer still, share of its time so far [A]."""
SHOWN: Final = 0.3
"""A condition's repeats tell its duration once this share of one repeat is done [A]."""
SHOWN_S: Final = 30.0
"""... and not before this long a time of contacts, s [A]."""


class Doing(Enum):
    """What a run does with its time."""

    WORKING = "working"
    WAITING = "waiting"
    """Held, or a person is asked."""
    GIVEN_UP = "given up"


def doing(run: Run) -> Doing:
    """Return what a run does with its time."""
    executor, state = run.engine.executor, run.engine.control.state
    if run.outcome not in (Outcome.RUNNING, Outcome.DONE) or executor.failed:
        return Doing.GIVEN_UP
    if not run.connected or executor.finished:
        return Doing.WORKING
    if run.waiting or state.mode is Mode.HOLD:
        return Doing.WAITING
    return Doing.WORKING if state.mode in (Mode.ARMED, Mode.RUN) else Doing.GIVEN_UP


def share_of_repeats(progress: Progress) -> float:
    """Return the share of the present condition's repeats that is done, 0..1: by number, and by revolutions."""
    if progress.repeats <= 0:
        return 0.0
    wanted = progress.revolutions_wanted
    within = min(progress.revolutions / wanted, 1.0) if wanted > 0.0 and progress.burst else 0.0
    return min((max(progress.repeat - 1, 0) + within) / progress.repeats, 1.0)


class TimeLeft:
    """The plan's estimate beside the clock."""

    def __init__(self, plan: Plan, estimate: Estimate) -> None:
        """Begin before the first step."""
        self.estimated = [one.seconds for one in estimate.steps]
        self.total_s = max(estimate.rig_seconds, 1.0)
        self.position = -1
        """Index of the present step in the plan; a wheel change that was not planned belongs to the step after it."""
        self.measured: dict[int, float] = {}
        """What each step took that is over, s of work."""
        self._kinds = [step.kind for step in plan.steps]
        self._ahead: dict[str, float] = {}
        """Estimates of the steps behind the present one, by kind, s."""
        for kind, seconds in zip(self._kinds, self.estimated, strict=True):
            self._ahead[kind] = self._ahead.get(kind, 0.0) + seconds
        self._after_s = max(self.total_s - sum(self._ahead.values()), 0.0)
        self._took: dict[str, tuple[float, float]] = {}
        """What the steps that are over took, and what they were estimated at, by kind, s."""
        self._places = {id(step): place for place, step in enumerate(plan.steps)}
        self._part_ends = len(plan.steps)
        self._step = 0
        self._open = False
        """The step at ``position`` is under way."""
        self._doing = Doing.WORKING
        self._now = 0.0
        self._worked_s = 0.0
        """Work in all parts until ``_now``."""
        self._began_s = 0.0
        """Work when the present step began."""
        self._first: tuple[float, float] | None = None
        """Work, and share of the condition's repeats, when the present condition began to be measured."""
        self._repeats, self._enough = 0.0, 1.0
        """Share of the present condition's repeats that is done, and that has to be to tell its duration."""

    def begin_part(self, plan: Plan) -> None:
        """Begin a part of the plan, on a rig of its own whose time starts at 0."""
        self._finish()
        self._now, self._step, self._doing = 0.0, 0, Doing.WORKING
        self._part_ends = self._places[id(plan.steps[-1])] + 1 if plan.steps else 0

    def look(self, now: float, run: Run) -> bool:
        """Take in where a run is at a rig time; return whether a step has begun."""
        executor = run.engine.executor
        return self.update(now, run.engine.ctx.progress, executor.steps, doing(run), measuring=executor.measuring)

    def update(
        self, now: float, progress: Progress, remaining: Sequence[Step], state: Doing, *, measuring: bool
    ) -> bool:
        """Take in where the executor is; return whether a step has begun. ``remaining``: its steps to come."""
        if state is Doing.WORKING:
            self._worked_s += now - self._now
        self._now, self._doing = now, state
        begun = progress.step != self._step
        if begun:
            self._step = progress.step
            self._move_to(self._position(remaining))
        if measuring:
            self._repeats, self._enough = share_of_repeats(progress), SHOWN / max(progress.repeats, 1)
            if self._first is None and progress.burst:  # before the first contact it may wait long for its temperature
                self._first = self._worked_s, max(progress.repeat - 1, 0) / max(progress.repeats, 1)
        return begun

    def _position(self, remaining: Sequence[Step]) -> int:
        inserted = 0
        for step in remaining:
            if id(step) in self._places:
                break
            inserted += 1
        # With steps inserted, the one that waits behind them is the present one.
        return self._part_ends - (len(remaining) - inserted) - (0 if inserted else 1)

    def _move_to(self, position: int) -> None:
        if position == self.position:
            return
        self._finish()
        for place in range(self.position + 1, min(position + 1, len(self.estimated))):
            self._ahead[self._kinds[place]] -= self.estimated[place]
            if place < position:  # came and went between two looks: its time is told with the step before it
                self.measured[place] = 0.0
        self.position, self._open = position, True

    def _finish(self) -> None:
        """Take what the present step took as a measurement of its kind."""
        if self._open and 0 <= self.position < len(self.estimated):
            took_s = self._worked_s - self._began_s
            self.measured[self.position] = took_s
            kind = self._kinds[self.position]
            before_s, estimated_s = self._took.get(kind, (0.0, 0.0))
            self._took[kind] = before_s + took_s, estimated_s + self.estimated[self.position]
        self._began_s, self._open = self._worked_s, False
        self._first = None

    def left_s(self) -> float | None:
        """Return the rig seconds still to go; None once the run was given up: nobody will do what is left."""
        if self._doing is Doing.GIVEN_UP:
            return None
        here = self._kinds[self.position] if self._open and 0 <= self.position < len(self._kinds) else ""
        present_s = self._present_s(here) if here else 0.0
        so_far_s = self._worked_s - self._began_s + present_s
        left_s = present_s + self._after_s
        for kind, ahead_s in self._ahead.items():
            took_s, estimated_s = self._took.get(kind, (0.0, 0.0))
            if kind == here:
                took_s, estimated_s = took_s + so_far_s, estimated_s + self.estimated[self.position]
            left_s += max(ahead_s, 0.0) * (took_s + PRIOR_S) / (estimated_s + PRIOR_S)
        return left_s

    def _present_s(self, kind: str) -> float:
        """Return what is left of the present step: by its repeats where they tell, else by its estimate."""
        so_far_s = self._worked_s - self._began_s
        if self._first is not None:
            since_s, done = self._worked_s - self._first[0], self._repeats - self._first[1]
            if done >= self._enough and since_s >= SHOWN_S:
                return since_s * (1.0 - self._repeats) / done
        took_s, estimated_s = self._took.get(kind, (0.0, 0.0))
        expected_s = self.estimated[self.position] * (took_s + PRIOR_S) / (estimated_s + PRIOR_S)
        return max(expected_s - so_far_s, OVERRUN * so_far_s)

    def share(self) -> float:
        """Return the share of the run that is done, 0..1; where it was given up, what was done by then."""
        state, self._doing = self._doing, Doing.WORKING
        left_s = self.left_s() or 0.0
        self._doing = state
        done_s = self._worked_s
        return done_s / (done_s + left_s) if done_s + left_s > 0.0 else 0.0
