"""How far a run is: the plan's steps with estimated and measured durations, and what is left of the rig time."""

from __future__ import annotations

from collections.abc import Sequence

from tester.axes import ListWords
from tester.engine.context import Progress
from tester.engine.executor import title
from tester.recipe.estimate import Estimate
from tester.recipe.plan import ConditionStep, Plan, Step
from tester.service.state import PlanStep, PlanView, StepState

LISTED = 400
"""Steps that a plan message lists at most, around the present one: a plan may have 100,000."""
BEFORE = 100
"""... of which this many lie before the present one."""
PACE_LEAST_S = 600.0
"""Measured durations correct the estimate once this much of it is done, s [A]."""


class PlanTrack:
    """The plan beside the clock. Times are rig seconds."""

    def __init__(self, plan: Plan, estimate: Estimate) -> None:
        """Begin before the first step."""
        self.plan = plan
        self.estimated = [one.seconds for one in estimate.steps]
        self._words = ListWords(step.setpoint for step in plan.conditions())
        self.total_s = max(estimate.rig_seconds, 1.0)
        self._ahead_s = [0.0] * (len(self.estimated) + 1)
        for i in range(len(self.estimated) - 1, -1, -1):
            self._ahead_s[i] = self._ahead_s[i + 1] + self.estimated[i]
        self._after_s = max(self.total_s - self._ahead_s[0], 0.0)
        self._places = {id(step): place for place, step in enumerate(plan.steps)}
        self._part_ends = len(plan.steps)
        self._earlier_s = 0.0
        """Rig time of the parts before this one: each starts at 0."""
        self._now = 0.0
        self._measured: dict[int, float] = {}
        self._step = 0
        self._open = False
        """The step at ``position`` is under way."""
        self._began_s = 0.0
        self._done_s = 0.0
        self._done_estimated_s = 0.0
        self.position = -1
        """Index of the present step in the plan; a wheel change that was not planned belongs to the step after it."""

    def begin_part(self, plan: Plan) -> None:
        """Begin a part of the plan, on a rig of its own whose time starts at 0."""
        self._finish(self._now)
        self._earlier_s += self._now
        self._now = self._began_s = 0.0
        self._step = 0
        self._part_ends = self._places[id(plan.steps[-1])] + 1 if plan.steps else 0

    def update(self, now: float, progress: Progress, remaining: Sequence[Step]) -> bool:
        """Take in where the executor is; return whether a step has begun. ``remaining``: its steps to come."""
        self._now = now
        if progress.step == self._step:
            return False
        self._step = progress.step
        inserted = 0
        for step in remaining:
            if id(step) in self._places:
                break
            inserted += 1
        position = self._part_ends - (len(remaining) - inserted) - 1
        if inserted:
            position += 1  # the step that waits behind the inserted ones
        if position != self.position:
            self._finish(now)
            self.position, self._open = position, True
        return True

    def _finish(self, now: float) -> None:
        if self._open and 0 <= self.position < len(self.estimated):
            seconds = now - self._began_s
            self._measured[self.position] = seconds
            self._done_s += seconds
            self._done_estimated_s += self.estimated[self.position]
        self._began_s, self._open = now, False

    def left_s(self, now: float) -> float:
        """Return the rig seconds still to go, by the estimate and how good it has been so far."""
        if self.position < 0:
            return self.total_s
        here = min(self.position, len(self.estimated) - 1)
        present = max(self.estimated[here] - (now - self._began_s), 0.0) if self._open else 0.0
        ahead = present + self._ahead_s[here + 1]
        pace = 1.0
        if self._done_estimated_s >= PACE_LEAST_S:
            pace = self._done_s / self._done_estimated_s
        return ahead * pace + self._after_s

    def share(self, now: float) -> float:
        """Return the share of the run that is done, 0..1."""
        left, done = self.left_s(now), self._earlier_s + now
        return done / (done + left) if done + left > 0.0 else 0.0

    def view(self) -> PlanView:
        """Return the steps around the present one."""
        steps = self.plan.steps
        first = max(min(self.position - BEFORE, len(steps) - LISTED), 0)
        listed = tuple(
            PlanStep(i + 1, one.kind, self._title(one), self._state(i), self.estimated[i], self._measured.get(i))
            for i, one in enumerate(steps[first : first + LISTED], first)
        )
        return PlanView(self.plan.name, len(steps), first + 1, listed, self.total_s)

    def _title(self, step: Step) -> str:
        return self._words.of(step.setpoint) if isinstance(step, ConditionStep) else title(step)

    def _state(self, index: int) -> StepState:
        return "done" if index < self.position else "now" if index == self.position else "later"
