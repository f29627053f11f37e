"""How far a run is, as clients are told: the plan's steps with estimated and measured durations."""

from __future__ import annotations

from tester.axes import ListWords
from tester.machine.served import ServedKind
from tester.machine.time_left import TimeLeft
from tester.recipe.estimate import Estimate
from tester.recipe.plan import ConditionStep, Plan, Step
from tester.service.state import PlanStep, PlanView, StepState

LISTED = 400
"""Steps that a plan message lists at most, around the present one: a plan may have 100,000."""
BEFORE = 100
"""... of which this many lie before the present one."""


class PlanTrack(TimeLeft):
    """The plan beside the clock, to be shown. Times are rig seconds."""

    def __init__(self, plan: Plan, estimate: Estimate, kind: ServedKind) -> None:
        """Begin before the first step. ``kind``: the rig's, which has the words for a step."""
        super().__init__(plan, estimate)
        self.plan = plan
        self.kind = kind
        self._words = ListWords(step.setpoint for step in plan.conditions())

    def view(self) -> PlanView:
        """Return the steps around the present one."""
        steps = self.plan.steps
        first = max(min(self.position - BEFORE, len(steps) - LISTED), 0)
        listed = tuple(
            PlanStep(i + 1, one.kind, self._title(one), self._state(i), self.estimated[i], self.measured.get(i))
            for i, one in enumerate(steps[first : first + LISTED], first)
        )
        return PlanView(self.plan.name, len(steps), first + 1, listed, self.total_s)

    def _title(self, step: Step) -> str:
        return self._words.of(step.setpoint) if isinstance(step, ConditionStep) else self.kind.title(step)

    def _state(self, index: int) -> StepState:
        return "done" if index < self.position else "now" if index == self.position else "later"
