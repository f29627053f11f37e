"""A plan as JSON for programs: a step a line, units in the keys."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

from tester.base.axes import Axes, AxisValue
from tester.inputs.recipe.conditions import MergedConditions
from tester.inputs.recipe.plan import ConditionStep, Plan, Window
from tester.inputs.recipe.plan_text import window_words
from tester.inputs.recipe.time_estimate import Estimate, StepEstimate

if TYPE_CHECKING:
    from tester.inputs.recipe.recipe_part import RecipePart

encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
"""Returns plain data as JSON on one line; numbers that are not finite are refused."""
quoted = lru_cache(maxsize=1024)(encode)
"""Names of grids and compounds repeat many times."""


def json_chunks(
    plan: Plan,
    estimate: Estimate,
    part: RecipePart,
    merged: Sequence[MergedConditions] = (),
    uncertainty: Mapping[str, object] | None = None,
) -> Iterator[str]:
    """Yield the plan as JSON text, piece by piece, a step a line: a plan may have hundreds of thousands.

    ``merged``: conditions that are steps of the plan once, and occur in several grids of its recipe. ``uncertainty``:
    the prediction for it (``tester.inputs.recipe.foreseen``).
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
    yield encode(head)[:-1] + ', "steps": ['
    separator = "\n"
    conditions = part.condition_json()
    for step, step_estimate in zip(plan.steps, estimate.steps, strict=True):
        yield separator
        if isinstance(step, ConditionStep):
            yield conditions.line(step, step_estimate)
        else:
            common = {"kind": step.kind, "index": step.index, "seconds": round(step_estimate.seconds, 1)}
            yield encode(common | part.step_fields(step, step_estimate))
        separator = ",\n"
    yield "\n]}\n"


class _Texts(dict[AxisValue, str]):
    """Values as JSON, each encoded once: many conditions share few different ones."""

    def __missing__(self, value: AxisValue) -> str:
        text = self[value] = encode(value)
        return text


class ConditionJson:
    """Conditions with their estimates as JSON.

    A template and texts made once: a dictionary for each of 100,000 conditions, encoded, takes four times as long. A
    kind with further keys overrides ``keys`` and ``texts``, which go together.
    """

    def __init__(self, axes: Axes) -> None:
        """``axes``: the kind's; each is written under its ``field``."""
        self.axes = axes
        self.number = _Texts()
        self._windows: dict[tuple[float | None, float | None], str] = {}
        keys = ", ".join(f'"{key}": %s' for key in self.keys())
        self._template = '{"kind": "condition", "index": %s, "seconds": %.1f, ' + keys + "}"
        self._places = [axes.places[axis.name] for axis in axes]

    def keys(self) -> tuple[str, ...]:
        """Return the keys after kind, index and seconds; units in them."""
        return (
            "condition",
            "row",
            "specimen",
            "replicate",
            "grid",
            "compound",
            *(axis.field for axis in self.axes),
            "repeats",
            "at_most",
            "until_percent",
            "repeats_expected",
            "min_valid",
            "window",
            "temperature_band_k",
            "held",
            "sliding_m",
        )

    def texts(self, step: ConditionStep, one: StepEstimate) -> tuple[object, ...]:
        """Return the text under each key; ``%s`` of an integer and of a finite float is its form in JSON."""
        setpoint, number = step.setpoint, self.number
        return (
            step.condition,
            step.row,
            step.specimen,
            step.replicate,
            quoted(step.grid),
            quoted(setpoint.compound),
            *(number[setpoint.values[place]] for place in self._places),
            step.repeats,
            step.at_most,
            "null" if step.until_percent is None else number[step.until_percent],
            round(one.repeats, 2),
            step.min_valid,
            self.window(step.window),
            number[step.temperature_band_k],
            "true" if one.held else "false",
            round(one.sliding_m, 3),
        )

    def window(self, window: Window) -> str:
        """Return a window in a recipe's notation, in quotes."""
        extent = window.revolutions, window.seconds
        text = self._windows.get(extent)
        if text is None:
            text = self._windows[extent] = encode(window_words(window))
        return text

    def line(self, step: ConditionStep, one: StepEstimate) -> str:
        """Return one condition."""
        return self._template % (step.index, one.seconds, *self.texts(step, one))
