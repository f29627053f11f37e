"""The event log and the help, as pages to scroll."""

from __future__ import annotations

from collections.abc import Iterable

from textual.widget import Widget

from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.formatting import reflow
from tester.tui.widgets.events import event_row
from tester.tui.widgets.panel import Parts, rows

WIDTH = 400
"""Longest line of the log."""


TEXT_WIDTH = 70
"""Columns in a dialog's box, beside its scroll bar."""


class LogDialog(Dialog):
    """All events that are known, newest first."""

    TITLE = "Events, newest first"

    def on_mount(self) -> None:
        """Take the whole height."""
        self.add_class("-tall")

    def content(self) -> Iterable[Widget]:
        """Return the list."""
        lines: list[Parts] = [event_row(event, WIDTH) for event in reversed(self.host.scene.events)]
        yield line(rows(lines) if lines else "nothing has happened yet")


class TextDialog(Dialog):
    """A text to read."""

    def __init__(self, title: str, text: str) -> None:
        """``text``: paragraphs, and keys with two spaces or more before what they do."""
        super().__init__()
        self._title, self._text = title, reflow(text, TEXT_WIDTH)

    def on_mount(self) -> None:
        """Name the box."""
        self.query_one("#box").border_title = self._title

    def content(self) -> Iterable[Widget]:
        """Return the text."""
        yield line(self._text)
