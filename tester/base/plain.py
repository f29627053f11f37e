"""Text that people, clients and files give us: what it may hold, and how it is shown if it holds more."""

from __future__ import annotations

import re

FORBIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u2069\ufeff\ufff9-\ufffb"
    "\ud800-\udfff\ufffe\uffff\U000e0000-\U000e007f]"
)
"""Control, bidirectional and invisible characters, and what is no character at all."""

_NOT_IN_A_LINE = re.compile(f"{FORBIDDEN.pattern}|[\t\n]")


def plain_text(text: str, where: str = "") -> str:
    """Return a text of one line as it was given: a name, a note, a reason. ``where``: what it is, for the message.

    Raises ValueError that names the first character that is refused, and its place counted from 1.
    """
    found = _NOT_IN_A_LINE.search(text)
    if found is None:
        return text
    what = f"the character U+{ord(found.group()):04X}, number {found.start() + 1}, is not accepted"
    raise ValueError(f"{where}: {what} (control, bidirectional or invisible)" if where else what)


def harmless(text: str) -> str:
    """Return a text that cannot steer a terminal: what could is a question mark; tabs and line ends stay."""
    return FORBIDDEN.sub("?", text)
