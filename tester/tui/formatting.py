"""Formats numbers, times and foreign text for the screens."""

from __future__ import annotations

import re
import unicodedata
from datetime import datetime
from textwrap import wrap

REPLACEMENT = "\N{REPLACEMENT CHARACTER}"
_KEY = re.compile(r"\S.*?  +(?=\S)")
"""Pattern of a key in a help text: two spaces or more follow it."""
HIDDEN = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp", "Mn", "Me"})
"""Unicode categories of characters that move the cursor, reverse the writing direction or are invisible."""


def clean(text: str, limit: int = 2000) -> str:
    """Return a foreign text as one line for display, with every invisible character replaced.

    Each character is replaced by exactly one, so that columns stay aligned. ``limit``: greatest number of characters
    kept.
    """
    return "".join(" " if c == "\t" else REPLACEMENT if unicodedata.category(c) in HIDDEN else c for c in text[:limit])


def clean_lines(text: str) -> str:
    """Return a text of several lines with the replacements of ``clean``; line ends remain."""
    return "\n".join(clean(line) for line in text.split("\n"))


def clock_text(utc: str, *, seconds: bool = False) -> str:
    """Return the local time of day of an ISO 8601 text in UTC; any other text unchanged."""
    try:
        moment = local(datetime.fromisoformat(utc))
    except ValueError:
        return clean(utc, 20)
    return moment.strftime("%H:%M:%S" if seconds else "%H:%M")


def local(moment: datetime) -> datetime:
    """Return a moment in the time zone of the machine."""
    return moment.astimezone()


def reflow(text: str, width: int) -> str:
    """Return a help text in lines of ``width`` characters: paragraphs are filled, and a key's description is indented
    after the key.
    """
    lines: list[str] = []
    paragraph: list[str] = []
    for line in [*text.splitlines(), ""]:
        key = _KEY.match(line)
        if paragraph and (key or not line):
            lines += wrap(" ".join(paragraph), width)
            paragraph = []
        if key:
            lines += wrap(line, width, subsequent_indent=" " * key.end())
        elif line:
            paragraph.append(line)
        else:
            lines.append("")
    return "\n".join(lines[:-1])


def fit(text: str, width: int) -> str:
    """Return a text cut to ``width`` characters, with an ellipsis if it is cut."""
    if width <= 0:
        return ""
    return text if len(text) <= width else text[: width - 1] + "…"
