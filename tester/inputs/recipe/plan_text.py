"""A plan in words, and as JSON for programs: its steps in order, its duration and its wear."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tester.base.words import rough_duration
from tester.inputs.recipe.conditions import MergedConditions
from tester.inputs.recipe.plan import ConditionStep, Plan, Step
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.time_estimate import Estimate

_WIDTH = 76
"""Columns of a line before its duration."""


def lines(plan: Plan, estimate: Estimate, part: RecipePart) -> Iterator[str]:
    """Yield the plan line by line: every step with its duration, then the totals."""
    yield plan.name
    for step, step_estimate in zip(plan.steps, estimate.steps, strict=True):
        heading = part.heading(plan, step)
        if heading:
            yield ""
            yield heading
        text = f"{_indent(step)}{part.words(step, step_estimate)}{_read(step)}"
        yield f"{text:<{_WIDTH}} {rough_duration(step_estimate.seconds):>10}" if step_estimate.seconds else text
    yield ""
    yield from totals(plan, estimate, part)


def totals(plan: Plan, estimate: Estimate, part: RecipePart) -> Iterator[str]:
    """Yield the totals of the plan, a figure in each line."""
    conditions = list(plan.conditions())
    repeats = sum(step.repeats * step.scheme.repeats_each for step in conditions)
    yield f"conditions        {len(conditions)}, {repeats} repeats"
    least, most = rough_duration(estimate.rig_seconds_low), rough_duration(estimate.rig_seconds_high)
    yield f"rig time          {rough_duration(estimate.rig_seconds)} ({least} to {most} in 95 % of runs)"
    yield f"sliding distance  {estimate.sliding_m:.0f} m"
    yield from part.totals(plan, estimate)


def _indent(step: Step) -> str:
    return "    " if isinstance(step, ConditionStep) else "  "


def _read(step: Step) -> str:
    """Return what a person reads where a piece is put on, in words: only steps that mount one ask for a hardness."""
    return ", its hardness is read" if getattr(step, "hardness", False) else ""


_encode: Final = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
"""Returns plain data as JSON on one line; refuses numbers that are not finite."""


def json_chunks(
    plan: Plan,
    estimate: Estimate,
    part: RecipePart,
    merged: Sequence[MergedConditions] = (),
    uncertainty: Mapping[str, object] | None = None,
) -> Iterator[str]:
    """Yield the plan as JSON text in pieces, one line per step, because a plan may have hundreds of thousands of steps.

    ``merged``: conditions that several grids of the recipe list and the plan measures once. ``uncertainty``: the
    plan's predicted uncertainty (``tester.inputs.recipe.foreseen``).
    """
    head: dict[str, object] = {
        "recipe": plan.name,
        "conditions": sum(1 for _ in plan.conditions()),
        "rig_seconds": round(estimate.rig_seconds, 1),
        "rig_seconds_low": round(estimate.rig_seconds_low, 1),
        "rig_seconds_high": round(estimate.rig_seconds_high, 1),
        "sliding_m": round(estimate.sliding_m, 2),
        **part.plan_fields(plan, estimate),
        **({"uncertainty": dict(uncertainty)} if uncertainty else {}),
        "not_held": list(estimate.not_held),
        "merged": [conditions.as_data() for conditions in merged],
        "specimens": [
            {"index": specimen.index, "compound": specimen.compound, "note": specimen.note}
            for specimen in plan.specimens
        ],
        "metadata": dict(plan.metadata),
        "kind": plan.kind,
        "axes": plan.axes.as_data() if plan.axes is not None else [],
    }
    yield _encode(head)[:-1] + ', "steps": ['
    separator = "\n"
    for step, step_estimate in zip(plan.steps, estimate.steps, strict=True):
        common = {"kind": step.kind, "index": step.index, "seconds": round(step_estimate.seconds, 1)}
        condition = isinstance(step, ConditionStep)
        own = part.condition_fields(step, step_estimate) if condition else part.step_fields(step, step_estimate)
        yield separator + _encode(common | own)
        separator = ",\n"
    yield "\n]}\n"
