"""The plan's steps: done, now, later, with measured and estimated durations."""

from __future__ import annotations

from tester.base.words import duration
from tester.service.state import PlanStep
from tester.tui.formatting import clean, fit
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import FAINT, Panel, Parts, rows

SIGNS = {"done": "✔", "now": "▶", "later": "·"}
TIME = 9


class StepsPanel(Panel):
    """As many steps around the present one as there are rows."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row a step."""
        plan = scene.plan
        if plan is None:
            return [("no plan", FAINT)]
        now = next((at for at, step in enumerate(plan.steps) if step.state == "now"), len(plan.steps))
        first = max(min(now - height // 3, len(plan.steps) - height), 0)
        return rows([step_row(step, width) for step in plan.steps[first : first + height]])


def step_row(step: PlanStep, width: int) -> Parts:
    """Return a step: sign, title, measured or estimated duration."""
    seconds = step.measured_s if step.measured_s is not None else step.estimated_s
    time = duration(seconds) if step.measured_s is not None else f"~{duration(seconds)}"
    title = fit(clean(step.title), max(width - TIME - 3, 4))
    text = f"{SIGNS[step.state]} {title.ljust(max(width - TIME - 3, 4))} {time:>{TIME}}"
    return [(text, {"done": FAINT, "now": "bold", "later": ""}[step.state])]
