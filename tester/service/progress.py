"""How far a run is, as clients are told: the plan's steps with estimated and measured durations."""

from __future__ import annotations

from tester.engine.executor import title
from tester.engine.time_left import TimeLeft
from tester.recipe.estimate import Estimate
from tester.recipe.plan import Plan
from tester.service.state import PlanStep, PlanView, StepState

LISTED = 400
"""Steps that a plan message lists at most, around the present one: a plan may have 100,000."""
BEFORE = 100
"""... of which this many lie before the present one."""


class PlanTrack(TimeLeft):
    """The plan beside the clock, to be shown. Times are rig seconds."""

    def __init__(self, plan: Plan, estimate: Estimate) -> None:
        """Begin before the first step."""
        super().__init__(plan, estimate)
        self.plan = plan

    def view(self) -> PlanView:
        """Return the steps around the present one."""
        steps = self.plan.steps
        first = max(min(self.position - BEFORE, len(steps) - LISTED), 0)
        listed = tuple(
            PlanStep(i + 1, steps[i].kind, title(steps[i]), self._state(i), self.estimated[i], self.measured.get(i))
            for i in range(first, min(first + LISTED, len(steps)))
        )
        return PlanView(self.plan.name, len(steps), first + 1, listed, self.total_s)

    def _state(self, index: int) -> StepState:
        return "done" if index < self.position else "now" if index == self.position else "later"
