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
from tester.tui.dialogs.start import number_in, totals
from tester.tui.formatting import clean
from tester.tui.recipe_library import ListedRecipe

MOST_STEPS = 2000
"""Greatest number of steps listed: more would be too many to scroll through."""


class PlanDialog(Dialog):
    """Shows what a recipe does."""

    TITLE = "Plan"
    TALL = True

    def __init__(self, recipe: ListedRecipe) -> None:
        """``recipe``: the recipe to plan."""
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
    """Return a plan (`tester plan --json`) in lines; ``part``: name for people of the part that wears and is
    changed.
    """
    steps = plan.get("steps")
    listed = steps if isinstance(steps, list) else []
    axes = _axes(plan)
    lines = [totals(plan, part), ""]
    for number, step in enumerate(listed[:MOST_STEPS], 1):
        if isinstance(step, dict):
            lines.append(f"{number:5}  {duration(number_in(step, 'seconds')):>9}  {_words(step, axes, part)}")
    if len(listed) > MOST_STEPS:
        lines.append(f"and {len(listed) - MOST_STEPS} more: `tester plan` lists them all")
    return "\n".join(lines)


def _axes(plan: dict[str, JsonValue]) -> Axes | None:
    """Return the axes of a plan's conditions; None if the plan does not contain them."""
    listed = plan.get("axes")
    rows = [row for row in listed if isinstance(row, dict)] if isinstance(listed, list) else []
    return axes_from(rows) if rows else None


def _setpoints(step: dict[str, JsonValue], axes: Axes) -> str:
    """Return a condition's setpoints in words."""
    values: dict[str, AxisValue] = {}
    for axis in axes:
        value = step.get(axis.field)
        values[axis.name] = clean(value) if isinstance(value, str) else number_in(step, axis.field)
    return condition_words(axes.setpoint(clean(str(step.get("compound", ""))), **values))


def _words(step: dict[str, JsonValue], axes: Axes | None, part: str) -> str:
    """Return a step in words."""
    kind = clean(str(step.get("kind", "")))
    match kind:
        case "condition":
            setpoints = _setpoints(step, axes) if axes is not None else ""
            return f"condition {number_in(step, 'condition'):g}  {setpoints}".rstrip()
        case "install":
            return f"install {part} {number_in(step, part):g}: {clean(str(step.get('compound', '')))}"
        case "pre_grind":
            return f"pre-grind {number_in(step, 'duration_s'):g} s at {number_in(step, 'load_n'):g} N"
        case "rest":
            return f"rest to {number_in(step, 'until_c'):g} °C"
        case "heat":
            return f"heat to {number_in(step, 'temperature_c'):g} °C"
        case "prompt":
            return f"ask: {clean(str(step.get('text', '')))}"
        case _:
            return kind
