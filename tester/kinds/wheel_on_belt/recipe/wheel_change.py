"""The steps around a new wheel: cool, install, wait until it is at ambient, pre-grind, rest, heat back.

One function for both who need it: expanding a recipe, and the executor when a wheel wears faster than predicted.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import repeat

from tester.inputs.recipe.plan import PromptStep, Specimen
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    Cool,
    Heat,
    Install,
    PreGrind,
    PreparePolicy,
    Rest,
    WheelCondition,
    WheelPlan,
    WheelStep,
)

INSERTED = -1
"""``index`` of steps that are not in the plan."""

TOUCH = Cool(INSERTED)
"""The cool-down to a hub that a person may touch [A]: before every question at the wheel."""

READY_AT_MOST_S = 5400.0
"""Longest wait for a new wheel to come to ambient before it is ground [A]."""


def wheel_change(plan: WheelPlan, step: WheelCondition, specimen: Specimen, wheel: int) -> tuple[WheelStep, ...]:
    """Return the steps that put a new wheel on before a condition that the worn one would not outlast.

    ``wheel`` is the new wheel's number. The steps are not in the plan: their ``index`` is ``INSERTED``.
    """
    heat_c = step.setpoint.number("temperature")
    return prepare_wheel(
        plan.prepare, specimen, step.replicate, wheel, cool=True, heat_c=heat_c, numbers=repeat(INSERTED)
    )


def prepare_wheel(
    prepare: PreparePolicy,
    specimen: Specimen,
    replicate: int,
    wheel: int,
    *,
    cool: bool,
    heat_c: float | None,
    numbers: Iterator[int],
) -> tuple[WheelStep, ...]:
    """Return the steps of a new wheel; ``numbers`` gives them their ``index``.

    ``cool`` where the hub may be hot from what was measured before: then the new rubber, which takes the hub's
    temperature, also waits until its surface is near ambient before it is ground. ``heat_c``
    brings it back to the temperature of the conditions that follow; None where a Heat follows anyway.
    """
    grind, rest = prepare.pre_grind, prepare.rest
    steps: list[WheelStep] = [Cool(next(numbers))] if cool else []
    steps.append(Install(next(numbers), specimen.index, wheel, specimen.compound, specimen.note, replicate))
    steps += [PromptStep(next(numbers), text) for text in prepare.person_steps]
    if grind is not None:
        if cool:
            near_c, within_k = prepare.ready_c, prepare.ready_within_k
            steps.append(Rest(next(numbers), 0.0, near_c, within_k, READY_AT_MOST_S))
        speeds = (grind.wheel_speed_m_s, grind.belt_speed_m_s)
        steps.append(PreGrind(next(numbers), *speeds, grind.load_n, grind.duration_s))
    if rest is not None:
        steps.append(Rest(next(numbers), rest.at_least_s, rest.until_c, rest.within_k, rest.at_most_s))
    if heat_c is not None:
        steps.append(Heat(next(numbers), heat_c))
    return tuple(steps)


def mount_again(
    specimen: Specimen, replicate: int, wheel: int, heat_c: float, hub_below_c: float, *, numbers: Iterator[int]
) -> tuple[WheelStep, ...]:
    """Return the steps that put a wheel back on that was taken off before, and warm it: it has been ground in.

    ``hub_below_c``: what the hub has to come down to so that the wheel can be held at ``heat_c``, degC.
    """
    cool = Cool(next(numbers), min(TOUCH.hub_below_c, hub_below_c))
    place = next(numbers)
    install = Install(place, specimen.index, wheel, specimen.compound, specimen.note, replicate, again=True)
    return cool, install, Heat(next(numbers), heat_c)
