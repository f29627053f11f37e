"""A plan in words: what is done, in which order, how long it takes and what it costs."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tester.recipe.cost import StepEstimate
from tester.recipe.estimate import Estimate
from tester.recipe.plan import (
    ConditionStep,
    Cool,
    Heat,
    Install,
    Plan,
    PreGrind,
    Prompt,
    Rest,
    Step,
    Window,
)

_WIDTH = 76
"""Columns of a line before its duration."""


def duration(seconds: float) -> str:
    """Return a duration as people say it: 45 s, 12 min, 3 h 05 min."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def lines(plan: Plan, estimate: Estimate) -> Iterator[str]:
    """Yield the plan line by line: every step with its duration, then the totals."""
    yield plan.name
    replicated = any(one.replicate > 1 for one in plan.wear)
    for step, one in zip(plan.steps, estimate.steps, strict=True):
        if isinstance(step, Install):
            yield ""
            yield f"wheel {step.wheel}: {_wheel(plan, step, replicated)}"
        text = f"{_indent(step)}{words(step, one)}"
        yield f"{text:<{_WIDTH}} {duration(one.seconds):>10}" if one.seconds else text
    yield ""
    yield from totals(plan, estimate)


def totals(plan: Plan, estimate: Estimate) -> Iterator[str]:
    """Yield what the plan comes to, one figure a line."""
    conditions = list(plan.conditions())
    repeats = sum(step.repeats for step in conditions)
    yield f"conditions        {len(conditions)}, {repeats} repeats"
    yield f"rig time          {duration(estimate.rig_seconds)}"
    yield f"sliding distance  {estimate.sliding_m:.0f} m"
    wheels = "wheel" if estimate.wheels == 1 else "wheels"
    yield f"wear              {estimate.loss_mm:.2f} mm of diameter on {estimate.wheels} {wheels}"
    yield f"                  (a wheel is replaced after {plan.replace_after_mm:g} mm)"
    if math.isfinite(estimate.peak_c):
        yield f"peak temperature  {estimate.peak_c:.0f} degC on the rubber"
    if estimate.not_held:
        listed = ", ".join(str(number) for number in estimate.not_held[:20])
        more = f" and {len(estimate.not_held) - 20} more" if len(estimate.not_held) > 20 else ""
        yield f"not expected to hold their temperature for one revolution: conditions {listed}{more}"


def words(step: Step, one: StepEstimate) -> str:
    """Return one line that says what a step does."""
    match step:
        case Install():
            return f"install wheel {step.wheel}"
        case PreGrind():
            speeds = f"{step.wheel_speed_m_s:g} / {step.belt_speed_m_s:g} m/s"
            return f"pre-grind {duration(step.duration_s)}, {step.load_n:g} N, wheel / belt {speeds}"
        case Rest():
            least = f"rest at least {duration(step.at_least_s)}" if step.at_least_s else "rest"
            return least if step.until_c is None else f"{least}, to {step.until_c:g} degC +- {step.within_k:g} K"
        case Heat():
            return f"heat to {step.temperature_c:g} degC"
        case ConditionStep():
            text = f"{step.condition:>4}  {setpoint_words(step)}  {repeats_words(step)} x {window_words(step.window)}"
            return text + (f", {one.bursts} bursts" if one.bursts > 1 else "")
        case Cool():
            return f"cool the hub below {step.hub_below_c:g} degC"
        case Prompt():
            return f"ask: {step.text}"


def repeats_words(step: ConditionStep) -> str:
    """Return how many repeats are to count, and until what precision where the recipe says so: 4 (until 2 %)."""
    return f"{step.repeats}" + (f" (until {step.until_percent:g} %)" if step.until_percent is not None else "")


def setpoint_words(step: ConditionStep) -> str:
    """Return what is held, angles only where there are any: 300 mm/s  200 N  25 degC."""
    sp = step.setpoint
    text = f"{1000.0 * sp.slip_velocity_m_s:g} mm/s  {sp.load_n:g} N"
    text += f"  sideslip {sp.sideslip_deg:g} deg" if sp.sideslip_deg else ""
    text += f"  camber {sp.camber_deg:g} deg" if sp.camber_deg else ""
    return f"{text}  {sp.temperature_c:g} degC"


def window_words(window: Window) -> str:
    """Return a window as a recipe writes it: 30 rev, or 60 s."""
    return f"{window.revolutions:g} rev" if window.revolutions is not None else f"{window.seconds or 0.0:g} s"


def _indent(step: Step) -> str:
    return "    " if isinstance(step, ConditionStep) else "  "


def _wheel(plan: Plan, step: Install, replicated: bool) -> str:
    """Say what is on a wheel: compound, note, replicate, and what it is predicted to lose."""
    note = f" ({step.note})" if step.note else ""
    replicate = f", replicate {step.replicate}" if replicated else ""
    worn = plan.wear[step.wheel - 1]
    conditions = "1 condition" if worn.conditions == 1 else f"{worn.conditions} conditions"
    return f"{step.compound}{note}{replicate}, {conditions}, {worn.loss_mm:.2f} mm of diameter"
