"""Base of every dialog: the fixed lines stay visible, Escape closes the dialog, and STOP always works."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.screen import ModalScreen
from textual.widget import Widget
from textual.widgets import Input, Static

from tester.tui.formatting import reflow
from tester.tui.host import HostApp, host_of
from tester.tui.widgets.head import event_row
from tester.tui.widgets.panel_base import Parts, rows
from tester.tui.widgets.said import SaidLines


class Dialog(ModalScreen[None]):
    """A box between line 2 and the last line."""

    TITLE: ClassVar[str | None] = ""
    SUBTITLE: ClassVar[str] = "Esc closes · F12 STOP"
    TALL: ClassVar[bool] = False
    """Whether the box uses the whole height."""
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "close", "Close", show=False)]

    @property
    def host(self) -> HostApp:
        """Return the application."""
        return host_of(self)

    def compose(self) -> ComposeResult:
        """Put the content into the box."""
        self.set_class(self.TALL, "-tall")
        with Vertical(id="box") as box:
            box.border_title, box.border_subtitle = self.title or "", self.SUBTITLE
            yield from self.content()
        lines = SaidLines()
        yield lines
        lines.call_after_refresh(self.host.show_said)

    def content(self) -> Iterable[Widget]:
        """Return the widgets in the box."""
        return ()

    def action_close(self) -> None:
        """Close without a result."""
        self.dismiss(None)


def line(parts: Parts | str, *, id: str | None = None) -> Static:  # noqa: A002 - as in Textual
    """Return a widget that shows plain text."""
    content = Content(parts) if isinstance(parts, str) else Content.assemble(*parts)
    return Static(content, classes="line", markup=False, id=id)


def field(label: str, entry: Input) -> Horizontal:
    """Return an input field with its label, in one row."""
    return Horizontal(Static(label, markup=False), entry, classes="field")


def entry(name: str, value: str = "", *, hint: str = "", limit: int = 200) -> Input:
    """Return an input field of one row."""
    return Input(value, placeholder=hint, id=name, compact=True, max_length=limit)


WIDTH = 400
"""Greatest length of a line in the log, characters."""


TEXT_WIDTH = 70
"""Columns of text in a dialog's box, without its scroll bar."""


class LogDialog(Dialog):
    """All known events, newest first."""

    TITLE = "Events, newest first"
    TALL = True

    def content(self) -> Iterable[Widget]:
        """Return the list."""
        lines: list[Parts] = [event_row(event, WIDTH) for event in reversed(self.host.scene.events)]
        yield line(rows(lines) if lines else "nothing has happened yet")


class TextDialog(Dialog):
    """A text to read."""

    def __init__(self, title: str, text: str) -> None:
        """``text``: paragraphs, or keys that are followed by two spaces or more and their description."""
        super().__init__()
        self.title = title
        self._text = reflow(text, TEXT_WIDTH)

    def content(self) -> Iterable[Widget]:
        """Return the text."""
        yield line(self._text)
