"""Answers a question of the run by a button or with a quantity, ignoring keys typed before they appeared."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Button, Input

from tester.base import keys
from tester.machine.prompts import DONE
from tester.service.commands import Answer, Hold
from tester.service.state_view import PromptView
from tester.tui.dialogs.dialog import Dialog, entry, line
from tester.tui.formatting import clean

SEEN_S = 0.5
"""Time after a question appears within which an answer counts as typed before it, s [A]."""


class PromptDialog(Dialog):
    """Asks whether the task is done; the answer is recorded."""

    TITLE = "The run asks"
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "app.focus_previous", "Other button", show=False),
        Binding("right", "app.focus_next", "Other button", show=False),
        Binding(",".join(keys.HOLD.keys), "hold", "Hold", show=False),
    ]

    def __init__(self, prompt: PromptView) -> None:
        """``prompt``: the question."""
        super().__init__()
        self.prompt = prompt
        self._shown_s = float("inf")

    def content(self) -> Iterable[Widget]:
        """Return the question and its buttons; the button without effect comes first."""
        yield line([(clean(self.prompt.text), "bold")])
        yield line("Choose with the arrows, then Enter. The answer is recorded; the run continues at once.")
        if self.prompt.unit:
            yield entry("quantity", hint=f"the quantity, in {clean(self.prompt.unit)}", limit=40)
        with Horizontal(classes="buttons"):
            yield Button("Not yet", id="not-yet", compact=True)
            yield Button("Yes, it is done", id="done", compact=True)

    def on_mount(self) -> None:
        """Focus the button without effect."""
        self._shown_s = self.host.scene.now()
        self.query_one("#not-yet").focus()

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Answer, or leave the question waiting."""
        event.stop()
        if self.host.scene.now() - self._shown_s < SEEN_S:
            return
        if event.button.id == "done":
            answer = self.query_one("#quantity", Input).value.strip() if self.prompt.unit else ""
            self.host.order(Answer(self.prompt.number, answer or DONE), f"answered: {answer or DONE}")
        self.dismiss(None)

    def action_hold(self) -> None:
        """HOLD, which also works while the question waits."""
        self.host.order(Hold(), "HOLD")
