"""A plan as JSON for programs: a step a line, units in the keys."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import lru_cache

from tester.recipe.cost import StepEstimate
from tester.recipe.describe import window_words
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
)

_encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
_quoted = lru_cache(maxsize=1024)(_encode)
"""Names of grids and compounds come again and again."""


def json_chunks(plan: Plan, estimate: Estimate) -> Iterator[str]:
    """Yield the plan as JSON text, piece by piece, a step a line: a plan may have hundreds of thousands."""
    head: dict[str, object] = {
        "recipe": plan.name,
        "conditions": sum(1 for _ in plan.conditions()),
        "rig_seconds": round(estimate.rig_seconds, 1),
        "sliding_m": round(estimate.sliding_m, 2),
        "loss_mm": round(estimate.loss_mm, 4),
        "friction_j": round(estimate.friction_j, 1),
        "peak_c": round(estimate.peak_c, 2) if math.isfinite(estimate.peak_c) else None,
        "wheels": estimate.wheels,
        "replace_after_mm": plan.replace_after_mm,
        "not_held": list(estimate.not_held),
        "specimens": [{"index": one.index, "compound": one.compound, "note": one.note} for one in plan.specimens],
        "metadata": dict(plan.metadata),
    }
    yield _encode(head)[:-1] + ', "steps": ['
    separator = "\n"
    conditions = _ConditionJson()
    for step, one in zip(plan.steps, estimate.steps, strict=True):
        yield separator
        yield conditions.line(step, one) if isinstance(step, ConditionStep) else _encode(_fields(step, one))
        separator = ",\n"
    yield "\n]}\n"


def _fields(step: Step, one: StepEstimate) -> dict[str, object]:
    """Return a step that is no condition with its estimate as plain data; units in the keys."""
    fields: dict[str, object] = {"kind": step.kind, "index": step.index, "seconds": round(one.seconds, 1)}
    match step:
        case Install():
            fields.update(
                specimen=step.specimen,
                replicate=step.replicate,
                wheel=step.wheel,
                compound=step.compound,
                note=step.note,
            )
        case PreGrind():
            fields.update(
                wheel_speed_m_s=step.wheel_speed_m_s,
                belt_speed_m_s=step.belt_speed_m_s,
                load_n=step.load_n,
                duration_s=step.duration_s,
                sliding_m=round(one.sliding_m, 3),
                loss_mm=round(one.loss_mm, 5),
            )
        case Rest():
            fields.update(
                at_least_s=step.at_least_s, until_c=step.until_c, within_k=step.within_k, at_most_s=step.at_most_s
            )
        case Heat():
            fields.update(temperature_c=step.temperature_c)
        case Cool():
            fields.update(hub_below_c=step.hub_below_c)
        case Prompt():
            fields.update(text=step.text)
        case ConditionStep():
            pass
    return fields


class _Texts(dict[float, str]):
    """Numbers as JSON has them, each written once: few different ones are held in a great many conditions."""

    def __missing__(self, value: float) -> str:
        text = self[value] = repr(value)
        return text


class _ConditionJson:
    """Conditions with their estimates as JSON.

    A template and texts made once: a dictionary for each of 100,000 conditions, encoded, takes four times as long.
    """

    _KEYS = (
        "condition",
        "row",
        "specimen",
        "replicate",
        "wheel",
        "grid",
        "compound",
        "slip_velocity_m_s",
        "load_n",
        "sideslip_deg",
        "camber_deg",
        "temperature_c",
        "wheel_speed_m_s",
        "belt_speed_m_s",
        "repeats",
        "at_most",
        "until_percent",
        "min_valid",
        "window",
        "temperature_band_k",
        "bursts",
        "held",
        "sliding_m",
        "loss_mm",
    )
    _TEMPLATE = (
        '{"kind": "condition", "index": %s, "seconds": %.1f, ' + ", ".join(f'"{key}": %s' for key in _KEYS) + "}"
    )

    def __init__(self) -> None:
        self._numbers = _Texts()
        self._belts: dict[tuple[float, float], str] = {}
        self._windows: dict[tuple[float | None, float | None], str] = {}

    def line(self, step: ConditionStep, one: StepEstimate) -> str:
        """Return one condition; ``%s`` of an integer and of a finite float is what JSON has for it."""
        compound, slip_m_s, load_n, sideslip_deg, camber_deg, temperature_c, wheel_m_s = sp = step.setpoint
        number = self._numbers
        belt = self._belts.get((wheel_m_s, slip_m_s))
        if belt is None:
            belt = self._belts[wheel_m_s, slip_m_s] = repr(sp.belt_speed_m_s)
        extent = step.window.revolutions, step.window.seconds
        window = self._windows.get(extent)
        if window is None:
            window = self._windows[extent] = _encode(window_words(step.window))
        return self._TEMPLATE % (
            step.index,
            one.seconds,
            step.condition,
            step.row,
            step.specimen,
            step.replicate,
            step.wheel,
            _quoted(step.grid),
            _quoted(compound),
            number[slip_m_s],
            number[load_n],
            number[sideslip_deg],
            number[camber_deg],
            number[temperature_c],
            number[wheel_m_s],
            belt,
            step.repeats,
            step.at_most,
            "null" if step.until_percent is None else number[step.until_percent],
            step.min_valid,
            window,
            number[step.temperature_band_k],
            one.bursts,
            "true" if one.held else "false",
            round(one.sliding_m, 3),
            round(one.loss_mm, 5),
        )
