"""A run's steps with estimated and measured durations, for clients."""

from __future__ import annotations

from collections.abc import Sequence

from tester.base.axes import ListWords
from tester.inputs.recipe.plan import ConditionStep, Step
from tester.machine.served import ServedKind
from tester.machine.time_left import STANDSTILL, Earlier, PartTime, TimeLeft
from tester.service.state import PlanStep, PlanView, StepState

LISTED = 400
"""Most steps in a plan message, around the present one: a plan may have 100,000."""
BEFORE = 100
"""Most of them before the present one."""


class PlanTrack(TimeLeft):
    """A run's steps beside the clock, for display. Times are rig seconds."""

    def __init__(self, name: str, parts: Sequence[PartTime], kind: ServedKind, earlier: Earlier | None = None) -> None:
        """Begin before the first step.

        ``name``: the plan's; ``kind``: the rig's, which has the words for a step.
        """
        super().__init__(parts, earlier)
        self.name = name
        self.kind = kind
        self._words = ListWords(step.setpoint for step in self.steps if isinstance(step, ConditionStep))

    def view(self) -> PlanView:
        """Return the steps around the present one."""
        first = max(min(self.position - BEFORE, len(self.steps) - LISTED), 0)
        behind = min(first + LISTED, len(self.steps))
        listed = tuple(
            PlanStep(
                i + 1, STANDSTILL if step is None else step.kind, self._title(step), self._state(i), self.estimated[i],
                self.measured.get(i), float(self.ahead[i]),
            )
            for i, step in enumerate(self.steps[first:behind], first)
        )  # fmt: skip
        beyond_s = float(self.ahead[behind:].sum())
        return PlanView(self.name, len(self.steps), first + 1, listed, sum(self.estimated), beyond_s)

    def _title(self, step: Step | None) -> str:
        if step is None:
            return "to standstill"
        return self._words.of(step.setpoint) if isinstance(step, ConditionStep) else self.kind.title(step)

    def _state(self, index: int) -> StepState:
        return "done" if index < self.position else "now" if index == self.position else "later"
