"""Keys and their meanings, in every front end: `tester run` in a terminal, the operator's screen, the pages that name
them.

A terminal may take function keys for itself, so each stop has a function key and a control key. Ctrl+C is no entry: it
asks a program to leave. For a run in the foreground that is a controlled stop (a second one a fast stop), and a screen
leaves without any effect on the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Meaning:
    """One meaning. ``keys``: names for screens; ``typed``: a terminal's characters; ``shown``: for people."""

    command: str
    keys: tuple[str, ...]
    typed: tuple[str, ...]
    shown: str
    does: str


STOP: Final = Meaning("stop", ("f12", "ctrl+x"), ("\x1b[24~", "\x18"), "F12, Ctrl+X", "controlled stop")
FAST_STOP: Final = Meaning("fast stop", ("f9", "ctrl+f"), ("\x1b[20~", "\x06"), "F9, Ctrl+F", "fast stop")
HOLD: Final = Meaning("hold", ("space",), (" ",), "space", "HOLD")
RELEASE: Final = Meaning("release", ("r",), ("r", "R"), "r", "go on")
MEANINGS: Final = (STOP, FAST_STOP, HOLD, RELEASE)
"""Meanings that work wherever a run is shown."""
HELP: Final = "   ".join(f"{meaning.shown} {meaning.does}" for meaning in MEANINGS)


def pieces_of(typed: str) -> list[tuple[str, Meaning | None]]:
    """Return a terminal's input key by key, each with its meaning, None where it has none."""
    keys: list[tuple[str, Meaning | None]] = []
    at = 0
    while at < len(typed):
        meaning, length = _first(typed[at:])
        keys.append((typed[at : at + length], meaning))
        at += length
    return keys


def commands_of(typed: str) -> list[str]:
    """Return the commands in a terminal's input; other keys are ignored, whatever they send."""
    return [meaning.command for _, meaning in pieces_of(typed) if meaning is not None]


def _first(typed: str) -> tuple[Meaning | None, int]:
    """Return the meaning of the first key, and its number of characters."""
    for meaning in MEANINGS:
        for text in meaning.typed:
            if typed.startswith(text):
                return meaning, len(text)
    return None, _length(typed)


def _length(typed: str) -> int:
    """Return the length of the first key's text: of a control sequence (ECMA-48) up to its final byte."""
    if typed[0] != "\x1b" or len(typed) == 1:
        return 1
    if typed[1] == "O":
        return min(3, len(typed))
    if typed[1] != "[":
        return 2
    for at, character in enumerate(typed[2:], 3):
        if "@" <= character <= "~":
            return at
    return len(typed)
