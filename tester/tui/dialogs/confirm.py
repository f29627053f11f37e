"""Dialogs before a run stops or moves again: abort (by typing a word), resume (from a list of runs), and the pre-flight
list.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import ClassVar

from pydantic import JsonValue
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Button, Input, OptionList
from textual.widgets.option_list import Option

from tester.service.commands import Action, ResumeRun, Stop
from tester.service.state_view import Check, StateView
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.formatting import clean
from tester.tui.host import Listed, runs_in
from tester.tui.own_service import end_service
from tester.tui.widgets.panel_base import FAINT, WARNING, Parts, rows

WORD = "abort"
SIGNS = {True: "✔", False: "✘", None: "?"}


def preflight_rows(checks: tuple[Check, ...]) -> Parts:
    """Return the pre-flight list; a check that needs a connection is marked as made when the service connects."""
    lines: list[Parts] = []
    for check in checks:
        text = f" {SIGNS[check.ok]} {clean(check.name)}" + (f": {clean(check.text)}" if check.text else "")
        lines.append([(text, {True: "", False: WARNING, None: FAINT}[check.ok])])
    return rows(lines)


class AbortDialog(Dialog):
    """A controlled stop of the run, after the person has typed a word."""

    TITLE = "Abort the run"

    def content(self) -> Iterable[Widget]:
        """Return a line on what the stop does, and the field where a person types ``WORD``."""
        yield line("The rig makes a controlled stop. Committed repeats stay; `tester resume` continues later.")
        yield field(f"Type: {WORD}", entry("word"))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Stop, if the word is correct."""
        event.stop()
        if event.value.strip().lower() == WORD:
            self.host.order(Stop(), "aborting: controlled stop")
            self.dismiss(None)
        else:
            self.host.say(f"nothing done: type {WORD}, or Esc")


class EndServiceDialog(Dialog):
    """Asks before the service that a screen started is ended."""

    TITLE = "End the service"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "go", "End", show=False)]

    def content(self) -> Iterable[Widget]:
        """Return what follows, and the button."""
        yield line("The service ends, and every other screen and page with it. Stored runs stay; `tester tui` starts "
                   "another service.")  # fmt: skip
        yield Button("End the service (Enter)", id="go", compact=True)

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """End it, after the button."""
        event.stop()
        self.action_go()

    def action_go(self) -> None:
        """End it, and say so or why not."""
        refusal = end_service()
        self.host.say(refusal or "the service is asked to end", problem=bool(refusal))
        self.dismiss(None)


class GoOnDialog(Dialog):
    """Asks before motion starts again: the pre-flight list, then Enter."""

    TITLE = "Resume"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "go", "Resume", show=False)]

    def __init__(self, state: StateView, action: Action, words: str) -> None:
        """``words``: text that describes what will happen."""
        super().__init__()
        self.state, self.action, self.words = state, action, words

    def content(self) -> Iterable[Widget]:
        """Return the list and the button."""
        yield line([(clean(self.words), "bold")])
        yield line(preflight_rows(self.state.preflight))
        yield Button("Resume (Enter)", id="go", compact=True)

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Send the order, after the button."""
        event.stop()
        self.action_go()

    def action_go(self) -> None:
        """Send the order."""
        self.host.order(self.action, self.words)
        self.dismiss(None)


def resumable(answer: JsonValue) -> list[Listed]:
    """Return those of the listed runs (``runs_in``) that can be resumed, newest first."""
    resumables = [run for run in runs_in(answer) or () if run.get("can_resume") is True]
    return sorted(resumables, key=lambda run: str(run.get("started_utc")), reverse=True)


def run_line(run: Listed) -> str:
    """Return a run as a line: name, status, committed share."""
    committed = f"{run.get('repeats')} of {run.get('repeats_planned')} repeats committed"
    return f"{clean(str(run.get('run')))}  {clean(str(run.get('status')))}, {committed}"


class ResumeDialog(Dialog):
    """Lists runs; Enter shows the pre-flight list for the chosen run."""

    TITLE = "Resume a run"

    def __init__(self, state: StateView, runs: Sequence[Listed]) -> None:
        """``runs``: as ``resumable`` returns them, at least one."""
        super().__init__()
        self.state, self.runs = state, runs

    def content(self) -> Iterable[Widget]:
        """Return the list."""
        yield line("Committed repeats stay; the run resumes at the first uncommitted repeat. Enter chooses.")
        yield OptionList(*(Option(Content(run_line(run))) for run in self.runs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Show the pre-flight list for a run."""
        event.stop()
        host, name = self.host, str(self.runs[event.option_index].get("run"))
        speed = host.options.speed if self.state.simulated else 1.0
        self.dismiss(None)
        host.push_screen(GoOnDialog(self.state, ResumeRun(name, speed), f"{clean(name)} resumes"))
        host.go_to("run")
