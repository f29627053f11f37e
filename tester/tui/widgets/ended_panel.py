"""The results of a run: the last finished condition while it runs, and the table at its end, in place of the gauges."""

from __future__ import annotations

from tester.service.state_view import PlanStep
from tester.tui.formatting import clean, fit
from tester.tui.screen_scene import ScreenScene
from tester.tui.stored import Stored, row_words
from tester.tui.widgets.panel_base import FAINT, Panel, Parts, rows

CELL = 24
"""Most characters of a cell."""


def step_value(stored: Stored | None, steps: tuple[PlanStep, ...], at: int, *, whole: bool) -> str:
    """Return what the finished condition of a step gave, as every table prints it; "" if unknown.

    ``whole``: the list begins with the plan's first step. Otherwise replicates, whose titles are alike, cannot be told
    apart, and have none.
    """
    step = steps[at]
    if stored is None or step.state != "done":
        return ""
    alike = stored.titled(step.title)  # none for a step that is no condition
    if len(alike) > 1 and not whole:
        return ""
    turn = sum(other.title == step.title for other in steps[:at])
    return alike[turn].short if turn < len(alike) else ""


def latest_words(scene: ScreenScene) -> str:
    """Return the last finished condition with its value, as a line; "" while there is none."""
    stored, plan = scene.results, scene.plan
    if stored is None or plan is None:
        return ""
    for at in range(len(plan.steps) - 1, -1, -1):
        value = step_value(stored, plan.steps, at, whole=plan.first == 1)
        if value:
            return f"last: {clean(plan.steps[at].title, 60)}: {value}"
    return ""


class EndedPanel(Panel):
    """The table of the run that has ended."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return headings and a row for each condition, as many as fit."""
        stored = scene.results
        if stored is None:
            return [("the results are being read …", FAINT)]
        self.entitle(f"Results of {clean(stored.name, 60)}: {stored.values} of {stored.conditions} with a value")
        table = [stored.header, *(tuple(clean(cell, CELL) for cell in row.cells) for row in stored.rows)]
        if height > 2 and sum(_widths(table)) + 2 * len(stored.header) > width:  # the setpoints in words, and the value
            table = [("condition", "mu ± U"), *((clean(row_words(row), 60), row.short) for row in stored.rows)]
        widths = _widths(table)
        texts = ["  ".join(cell.ljust(room) for cell, room in zip(line, widths, strict=True)) for line in table]
        hidden = len(texts) - height
        if hidden > 0:
            texts[height - 1 :] = [f"… {hidden + 1} more: Enter shows all"]
        lines: list[Parts] = [[(fit(text, width), "bold" if at == 0 else "")] for at, text in enumerate(texts)]
        return rows(lines)


def _widths(table: list[tuple[str, ...]]) -> list[int]:
    return [max(len(line[column]) for line in table) for column in range(len(table[0]))]
