"""The plan of a recipe: steps, durations, totals."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import JsonValue
from textual.widget import Widget
from textual.widgets import Static

from tester.axes import condition_words
from tester.recipe.plan import Setpoint
from tester.service.commands import ShowPlan
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.dialogs.start import totals
from tester.tui.shelf import Recipe
from tester.tui.words import clean, minutes

MOST_STEPS = 2000
"""More steps than a person scrolls through are not listed."""


class PlanDialog(Dialog):
    """Shows what a recipe does."""

    TITLE = "Plan"

    def __init__(self, recipe: Recipe) -> None:
        """``recipe``: what to plan."""
        super().__init__()
        self.recipe = recipe

    def content(self) -> Iterable[Widget]:
        """Return the place of the plan."""
        yield line("planning …", id="plan")

    def on_mount(self) -> None:
        """Have it planned."""
        self.add_class("-tall")
        self.run_worker(self._plan(), exit_on_error=False)

    async def _plan(self) -> None:
        found = await self.host.ask(ShowPlan(self.recipe.reference, self.recipe.sent))
        if self.is_attached:
            text = plan_text(found) if isinstance(found, dict) else "no plan"
            self.query_one("#plan", Static).update(text)


def plan_text(plan: dict[str, JsonValue]) -> str:
    """Return a plan (`tester plan --json`) in lines."""
    steps = plan.get("steps")
    listed = steps if isinstance(steps, list) else []
    lines = [totals(plan), ""]
    for number, step in enumerate(listed[:MOST_STEPS], 1):
        if isinstance(step, dict):
            lines.append(f"{number:5}  {minutes(_number(step, 'seconds')):>9}  {_words(step)}")
    if len(listed) > MOST_STEPS:
        lines.append(f"and {len(listed) - MOST_STEPS} more: `tester plan` lists them all")
    return "\n".join(lines)


def _number(step: dict[str, JsonValue], key: str) -> float:
    value = step.get(key)
    return float(value) if isinstance(value, int | float) else 0.0


def _words(step: dict[str, JsonValue]) -> str:
    """Return a step in words."""
    kind = clean(str(step.get("kind", "")))
    match kind:
        case "condition":
            held = Setpoint(clean(str(step.get("compound", ""))), *(_number(step, one) for one in Setpoint._fields[1:]))
            return f"condition {_number(step, 'condition'):g}  {condition_words(held)}"
        case "install":
            return f"install wheel {_number(step, 'wheel'):g}: {clean(str(step.get('compound', '')))}"
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
