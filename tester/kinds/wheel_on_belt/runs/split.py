"""A plan as parts that do not depend on each other (docs/decisions/0015).

On a simulated rig every specimen, and every replicate of it, is a part with a rig of its own that starts at time 0 and
at ambient temperature. A plan with references is one part: they watch one belt from its first wheel to its last.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tester.inputs.recipe.plan import ConditionStep, Plan, Step
from tester.kinds.wheel_on_belt.recipe.steps import Cool, Install, WheelPlan
from tester.machine.run_parts import Part


def split(plan: Plan) -> tuple[Part, ...]:
    """Return the parts of a plan in its order; at least one."""
    starts = _starts(plan.steps)
    last_wheel = max((step.wheel for step in plan.steps if isinstance(step, Install)), default=0)
    if len(starts) == 1 or WheelPlan.of(plan).references:
        return (Part(1, plan, last_wheel),)
    parts: list[Part] = []
    for number, (begin, end) in enumerate(zip(starts, [*starts[1:], len(plan.steps)], strict=True), start=1):
        steps = plan.steps[begin:end]
        if isinstance(steps[0], Cool):
            steps = steps[1:]  # a rig of its own has nothing to cool
        wheels = {step.wheel for step in steps if isinstance(step, Install)}
        parts.append(Part(number, _part_of(plan, steps, wheels), last_wheel))
        # Every unforeseen wheel measures at least one condition, so two parts never give the same number.
        last_wheel += sum(1 for step in steps if isinstance(step, ConditionStep))
    return tuple(parts)


def _part_of(plan: Plan, steps: tuple[Step, ...], wheels: set[int]) -> Plan:
    """Return the plan of some of the steps, with the wear of their wheels."""
    own = WheelPlan.of(plan)
    return replace(own, steps=steps, wear=tuple(one for one in own.wear if one.wheel in wheels))


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
