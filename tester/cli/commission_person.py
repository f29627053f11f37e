"""The person at a terminal who commissions a rig: questions as lines, answers typed, STOP by its keys at any time."""

from __future__ import annotations

import sys
from typing import Final

from tester.base.keys import FAST_STOP, STOP, pieces_of
from tester.cli.command_keys import Keys, keys_of
from tester.cli.console import Outlet
from tester.machine.commission.person import Question

MOST_TYPED: Final = 200
ERASES: Final = ("\b", "\x7f")


class TerminalPerson:
    """A front of the engine on a terminal (tester.machine.commission.person.Person)."""

    def __init__(self, *, time_stands: bool, keys: Keys | None = None) -> None:
        """``time_stands``: on a rig simulated in this process."""
        self.time_stands = time_stands
        self._keys = keys or keys_of(sys.stdin)
        self._err = Outlet(sys.stderr)
        self._question: Question | None = None
        self._typed = ""
        self._answer: str | None = None

    def begin(self) -> None:
        """Take the keyboard."""
        self._keys.begin()
        self.tell(f"{STOP.shown}: {STOP.does}   {FAST_STOP.shown}: {FAST_STOP.does}   at any time")

    def end(self) -> None:
        """Give the keyboard back."""
        self._keys.end()

    def tell(self, text: str) -> None:
        """Write a line."""
        self._err.line(text)

    def put(self, question: Question) -> None:
        """Write the question; what was typed before it stood is no answer to it."""
        self._keys.pressed()
        self._question, self._typed, self._answer = question, "", None
        self._err.line(f"? {question.text}  [{question.hint}]")

    def taken(self, now_s: float) -> str | None:
        """Return the line that was typed."""
        answer = self._answer
        if answer is not None and now_s < float("inf"):
            self._answer = self._question = None
        return answer

    def poll(self) -> list[str]:
        """Take the keys; a line ends with Enter."""
        found: list[str] = []
        for piece, meaning in pieces_of(self._keys.pressed()):
            if meaning is not None and meaning.command in (STOP.command, FAST_STOP.command):
                found.append(meaning.command)
            elif self._question is None or self._answer is not None:
                continue
            elif piece in ("\r", "\n"):
                self._answer = self._typed.strip()
                self._err.line(f"> {self._answer}")
            elif piece in ERASES:
                self._typed = self._typed[:-1]
            elif piece.isprintable():
                self._typed = (self._typed + piece)[:MOST_TYPED]
        return found
