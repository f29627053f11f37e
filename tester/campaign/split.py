"""A plan as parts that do not depend on each other (docs/decisions/0015).

On a simulated rig every specimen, and every replicate of it, is a part with a rig of its own that starts at time 0 and
at ambient temperature. A real rig has one part: the whole plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tester.recipe.plan import ConditionStep, Cool, Install, Plan, Step


@dataclass(frozen=True, slots=True)
class Part:
    """One part: ``number`` counts from 1; the plan is the whole one's with this part's steps only.

    Steps, conditions, rows, specimens and wheels keep their numbers. ``last_wheel`` is the highest wheel number that is
    taken before this part changes a wheel that the plan did not foresee.
    """

    number: int
    plan: Plan
    last_wheel: int


def split(plan: Plan, *, simulated: bool) -> tuple[Part, ...]:
    """Return the parts of a plan in its order; at least one."""
    starts = _starts(plan.steps) if simulated else [0]
    last_wheel = max((step.wheel for step in plan.steps if isinstance(step, Install)), default=0)
    if len(starts) == 1:
        return (Part(1, plan, last_wheel),)
    parts: list[Part] = []
    for number, (begin, end) in enumerate(zip(starts, [*starts[1:], len(plan.steps)], strict=True), start=1):
        steps = plan.steps[begin:end]
        if isinstance(steps[0], Cool):
            steps = steps[1:]  # a rig of its own has nothing to cool
        wheels = {step.wheel for step in steps if isinstance(step, Install)}
        wear = tuple(one for one in plan.wear if one.wheel in wheels)
        parts.append(Part(number, replace(plan, steps=steps, wear=wear), last_wheel))
        # Every unforeseen wheel measures at least one condition, so two parts never give the same number.
        last_wheel += sum(1 for step in steps if isinstance(step, ConditionStep))
    return tuple(parts)


def _starts(steps: Sequence[Step]) -> list[int]:
    """Return the positions of the steps with which a specimen or a replicate begins; the first is 0."""
    starts = [0]
    before: tuple[int, int] | None = None
    for position, step in enumerate(steps):
        if not isinstance(step, Install):
            continue
        place = (step.specimen, step.replicate)
        if before is not None and place != before:
            starts.append(position - 1 if isinstance(steps[position - 1], Cool) else position)
        before = place
    return starts
