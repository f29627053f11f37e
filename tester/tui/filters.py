"""Line filters for the terminal: no colour (NO_COLOR), or ASCII only (--ascii)."""

from __future__ import annotations

from functools import lru_cache

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.color import Color
from textual.filter import LineFilter

_PAIRS = (
    ("─━═╌┄╍▔▁", "-"),
    ("│┃║▌▐▕▏", "|"),
    ("╭╮╰╯┌┐└┘├┤┬┴┼┏┓┗┛", "+"),
    ("●◉", "o"),
    ("■▣", "#"),
    ("□◇◌▢", "."),
    ("◆▲▶▸❯", ">"),
    ("▼◀◂", "<"),
    ("✔", "v"),
    ("✘✖×", "x"),
    ("—–−", "-"),
    ("…·•⋅", "."),
    ("°", "'"),
    ("µμ", "u"),
    ("±", "~"),
    ("→", ">"),
    ("←", "<"),
    ("‖", "="),
    ("█▇▆▅▄", "#"),
    ("▃▂", "_"),
)
TABLE = {ord(sign): plain for signs, plain in _PAIRS for sign in signs}
"""ASCII replacements of other characters."""


@lru_cache(maxsize=4096)
def ascii_text(text: str) -> str:
    """Return a text of the same width in ASCII; characters without a similar one become ``?``."""
    if text.isascii():
        return text
    return "".join(c if c.isascii() else TABLE.get(ord(c), "?" * cell_len(c)) for c in text)


class AsciiOnly(LineFilter):
    """Converts text for terminals and fonts that have only ASCII."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments with ASCII text."""
        return [Segment(ascii_text(text), style, control) for text, style, control in segments]


@lru_cache(maxsize=4096)
def _colourless(style: Style) -> Style:
    return Style(
        bold=style.bold, dim=style.dim, italic=style.italic, underline=style.underline, reverse=style.reverse,
        meta=style.meta,
    )  # fmt: skip


class Colourless(LineFilter):
    """NO_COLOR: removes all colour, and keeps bold, dim, underlined and reversed."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments without colours."""
        return [
            Segment(text, None if style is None else _colourless(style), control) for text, style, control in segments
        ]
