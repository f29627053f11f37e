"""The answer to a question of the run."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget
from textual.widgets import Input

from tester.service.commands import Answer
from tester.service.state import PromptView
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.words import clean


class PromptDialog(Dialog):
    """Asks for an answer, which is recorded."""

    TITLE = "The run asks"

    def __init__(self, prompt: PromptView) -> None:
        """``prompt``: the question."""
        super().__init__()
        self.prompt = prompt

    def content(self) -> Iterable[Widget]:
        """Return question and field."""
        yield line([(clean(self.prompt.text), "bold")])
        yield line('Answer when it is done. The answer is recorded; "no" leaves the question waiting.')
        yield field("Answer", entry("answer", "yes", limit=2000))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send it."""
        event.stop()
        self.host.order(Answer(self.prompt.number, event.value.strip() or "yes"), "answered")
        self.dismiss(None)
