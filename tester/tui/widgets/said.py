"""Messages to the person, in lines of their own above the last line: they cover nothing, and they expire."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from textual.content import Content
from textual.widgets import Static

from tester.tui.formatting import clean
from tester.tui.widgets.panel_base import NOTICE, WARNING, Part

SHORT_S, LONG_S = 6.0, 60.0
"""How long a message is shown at least: any, and one that must not be missed, s [A]."""
READ_PER_S = 15.0
"""Characters that a person reads in a second [A]."""
AT_ONCE = 2
"""Messages shown at once; the newest come last."""


@dataclass(frozen=True, slots=True)
class Said:
    """A message, shown until ``until_s`` on the screen's clock, s."""

    text: str
    problem: bool
    until_s: float


def said_now(text: str, *, problem: bool, lasting: bool, now_s: float) -> Said:
    """Return a message that begins now; a long one is shown for longer."""
    least_s = LONG_S if lasting else SHORT_S
    return Said(clean(text), problem, now_s + max(least_s, len(text) / READ_PER_S))


class SaidLines(Static):
    """The latest messages; without one it takes no room."""

    def __init__(self) -> None:
        """Begin without a message."""
        super().__init__("", markup=False, classes="said")
        self.display = False

    def show_said(self, messages: Sequence[Said]) -> None:
        """Show the latest of these messages."""
        parts: list[Part] = []
        for number, message in enumerate(messages[-AT_ONCE:]):
            sign: Part = (" ! ", WARNING) if message.problem else (" · ", NOTICE)
            parts += ["\n" if number else "", sign, f" {message.text}"]
        self.display = bool(parts)
        self.update(Content.assemble(*parts))
