"""The steps around a new wheel: cool, install, wait until it is at ambient, pre-grind, rest, heat back; and those to
the belt that a condition names.

They serve the expansion of a recipe, and the executor when a wheel wears faster than predicted.
"""

from __future__ import annotations

from collections.abc import Sequence

from tester.base.axes import surface_of
from tester.inputs.recipe.plan import Specimen
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    ChangeBelt,
    Cool,
    Heat,
    Install,
    PreparePolicy,
    Rest,
    WheelCondition,
    WheelPlan,
    WheelStep,
)

INSERTED = -1
"""The ``index`` of steps that are not in the plan."""

TOUCH = Cool(INSERTED)
"""The cool-down to a hub that a person may touch [A], before every question at the wheel."""

READY_AT_MOST_S = 5400.0
"""Longest wait for a new wheel to come to ambient before it is ground [A]."""


def wheel_change(plan: WheelPlan, step: WheelCondition, specimen: Specimen, wheel: int) -> tuple[WheelStep, ...]:
    """Return the steps that mount a new wheel before a condition that would wear out the present wheel.

    ``wheel`` is the new wheel's number. The steps are not in the plan: their ``index`` is ``INSERTED``.
    """
    heat_c = step.setpoint.number("temperature")
    return prepare_wheel(plan.prepare, specimen, step.replicate, wheel, cool=True, heat_c=heat_c)


def prepare_wheel(
    prepare: PreparePolicy,
    specimen: Specimen,
    replicate: int,
    wheel: int,
    *,
    cool: bool,
    heat_c: float | None,
    belt: ChangeBelt | None = None,
) -> tuple[WheelStep, ...]:
    """Return the steps of a new wheel, each with the ``index`` INSERTED.

    ``cool``: the hub may be hot from earlier conditions. The new rubber takes the hub's temperature, so it also waits
    until its surface is near ambient before it is ground. ``heat_c``: temperature of the next conditions, to heat to;
    None if a Heat follows anyway. ``belt``: change of the belt before, on which the wheel is then ground in.
    """
    grind, rest = prepare.pre_grind, prepare.rest
    steps: list[WheelStep] = [Cool(INSERTED)] if cool else []
    if belt is not None:
        steps.append(belt)
    compound, asked = specimen.compound, specimen.hardness
    steps.append(Install(INSERTED, specimen.index, wheel, compound, specimen.words, replicate, hardness=asked))
    steps += prepare.person_steps
    if grind is not None:
        if cool:
            steps.append(Rest(INSERTED, 0.0, prepare.ready_c, prepare.ready_within_k, READY_AT_MOST_S))
        steps.append(grind)
    if rest is not None:
        steps.append(rest)
    if heat_c is not None:
        steps.append(Heat(INSERTED, heat_c))
    return tuple(steps)


def mount_again(
    specimen: Specimen, replicate: int, wheel: int, heat_c: float, hub_below_c: float
) -> tuple[WheelStep, ...]:
    """Return the steps that mount an earlier wheel again and warm it: it is already ground in.

    ``hub_below_c``: highest hub temperature from which the wheel can be held at ``heat_c``, degC.
    """
    install = Install(INSERTED, specimen.index, wheel, specimen.compound, specimen.words, replicate, again=True)
    return Cool(INSERTED, min(TOUCH.hub_below_c, hub_below_c)), install, Heat(INSERTED, heat_c)


def with_belts(steps: Sequence[WheelStep], *, again: bool) -> tuple[WheelStep, ...]:
    """Return steps in which the belt that a condition names is put on before its wheel, where no step did that yet.

    ``again``: the belt may be on already, because the run resumes.
    """
    found: list[WheelStep] = []
    after_last, on = 0, ""
    for step in steps:
        if isinstance(step, ChangeBelt):
            on = step.surface
        if isinstance(step, WheelCondition):
            belt = surface_of(step.setpoint)
            if belt not in ("", on):
                found.insert(after_last, ChangeBelt(INSERTED, belt, again=again))
                on = belt
            after_last = len(found) + 1
        found.append(step)
    return tuple(found)
