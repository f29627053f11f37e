"""Themes: a grey base, with colour only for abnormal states. Two use 24-bit colours, the third the 16 colours of every
terminal.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from textual.app import App
from textual.binding import Binding, BindingType
from textual.events import Resize
from textual.filter import LineFilter
from textual.theme import Theme
from textual.types import CSSPathType

from tester.base import keys
from tester.tui.filters import AsciiOnly, Colourless
from tester.tui.formatting import clean

DARK = Theme(
    name="grey-dark",
    primary="#8a8f98",
    secondary="#767b84",
    accent="#a9b1bd",
    foreground="#c9ccd1",
    background="#17191c",
    surface="#1d2024",
    panel="#24282d",
    warning="#e0a82e",
    error="#e5484d",
    success="#8a8f98",
    dark=True,
)
LIGHT = Theme(
    name="grey-light",
    primary="#5d636d",
    secondary="#737983",
    accent="#3f4650",
    foreground="#22262b",
    background="#e9eaec",
    surface="#f2f3f4",
    panel="#dcdee1",
    warning="#9a6700",
    error="#c11f26",
    success="#5d636d",
    dark=False,
)
SIXTEEN = Theme(
    name="grey-16",
    primary="#c0c0c0",
    secondary="#c0c0c0",
    accent="#ffffff",
    foreground="#c0c0c0",
    background="#000000",
    surface="#000000",
    panel="#000000",
    warning="#ffff00",
    error="#ff0000",
    success="#c0c0c0",
    dark=True,
)
"""Theme in the terminal's own palette, so that no colour is blended away."""
THEMES = {"dark": DARK, "light": LIGHT, "16": SIXTEEN}

SMALLEST, WIDE, HUGE = (60, 15), (110, 34), (180, 46)
"""Columns and lines: of the smallest terminal for the screens, and of terminals with room for more panels."""
STYLES = Path(__file__).with_name("screens.tcss")


class LookApp(App[str]):
    """An application in the colours of this program."""

    CSS_PATH: ClassVar[CSSPathType | None] = [STYLES]
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(",".join(keys.STOP.keys), "stop", "STOP", priority=True, show=False),
        Binding(",".join(keys.FAST_STOP.keys), "fast_stop", "Fast stop", priority=True, show=False),
    ]

    def __init__(self, theme: str = "", *, plain: bool = False) -> None:
        """``theme``: a name of THEMES, "" = chosen by the terminal; ``plain``: use only ASCII."""
        super().__init__()
        self._theme_wanted = theme
        for known in THEMES.values():
            self.register_theme(known)
        self.theme = THEMES.get(theme, DARK).name
        self._last_filters: list[LineFilter] = [Colourless()] if self.no_color else []
        if plain:
            self._last_filters.append(AsciiOnly())

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the filters between screen and terminal. NO_COLOR removes all colour, not only its saturation."""
        if self._last_filters and self.no_color:
            return list(self._last_filters)
        return [*super().get_line_filters(), *self._last_filters]

    def say(self, text: str, *, problem: bool = False, lasting: bool = False) -> None:
        """Show a message to the person, as plain text."""
        self.notify(
            clean(text), severity="error" if problem else "information", timeout=60.0 if lasting else 6.0, markup=False
        )

    def show_said(self) -> None:
        """Show the messages that have not expired on the present screen. Here Textual does so."""

    def size_classes(self, event: Resize, small: str) -> None:
        """Set the classes of the size: ``small`` below SMALLEST, ``-wide`` and ``-huge`` from WIDE and HUGE on."""
        width, height = event.size
        base = self.screen_stack[0]
        base.set_class(width < SMALLEST[0] or height < SMALLEST[1], small)
        base.set_class(width >= WIDE[0] and height >= WIDE[1], "-wide")
        base.set_class(width >= HUGE[0] and height >= HUGE[1], "-huge")

    def choose_colours(self) -> None:
        """Use the sixteen colours if the terminal has no others, unless a theme was chosen."""
        if not self._theme_wanted and self.console.color_system == "standard":
            self.theme = THEMES["16"].name
