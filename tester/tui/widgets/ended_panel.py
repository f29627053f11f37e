"""The results of a run: its conditions' values while it runs, and the table at its end, in place of the gauges."""

from __future__ import annotations

from tester.service.results_view import GrowingView
from tester.service.state_view import PlanStep
from tester.tui.formatting import clean, fit
from tester.tui.screen_scene import ScreenScene
from tester.tui.stored import row_words
from tester.tui.widgets.panel_base import FAINT, Panel, Parts, rows

CELL = 24
"""Most characters of a cell."""


def step_value(scene: ScreenScene, step: PlanStep) -> str:
    """Return what the condition of a step has given, as every table prints it; while it is measured, what it gives so
    far. "" for another step, and while nothing is known.
    """
    given = scene.given
    if given is None or not step.condition or step.state == "later":
        return ""
    growing = given.growing
    if growing is not None and growing.condition == step.condition:
        return growing.grown[-1].text if growing.grown else ""
    found = given.of(step.condition)
    return found.text if found is not None and step.state == "done" else ""


def latest_words(scene: ScreenScene) -> str:
    """Return the present condition's value as it grows, else the last one with its value, as a line; "" without."""
    given = scene.given
    if given is None:
        return ""
    if given.growing is not None and (words := growing_words(given.growing)):
        return words
    for step in reversed(scene.plan.steps if scene.plan is not None else ()):
        if value := step_value(scene, step):
            return f"last: {clean(step.title, 60)}: {value}"
    return ""


def growing_words(growing: GrowingView) -> str:
    """Return a condition's value so far in words; "" before there is any."""
    words: list[str] = []
    if growing.grown:
        words.append(f"{growing.grown[-1].text} after {growing.grown[-1].repeats} of {growing.asked}")
    if growing.open is not None:
        words.append(f"repeat {growing.open.repeat}: {growing.open.mu:.3f} so far")
    return f"now: {'; '.join(words)}" if words else ""


class EndedPanel(Panel):
    """The table of the run that has ended."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return headings and a row for each condition, as many as fit."""
        stored = scene.table
        if stored is None:
            return self._of_service(scene, width, height)
        self.entitle(f"Results of {clean(stored.name, 60)}: {stored.values} of {stored.conditions} with a value")
        table = [stored.header, *(tuple(clean(cell, CELL) for cell in row.cells) for row in stored.rows)]
        if height > 2 and sum(_widths(table)) + 2 * len(stored.header) > width:  # the setpoints in words, and the value
            table = [("condition", "mu ± U"), *((clean(row_words(row), 60), row.short) for row in stored.rows)]
        return _lines(table, width, height)

    def _of_service(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return what the service has sent, for a screen on another computer than the record."""
        given, plan = scene.given, scene.plan
        if given is None or plan is None:
            return [("the results are being read …", FAINT)]
        self.entitle(f"Results of {clean(given.run, 60)}")
        listed = [(step, value) for step in plan.steps if step.condition and (value := given.of(step.condition))]
        return _lines(
            [("condition", "mu ± U"), *((clean(step.title, 60), value.text) for step, value in listed)], width, height
        )


def _lines(table: list[tuple[str, ...]], width: int, height: int) -> Parts:
    widths = _widths(table)
    texts = ["  ".join(cell.ljust(room) for cell, room in zip(line, widths, strict=True)) for line in table]
    hidden = len(texts) - height
    if hidden > 0:
        texts[height - 1 :] = [f"… {hidden + 1} more: Enter shows all"]
    lines: list[Parts] = [[(fit(text, width), "bold" if at == 0 else "")] for at, text in enumerate(texts)]
    return rows(lines)


def _widths(table: list[tuple[str, ...]]) -> list[int]:
    return [max(len(line[column]) for line in table) for column in range(len(table[0]))]
