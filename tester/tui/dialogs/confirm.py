"""Abort (typed word), and going on (pre-flight list)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import Button, Input

from tester.service.commands import Action, Stop
from tester.service.state_view import Check, StateView
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.formatting import clean
from tester.tui.widgets.panel_base import FAINT, WARNING, Parts, rows

WORD = "abort"
SIGNS = {True: "✔", False: "✘", None: "?"}


def preflight_rows(checks: tuple[Check, ...]) -> Parts:
    """Return the pre-flight list; checks that need a connection are marked as made when the service connects."""
    lines: list[Parts] = []
    for check in checks:
        text = f" {SIGNS[check.ok]} {clean(check.name)}" + (f": {clean(check.text)}" if check.text else "")
        lines.append([(text, {True: "", False: WARNING, None: FAINT}[check.ok])])
    return rows(lines)


class AbortDialog(Dialog):
    """A controlled stop of the run, after a typed word."""

    TITLE = "Abort the run"

    def content(self) -> Iterable[Widget]:
        """Return what it costs, and the field."""
        yield line("The rig makes a controlled stop. What is committed stays; `tester resume` can go on later.")
        yield field(f"Type: {WORD}", entry("word"))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Stop, if the word is right."""
        event.stop()
        if event.value.strip().lower() == WORD:
            self.host.order(Stop(), "aborting: controlled stop")
            self.dismiss(None)
        else:
            self.host.say(f"nothing done: type {WORD}, or Esc")


class GoOnDialog(Dialog):
    """Motion starts again: the pre-flight list, then Enter."""

    TITLE = "Go on"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "go", "Go on", show=False)]

    def __init__(self, state: StateView, action: Action, words: str) -> None:
        """``words``: what will happen."""
        super().__init__()
        self.state, self.action, self.words = state, action, words

    def content(self) -> Iterable[Widget]:
        """Return the list and the button."""
        yield line([(clean(self.words), "bold")])
        yield line(preflight_rows(self.state.preflight))
        yield Button("Go on (Enter)", id="go", compact=True)

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Go on."""
        event.stop()
        self.action_go()

    def action_go(self) -> None:
        """Give the order."""
        self.host.order(self.action, self.words)
        self.dismiss(None)
