"""What every screen of this program looks like: themes, no colour at all (NO_COLOR), nothing but ASCII."""

from __future__ import annotations

from collections.abc import Sequence

from textual.app import App
from textual.filter import LineFilter

from tester.tui.filters import AsciiOnly, Colourless
from tester.tui.theme import DARK, THEMES


class LookApp(App[str]):
    """An application in the program's colours."""

    def __init__(self, theme: str = "", *, plain: bool = False) -> None:
        """``theme``: a name of THEMES, "" = by the terminal; ``plain``: ASCII only."""
        super().__init__()
        self._theme_wanted = theme
        for one in THEMES.values():
            self.register_theme(one)
        self.theme = THEMES.get(theme, DARK).name
        self._last_filters: list[LineFilter] = [Colourless()] if self.no_color else []
        if plain:
            self._last_filters.append(AsciiOnly())

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return what stands between the screen and the terminal; NO_COLOR takes all colour, not its saturation."""
        if self._last_filters and self.no_color:
            return list(self._last_filters)
        return [*super().get_line_filters(), *self._last_filters]

    def choose_colours(self) -> None:
        """Take the sixteen colours where the terminal has no more, and nobody has said otherwise."""
        if not self._theme_wanted and self.console.color_system == "standard":
            self.theme = THEMES["16"].name
