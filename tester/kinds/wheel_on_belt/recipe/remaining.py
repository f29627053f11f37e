"""The remaining plan after an interruption.

It begins at the first condition that is not over. The wheel on the rig stays if that condition belongs to it: it stays
mounted with its wear, is ground in only if that was incomplete, rests if it has measured nothing, then is heated again.
Specimens are resumed separately, because a simulated run may measure them at the same time. With references, all steps
after the first remaining step also remain. A belt that the grids name is asked for again: an interruption does not
show which one is on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tester.inputs.recipe.plan import Mounted, PromptStep, Stand
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    Cool,
    Heat,
    Install,
    PreGrind,
    Rest,
    WheelCondition,
    WheelPlan,
    WheelStep,
    starts_of,
)
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED, prepare_wheel, with_belts


def remaining(plan: WheelPlan, stand: Stand) -> WheelPlan:
    """Return the plan of the remaining steps, possibly without steps."""
    steps: list[WheelStep] = []
    starts = starts_of(plan.steps, lambda install: install.specimen)
    for begin, end in zip(starts, [*starts[1:], None], strict=True):
        segment = plan.steps[begin:end]
        steps += segment if steps and plan.references else _rest_of(plan, segment, stand)
    return replace(plan, steps=with_belts(steps, again=True))


def _rest_of(plan: WheelPlan, segment: Sequence[WheelStep], stand: Stand) -> list[WheelStep]:
    """Return the remaining steps of one specimen."""
    places = [place for place, step in enumerate(segment) if isinstance(step, WheelCondition)]
    numbers = {place: step.condition for place, step in enumerate(segment) if isinstance(step, WheelCondition)}
    left = [place for place in places if numbers[place] not in stand.ended]
    specimens = {step.specimen for step in segment if isinstance(step, Install)}
    wheels = [wheel for wheel in stand.mounted if wheel.specimen in specimens]
    if not wheels:
        return list(segment)
    wheel = wheels[-1]
    mounted = {each.number for each in wheels}
    if not places:
        return _only_prepared(plan, segment, wheel, mounted)
    if not left:
        return []
    begin = left[0]
    over = max((place for place in places if place < begin), default=-1)
    if any(isinstance(step, Install) and step.wheel not in mounted for step in segment[over + 1 : begin]):
        return list(segment[over + 1 :])
    condition = segment[begin]
    assert isinstance(condition, WheelCondition)
    steps = [_mounted(plan, wheel), *_prepare(plan, wheel)]
    if numbers[begin] not in stand.begun:
        asked = {one.text for one in plan.prepare.person_steps}
        steps += [s for s in segment[over + 1 : begin] if isinstance(s, PromptStep) and s.text not in asked]
    steps.append(Heat(INSERTED, condition.setpoint.number("temperature")))
    return [*steps, *segment[begin:]]


def _only_prepared(plan: WheelPlan, segment: Sequence[WheelStep], wheel: Mounted, mounted: set[int]) -> list[WheelStep]:
    """Return the remaining steps of a plan that only grinds wheels in."""
    steps = [] if wheel.ground else [_mounted(plan, wheel), *_prepare(plan, wheel)]
    for place, step in enumerate(segment):
        if isinstance(step, Install) and step.wheel not in mounted:
            begin = place - 1 if place and isinstance(segment[place - 1], Cool) else place
            return [*steps, *segment[begin:]]
    return steps


def _mounted(plan: WheelPlan, wheel: Mounted) -> Install:
    specimen = plan.specimen(wheel.specimen)
    return Install(
        INSERTED, wheel.specimen, wheel.number, specimen.compound, specimen.words, wheel.replicate, worn=wheel
    )


def _prepare(plan: WheelPlan, wheel: Mounted) -> list[WheelStep]:
    """Return the preparation that the wheel still needs before it measures."""
    if wheel.last_condition:
        return []
    specimen = plan.specimen(wheel.specimen)
    steps = prepare_wheel(plan.prepare, specimen, wheel.replicate, wheel.number, cool=True, heat_c=None)
    wanted: list[WheelStep] = [step for step in steps if not isinstance(step, Cool | Install)]
    if not wheel.ground:
        return wanted
    ground = next((i for i, step in enumerate(wanted) if isinstance(step, PreGrind)), -1)
    return [step for step in wanted[ground + 1 :] if isinstance(step, Rest)]
