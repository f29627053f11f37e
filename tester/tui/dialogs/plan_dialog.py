"""The plan of a recipe: steps, durations, totals."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import JsonValue
from textual.widget import Widget
from textual.widgets import Static

from tester.base.axes import Axes, AxisValue, axes_from, condition_words
from tester.base.words import duration
from tester.service.commands import ShowPlan
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.dialogs.start import totals
from tester.tui.formatting import clean
from tester.tui.recipe_library import ListedRecipe

MOST_STEPS = 2000
"""Most steps listed: more would be too many to scroll through."""


class PlanDialog(Dialog):
    """Shows what a recipe does."""

    TITLE = "Plan"
    TALL = True

    def __init__(self, recipe: ListedRecipe) -> None:
        """``recipe``: what to plan."""
        super().__init__()
        self.recipe = recipe

    def content(self) -> Iterable[Widget]:
        """Return the widget for the plan."""
        yield line("planning …", id="plan")

    def on_mount(self) -> None:
        """Plan the recipe."""
        self.run_worker(self._plan(), exit_on_error=False)

    async def _plan(self) -> None:
        plan = await self.host.ask(ShowPlan(self.recipe.reference, self.recipe.sent))
        if self.is_attached:
            text = plan_text(plan, clean(self.host.scene.machine.specimen)) if isinstance(plan, dict) else "no plan"
            self.query_one("#plan", Static).update(text)


def plan_text(plan: dict[str, JsonValue], part: str) -> str:
    """Return a plan (`tester plan --json`) in lines; ``part``: people's name for the part that wears and is changed."""
    steps = plan.get("steps")
    listed = steps if isinstance(steps, list) else []
    axes = _axes(plan)
    lines = [totals(plan, part), ""]
    for number, step in enumerate(listed[:MOST_STEPS], 1):
        if isinstance(step, dict):
            lines.append(f"{number:5}  {duration(_number(step, 'seconds')):>9}  {_words(step, axes, part)}")
    if len(listed) > MOST_STEPS:
        lines.append(f"and {len(listed) - MOST_STEPS} more: `tester plan` lists them all")
    return "\n".join(lines)


def _number(step: dict[str, JsonValue], key: str) -> float:
    value = step.get(key)
    return float(value) if isinstance(value, int | float) else 0.0


def _axes(plan: dict[str, JsonValue]) -> Axes | None:
    """Return the axes of a plan's conditions; None if it lacks them."""
    listed = plan.get("axes")
    rows = [row for row in listed if isinstance(row, dict)] if isinstance(listed, list) else []
    return axes_from(rows) if rows else None


def _held(step: dict[str, JsonValue], axes: Axes) -> str:
    """Return a condition's setpoints in words."""
    held: dict[str, AxisValue] = {}
    for one in axes:
        value = step.get(one.field)
        held[one.name] = clean(value) if isinstance(value, str) else _number(step, one.field)
    return condition_words(axes.setpoint(clean(str(step.get("compound", ""))), **held))


def _words(step: dict[str, JsonValue], axes: Axes | None, part: str) -> str:
    """Return a step in words."""
    kind = clean(str(step.get("kind", "")))
    match kind:
        case "condition":
            return f"condition {_number(step, 'condition'):g}  {_held(step, axes) if axes is not None else ''}".rstrip()
        case "install":
            return f"install {part} {_number(step, part):g}: {clean(str(step.get('compound', '')))}"
        case "pre_grind":
            return f"pre-grind {_number(step, 'duration_s'):g} s at {_number(step, 'load_n'):g} N"
        case "rest":
            return f"rest to {_number(step, 'until_c'):g} °C"
        case "heat":
            return f"heat to {_number(step, 'temperature_c'):g} °C"
        case "prompt":
            return f"ask: {clean(str(step.get('text', '')))}"
        case _:
            return kind
