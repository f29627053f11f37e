"""Run: values with their limits, progress, trends, steps, events, and the waiting question."""

from __future__ import annotations

import asyncio
import sqlite3
from functools import partial
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content

from tester.base.words import duration
from tester.service.state_view import PlanStep
from tester.store.record_schema import StoreError
from tester.tui.dialogs.dialog import LogDialog
from tester.tui.dialogs.prompt import PromptDialog
from tester.tui.formatting import clean, clock_text, fit
from tester.tui.host import Keys, View
from tester.tui.screen_scene import UNDER_WAY, ScreenScene
from tester.tui.stored import read
from tester.tui.widgets.ended_panel import EndedPanel, latest_words, step_value
from tester.tui.widgets.head import EventsPanel
from tester.tui.widgets.panel_base import FAINT, WARNING, Panel, Parts, rows
from tester.tui.widgets.progress import ProgressPanel
from tester.tui.widgets.trends_panel import TrendPanel
from tester.tui.widgets.values_panel import ValuesPanel

SIGNS = {"done": "✔", "now": "▶", "later": "·"}
TIME = 9
WITH_BOTH = 56
"""Columns from which a finished condition's row has its value and its time."""


class StepsPanel(Panel):
    """The steps around the present one, as many as there are rows."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each step."""
        plan = scene.plan
        if plan is None:
            return [("no plan", FAINT)]
        now = next((at for at, step in enumerate(plan.steps) if step.state != "done"), len(plan.steps))
        first = max(min(now - height // 3, len(plan.steps) - height), 0)
        shown, below = plan.steps[first : first + height], plan.steps[first + height :]
        more = plan.total - plan.first + 1 - first - len(shown)
        if more and len(shown) == height:  # the last row sums up the steps not shown, so that the list adds up
            *shown, last = shown
            below, more = (last, *below), more + 1
        left_s = scene.state.progress.step_left_s if scene.state is not None else None
        lines = [step_row(step, width, left_s, step_value(scene, step)) for step in shown]
        if more:
            beyond_s = sum(step.expected_s for step in below) + plan.beyond_s
            lines.append([_row("·", f"{more} more steps", f"~{duration(beyond_s)}", width)])
        return rows(lines)


def step_row(step: PlanStep, width: int, left_s: float | None, value: str = "") -> Parts:
    """Return a step as a row: sign, title, and a time: its measured duration, the time left in it (``left_s``), or its
    expected duration. What a finished condition gave (``value``) comes before the time, or in its place if the row is
    narrow.
    """
    if value and width < WITH_BOTH:
        room = max(width - len(value) - 3, 4)
        return [(f"{SIGNS[step.state]} {fit(clean(step.title), room).ljust(room)} ", FAINT), (value, "bold")]
    if step.measured_s is not None:
        time = duration(step.measured_s)
    else:
        time = f"~{duration(left_s if step.state == 'now' and left_s is not None else step.expected_s)}"
    style = {"done": FAINT, "now": "bold", "later": ""}[step.state]
    if value:
        room = max(width - TIME - len(value) - 4, 4)
        title = fit(clean(step.title), room).ljust(room)
        return [(f"{SIGNS[step.state]} {title} ", style), (value, "bold"), (f" {time:>{TIME}}", style)]
    return [(_row(SIGNS[step.state], clean(step.title), time, width), style)]


def _row(sign: str, title: str, time: str, width: int) -> str:
    room = max(width - TIME - 3, 4)
    return f"{sign} {fit(title, room).ljust(room)} {time:>{TIME}}"


class PromptPanel(Panel):
    """The waiting question; visible only while there is one."""

    def show(self, scene: ScreenScene) -> None:
        """Appear and disappear with the question."""
        self.display = scene.state is not None and scene.state.prompt is not None
        super().show(scene)

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return question and keys."""
        if scene.state is None or scene.state.prompt is None:
            return []
        prompt = scene.state.prompt
        since = clock_text(prompt.utc)
        return [
            (" ? ", WARNING),
            fit(f" {clean(prompt.text)}  (waits since {since})", width - 4),
            "\n",
            fit("    Enter: answer it", width),
        ]


HELP = """\
Each row: measured value, setpoint, unit, and a bar. On the bar ● is the value, ┼ the setpoint, ═ the band in which
samples count, ├ and ┤ the limits at which something happens. A dim value with ? is old: it is not a value. A finished
condition has its mu ± U (95 %, of what is mounted) in Steps; at the end the results take the place of the gauges.

space   HOLD: lift, nothing slides, keep the temperature. Costs at most the repeat under way, which is done again.
r       resume after HOLD; else lists the runs that are not over (stopped, tripped, cut off). Shows the pre-flight list.
x       abort: controlled stop of the run under way; type the word.
a       acknowledge the alarm of line 2. Nothing moves by it.
Enter   answer the question that waits: its buttons are shown. At the end of a run: its results.
l       event log.
"""


class RunPage(View, can_focus=True):
    """The run under way."""

    KEYS: ClassVar[Keys] = (("space", "Hold"), ("r", "Resume"), ("x", "Abort…"), ("a", "Ack"), ("l", "Log"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "answer", "Answer", show=False),
        Binding("l", "log", "Log", show=False),
    ]

    def __init__(self, *, plain: bool, id: str) -> None:  # noqa: A002 - as in Textual
        """``plain``: draw trends in ASCII."""
        super().__init__(id=id)
        self.plain = plain
        self._read: tuple[str, str] | None = None
        """Run and outcome for which the table was read."""

    def compose(self) -> ComposeResult:
        """Lay out the panels."""
        yield PromptPanel(id="prompt")
        with Horizontal():
            with Vertical(id="run-left"):
                yield EndedPanel(id="ended", classes="box", title="Results")
                yield ValuesPanel(id="values", classes="box", title="Process: measured, setpoint")
                yield ProgressPanel(id="progress")
                with Horizontal(id="trends-1"):
                    yield TrendPanel(0, plain=self.plain, id="trend-first")
                    yield TrendPanel(1, plain=self.plain, id="trend-second")
                with Horizontal(id="trends-2"):
                    yield TrendPanel(2, plain=self.plain, id="trend-third")
                    yield TrendPanel(3, plain=self.plain, id="trend-fourth")
            with Vertical(id="run-right"):
                yield StepsPanel(id="steps", classes="box", title="Steps")
                yield EventsPanel(id="events", classes="box", title="Alarms and events")

    def show(self, scene: ScreenScene) -> None:
        """Show the scene: the gauges while a run is under way, its results once it has ended."""
        self._follow(scene)
        known = scene.table is not None or (scene.given is not None and scene.plan is not None)
        ended = scene.ended_run is not None and known and not scene.replayed
        self.set_class(ended, "-ended")
        values = self.query_one("#values")
        latest = Content(latest_words(scene))
        if str(values.border_subtitle) != latest.markup:
            values.border_subtitle = latest
        super().show(scene)

    def _follow(self, scene: ScreenScene) -> None:
        """Read the run's table at its end."""
        run = scene.state.run if scene.state is not None else None
        if scene.replayed or run is None or not run.folder:
            return
        wanted = (run.folder, run.outcome)
        if wanted == self._read:
            return
        self._read, scene.table = wanted, None
        if run.outcome != UNDER_WAY:
            self.run_worker(partial(self._read_table, scene, run.folder), group="results", exclusive=True,
                            exit_on_error=False)  # fmt: skip

    async def _read_table(self, scene: ScreenScene, folder: str) -> None:
        """Read the table; of a record that is elsewhere the service's results are shown."""
        try:
            found = await asyncio.to_thread(read, folder, self.host.options.runs)
        except (StoreError, OSError, sqlite3.Error):
            return
        if scene.state is not None and scene.state.run is not None and scene.state.run.folder == folder:
            scene.table = found
            self.host.scene_changed()

    def action_answer(self) -> None:
        """Open the waiting question. At the end of a run, show its results instead."""
        state = self.host.scene.state
        if state is not None and state.prompt is not None:
            self.host.push_screen(PromptDialog(state.prompt))
        elif (run := self.host.scene.ended_run) is not None:
            self.host.show_results(run)

    def action_log(self) -> None:
        """Show the event log."""
        self.host.push_screen(LogDialog())
