"""The wheel's part of a plan's description, in words and as JSON (common part: ``tester.inputs.recipe``)."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tester.analysis.difference import pieces_needed
from tester.analysis.reference import EVERY, RESERVED
from tester.base.axes import condition_words, surface_of
from tester.base.words import listed_some, rough_duration
from tester.inputs.recipe.plan import ConditionStep, Plan, PromptStep, Step, fields_of
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.time_estimate import HISTORIC_PERCENT, Estimate, StepEstimate
from tester.kinds.wheel_on_belt.budget import BETWEEN_PERCENT
from tester.kinds.wheel_on_belt.image.axes import held_by, on_belt
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    ChangeBelt,
    Cool,
    Install,
    PreGrind,
    Rest,
    ToolPrompt,
    WheelCondition,
    WheelPlan,
)

TOLD_APART_PERCENT = (10.0, 5.0)
"""Differences of two compounds for which a plan states the number of wheels beforehand."""


class WheelDescription(RecipePart):
    """Describes plans of wheels. ``WheelPart`` adds the rest of a recipe's part."""

    def words(self, step: Step, one: StepEstimate) -> str:
        match step:
            case Install():
                return f"mount wheel {step.wheel} again" if step.again else f"install wheel {step.wheel}"
            case PreGrind():
                speeds = f"{step.wheel_speed_m_s:g} / {step.belt_speed_m_s:g} m/s"
                return f"pre-grind {rough_duration(step.duration_s)}, {step.load_n:g} N, wheel / belt {speeds}"
            case Rest():
                least = f"rest at least {rough_duration(step.at_least_s)}" if step.at_least_s else "rest"
                return least if step.until_c is None else f"{least}, to {step.until_c:g} degC +- {step.within_k:g} K"
            case WheelCondition():
                held = condition_words(step.setpoint, compound=False)
                bursts = f", {one.bursts} bursts" if one.bursts > 1 else ""
                run_in = f", run-in {step.run_in_m:g} m" if step.both_directions and step.run_in_m else ""
                mark = "  reference" if step.reference else ""
                scheme = f"{step.repeats_words} x {step.window.words}{bursts}{run_in}{mark}"
                return f"{step.condition:>4}  {held}  {scheme}"
            case Cool():
                return f"cool the hub below {step.hub_below_c:g} degC"
            case ToolPrompt():
                return f"ask, with a tool: {step.text}"
            case ChangeBelt():
                return f"ask: {step.title}"
            case PromptStep():
                return f"ask: {step.text}"
            case _:
                return step.title

    def heading(self, plan: Plan, step: Step) -> str:
        """Return a wheel's compound, note, replicate, and its predicted total loss."""
        if not isinstance(step, Install):
            return ""
        wear = WheelPlan.of(plan).wear
        replicated = any(one.replicate > 1 for one in wear)
        note = f" ({step.note})" if step.note else ""
        replicate = f", replicate {step.replicate}" if replicated else ""
        worn = wear[step.wheel - 1]
        if step.again:
            return f"wheel {step.wheel} again: {step.compound}{note}{replicate}"
        conditions = "1 condition" if worn.conditions == 1 else f"{worn.conditions} conditions"
        loss = f"{worn.loss_mm:.2f} mm of diameter"
        return f"wheel {step.wheel}: {step.compound}{note}{replicate}, {conditions}, {loss}"

    def totals(self, plan: Plan, estimate: Estimate) -> Iterator[str]:
        """Yield wear, heat, and the conditions whose temperature is not expected to hold."""
        plan = WheelPlan.of(plan)
        count = _wheels(plan)
        wheels = "wheel" if count == 1 else "wheels"
        yield f"wear              {estimate.loss_mm:.2f} mm of diameter on {count} {wheels}"
        yield f"                  (a wheel is replaced after {plan.replace_after_mm:g} mm)"
        if math.isfinite(estimate.peak_c):
            yield f"peak temperature  {estimate.peak_c:.0f} degC on the rubber"
        yield from _telling(plan)
        yield from _both_directions(plan)
        yield from _references(plan)
        if estimate.not_held:
            some = listed_some(estimate.not_held, 20)
            yield f"not expected to hold their temperature for one revolution: conditions {some}"

    def plan_fields(self, plan: Plan, estimate: Estimate) -> dict[str, object]:
        """Return wear and heat for a plan's JSON."""
        plan = WheelPlan.of(plan)
        return {
            "loss_mm": round(estimate.loss_mm, 4),
            "friction_j": round(estimate.friction_j, 1),
            "peak_c": round(estimate.peak_c, 2) if math.isfinite(estimate.peak_c) else None,
            "wheels": _wheels(plan),
            "replace_after_mm": plan.replace_after_mm,
            **({"references": plan.references} if plan.references else {}),
        }

    def step_fields(self, step: Step, one: StepEstimate) -> dict[str, object]:
        match step:
            case Install():
                return {
                    "specimen": step.specimen,
                    "replicate": step.replicate,
                    "wheel": step.wheel,
                    "compound": step.compound,
                    "note": step.note,
                    **({"again": True} if step.again else {}),
                }
            case PreGrind():
                return fields_of(step) | {"sliding_m": round(one.sliding_m, 3), "loss_mm": round(one.loss_mm, 5)}
            case _:
                return fields_of(step)

    def condition_fields(self, step: ConditionStep, one: StepEstimate) -> dict[str, object]:
        assert isinstance(step, WheelCondition)
        return super().condition_fields(step, one) | {
            "wheel": step.wheel,
            "belt_speed_m_s": held_by(step.setpoint).belt_speed_m_s,
            "both_directions": step.both_directions,
            "bursts": one.bursts,
            "loss_mm": round(one.loss_mm, 5),
        }


def _wheels(plan: WheelPlan) -> int:
    return sum(isinstance(step, Install) and not step.again for step in plan.steps)


def _telling(plan: WheelPlan) -> Iterator[str]:
    """Yield how many wheels of each compound resolve a difference, with the assumed scatter of repeats and wheels."""
    fewest = min((step.repeats for step in plan.conditions() if not step.reference), default=0)
    if not fewest:
        return
    each = min(step.scheme.repeats_each for step in plan.conditions())
    repeats = HISTORIC_PERCENT / math.sqrt(fewest * each)
    needed = [(percent, pieces_needed(percent, BETWEEN_PERCENT, repeats)) for percent in TOLD_APART_PERCENT]
    words = ", ".join(f"{percent:g} % takes {count}" for percent, count in needed)
    have = max(step.replicate for step in plan.conditions())
    yield f"two compounds     to tell {words} wheels each (replicates; here {have})"


def _both_directions(plan: WheelPlan) -> Iterator[str]:
    """Yield how many conditions slide both ways, and how fast the belt runs for it."""
    both = [step for step in plan.conditions() if step.both_directions]
    if both:
        held = [held_by(step.setpoint) for step in both]
        fastest = max(belt for one in held for belt in (one.belt_speed_m_s, one.reversed().belt_speed_m_s))
        yield f"both directions   {len(both)} conditions: repeats alternate + - - +, the belt at up to {fastest:g} m/s"


def _references(plan: WheelPlan) -> Iterator[str]:
    """Yield how often the reference condition is measured, and its setpoint, which may contain defaults."""
    first = next((step for step in plan.conditions() if step.reference), None)
    if first is not None:
        belts = {surface_of(step.setpoint) for step in plan.conditions() if step.reference}
        setpoint = first.setpoint if len(belts) == 1 else on_belt(first.setpoint, "")
        held = condition_words(setpoint, compound=False) + ("" if len(belts) == 1 else " on each belt")
        reserved = plan.metadata.get(RESERVED)
        on = f"on a wheel reserved for it ({reserved})" if reserved else "on whichever wheel is on"
        every = f"after every {plan.metadata[EVERY]} conditions"
        yield f"references        {plan.references} of {held},"
        yield f"                  {every}, {on}"
