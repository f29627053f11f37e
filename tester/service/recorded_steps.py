"""A stored run's steps, from its journal: each with its times, including the way to standstill."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil

from tester.machine.time_left import STANDSTILL
from tester.service.protocol import Event
from tester.service.state_view import PlanStep, PlanView, StepState
from tester.store.records import StoredCondition

_STOPS = re.compile(r"(run|hold) -> (?!run\b|hold\b)")
"""Pattern of the event text for a change of mode that ends a run, or a part of it."""


@dataclass(frozen=True, slots=True)
class RecordedStep:
    """A step with its times, rig seconds of the run."""

    kind: str
    title: str
    began_s: float
    ended_s: float
    condition: int = 0
    """Number of the condition that it measures, 0 for another step."""

    @property
    def took_s(self) -> float:
        """Return the step's duration, whole s."""
        return float(round(self.ended_s - self.began_s))


def recorded_steps(
    events: Iterable[Event], length_s: float, conditions: Sequence[StoredCondition] = ()
) -> tuple[RecordedStep, ...]:
    """Return the steps of a journal in order; ``length_s``: rig seconds of the run; ``conditions``: of its record.

    A run whose parts ran side by side has no journal, and therefore no steps.
    """
    begun: list[tuple[str, str, float]] = []
    for event in events:
        if event.kind == "step":
            begun.append(("step", event.text, event.t_s))
        elif event.kind == "mode" and _STOPS.match(event.text) and begun and begun[-1][0] != STANDSTILL:
            begun.append((STANDSTILL, "to standstill", event.t_s))
    ends = [*(began_s for _, _, began_s in begun), length_s][1:]  # none if no step began
    return tuple(
        RecordedStep(kind, title, began_s, max(ended_s, began_s), _measured(conditions, began_s, ended_s))
        for (kind, title, began_s), ended_s in zip(begun, ends, strict=True)
    )


def _measured(conditions: Sequence[StoredCondition], began_s: float, ended_s: float) -> int:
    """Return the condition that began during a step, 0 if none did."""
    return next((one.info.condition for one in conditions if began_s <= one.started_s < ended_s), 0)


def present_of(steps: Sequence[RecordedStep], at_s: float) -> int:
    """Return how many steps have begun at a moment, which is the number of the present step."""
    return sum(step.began_s <= at_s for step in steps)


def left_of(steps: Sequence[RecordedStep], at_s: float) -> tuple[float, float]:
    """Return the rig seconds left at a moment, whole s: of the run (the sum over the list of steps), and of the present
    step.
    """
    here = present_of(steps, at_s)
    present_s = float(ceil(max(steps[here - 1].ended_s - at_s, 0.0))) if here else 0.0
    return present_s + sum(step.took_s for step in steps[here:]), present_s


def plan_of(name: str, steps: Sequence[RecordedStep], at_s: float) -> PlanView:
    """Return the list of steps as it was at a moment."""
    here = present_of(steps, at_s)
    listed = tuple(
        PlanStep(
            number, step.kind, step.title, _state(number, here, step, at_s), step.took_s,
            step.took_s if step.ended_s <= at_s else None, step.took_s, step.condition,
        )
        for number, step in enumerate(steps, 1)
    )  # fmt: skip
    return PlanView(name, len(steps), 1, listed, sum(step.took_s for step in steps))


def _state(number: int, here: int, step: RecordedStep, at_s: float) -> StepState:
    if step.ended_s <= at_s:
        return "done"
    return "now" if number == here else "later"
