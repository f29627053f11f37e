"""Run: values with their limits, progress, trends, steps, events, and the question that waits."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical

from tester.tui.dialogs.log import LogDialog
from tester.tui.dialogs.prompt import PromptDialog
from tester.tui.pages.view import Keys, View
from tester.tui.widgets.events import EventsPanel
from tester.tui.widgets.progress import ProgressPanel
from tester.tui.widgets.prompt import PromptPanel
from tester.tui.widgets.steps import StepsPanel
from tester.tui.widgets.trends import TrendPanel
from tester.tui.widgets.values import ValuesPanel

HELP = """\
Each row: measured value, setpoint, unit, and a bar. On the bar ● is the value, ┼ the setpoint, ═ the band in which
samples count, ├ and ┤ the limits at which something happens. A dim value with ? is old: it is not a value.

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
        """``plain``: ASCII trends."""
        super().__init__(id=id)
        self.plain = plain

    def compose(self) -> ComposeResult:
        """Lay out the panels."""
        yield PromptPanel(id="prompt")
        with Horizontal():
            with Vertical(id="run-left"):
                yield ValuesPanel(id="values", classes="box")
                yield ProgressPanel(id="progress")
                with Horizontal(id="trends-1"):
                    yield TrendPanel(0, plain=self.plain, id="trend-first")
                    yield TrendPanel(1, plain=self.plain, id="trend-second")
                with Horizontal(id="trends-2"):
                    yield TrendPanel(2, plain=self.plain, id="trend-third")
                    yield TrendPanel(3, plain=self.plain, id="trend-fourth")
            with Vertical(id="run-right"):
                yield StepsPanel(id="steps", classes="box")
                yield EventsPanel(id="events", classes="box")

    def on_mount(self) -> None:
        """Name the boxes."""
        self.query_one("#values").border_title = "Process: measured, setpoint"
        self.query_one("#steps").border_title = "Steps"
        self.query_one("#events").border_title = "Alarms and events"

    def action_answer(self) -> None:
        """Ask for the answer to the question that waits; at the end of a run, show what it has measured."""
        state = self.host.scene.state
        if state is not None and state.prompt is not None:
            self.host.push_screen(PromptDialog(state.prompt))
        elif (run := self.host.scene.ended_run) is not None:
            self.host.show_results(run)

    def action_log(self) -> None:
        """Show the event log."""
        self.host.push_screen(LogDialog())
