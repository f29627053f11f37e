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
        now = next((at for at, step in enumerate(plan.steps) if step.state != "done"), len(plan.steps))
        first = max(min(now - height // 3, len(plan.steps) - height), 0)
        shown, below = plan.steps[first : first + height], plan.steps[first + height :]
        more = plan.total - plan.first + 1 - first - len(shown)
        if more and len(shown) == height:  # the last row is for what has none, so that the list adds up
            *shown, last = shown
            below, more = (last, *below), more + 1
        left_s = scene.state.progress.step_left_s if scene.state is not None else None
        lines = [step_row(step, width, left_s) for step in shown]
        if more:
            beyond_s = sum(step.expected_s for step in below) + plan.beyond_s
            lines.append([_row("·", f"{more} more steps", f"~{duration(beyond_s)}", width)])
        return rows(lines)


def step_row(step: PlanStep, width: int, left_s: float | None) -> Parts:
    """Return a step: sign, title, and what it took, what is left of it (``left_s``, of the present one), or what it is
    expected to take."""
    if step.measured_s is not None:
        time = duration(step.measured_s)
    else:
        time = f"~{duration(left_s if step.state == 'now' and left_s is not None else step.expected_s)}"
    style = {"done": FAINT, "now": "bold", "later": ""}[step.state]
    return [(_row(SIGNS[step.state], clean(step.title), time, width), style)]


def _row(sign: str, title: str, time: str, width: int) -> str:
    room = max(width - TIME - 3, 4)
    return f"{sign} {fit(title, room).ljust(room)} {time:>{TIME}}"
