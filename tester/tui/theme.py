"""Themes: a grey base, with colour only for abnormal states. Two use 24-bit colours, one the 16 of every terminal."""

from __future__ import annotations

from collections.abc import Sequence

from textual.app import App
from textual.filter import LineFilter
from textual.theme import Theme

from tester.tui.filters import AsciiOnly, Colourless

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
"""Uses the terminal's own palette, so that no colour is blended away."""
THEMES = {"dark": DARK, "light": LIGHT, "16": SIXTEEN}

CSS = """
Screen { background: $background; color: $foreground; layers: base; }
#state, #tabs, #keys { height: 1; width: 100%; }
#state { background: $panel; }
#keys { background: $panel; }
ContentSwitcher { height: 1fr; }
View { height: 100%; width: 100%; }
.box { border: round $secondary; padding: 0 1; }
.trend { width: 1fr; height: 100%; padding: 0; }
#tiny { display: none; height: 1fr; }
Screen.-tiny #tiny { display: block; }
Screen.-tiny ContentSwitcher { display: none; }

#prompt { height: 4; border: heavy $warning; padding: 0 1; }
#run-left { width: 1fr; }
#values { height: 8; }
#progress { height: 3; }
#trends-1 { height: 1fr; }
#trends-2 { height: 1fr; display: none; }
#trend-fourth { display: none; }
#run-right { width: 44; display: none; }
#steps, #events { height: 1fr; }
Screen.-wide #values { height: 12; }
Screen.-wide #trends-2 { display: block; }
Screen.-wide #run-right { display: block; }
Screen.-huge #values { height: 15; }
Screen.-huge #trend-fourth { display: block; }
Screen.-huge #run-right { width: 60; }

OptionList, TextArea, DataTable, #box {
    scrollbar-size-vertical: 1; scrollbar-background: $background; scrollbar-color: $panel;
    scrollbar-corner-color: $background;
}
#recipe-list { width: 28; height: 100%; }
#recipe-right { width: 1fr; }
#recipe-text { height: 1fr; border: round $secondary; padding: 0; }
#problems { height: auto; max-height: 40%; }
Screen.-wide #recipe-list { width: 36; }
OptionList { background: $background; border: round $secondary; padding: 0; }
OptionList:focus, DataTable:focus { border: round $accent; }
OptionList > .option-list--option-highlighted { background: $panel; color: $foreground; text-style: none; }
OptionList:focus > .option-list--option-highlighted {
    background: $foreground; color: $background; text-style: bold underline;
}
DataTable { background: $background; border: round $secondary; }
DataTable > .datatable--cursor { background: $panel; color: $foreground; text-style: none; }
DataTable:focus > .datatable--cursor { text-style: bold reverse; }
DataTable > .datatable--header { background: $panel; color: $foreground; text-style: bold; }
DataTable > .datatable--hover { background: $background; }
TextArea { background: $background; }
TextArea .text-area--cursor-line { background: $panel; text-style: bold; }
TextArea .text-area--cursor-gutter { text-style: bold reverse; }

Dialog { background: transparent; align: center top; }
Dialog > #box {
    width: 76; max-width: 100%; height: auto; max-height: 100%; background: $surface; border: heavy $accent;
    padding: 0 1; overflow-y: auto; margin: 2 0 1 0;
}
Dialog .line { height: auto; width: 100%; }
Dialog .field { height: 1; width: 100%; }
Dialog .field Static { width: 20; }
Dialog .field Input { width: 1fr; }
Dialog .buttons { height: 1; width: 100%; margin-top: 1; }
Dialog Button { margin-right: 2; }
Button, Button.-primary { background: $panel; color: $foreground; }
Button:focus, Button.-primary:focus { background: $foreground; color: $background; text-style: bold underline; }
Input { background: $panel; color: $foreground; }
Input:focus { text-style: underline; }
Checkbox { background: $surface; border: none; padding: 0; }
Dialog.-tall > #box { width: 100%; height: 100%; }

#repeat-list { height: auto; max-height: 9; border: none; }
#traces { height: 1fr; }
#big-plot { height: 1fr; }

#manual-values { height: 12; }
#manual-axes { width: 1fr; height: 100%; }
#manual-state { height: 5; }
#manual-events { height: 1fr; }
#runs { height: 35%; }
#conditions { height: 1fr; }
#plot { height: 40%; display: none; }
Screen.-wide #plot { display: block; }
Screen.-wide #runs { height: 25%; }
#ring-runs { height: 8; }
#ring-angle { width: 42; height: 100%; }
#ring-speed { height: 7; }
#ring-age { height: 1fr; }
Screen.-wide #ring-runs { height: 35%; }
Screen.-wide #ring-angle { width: 1fr; }
#devices { height: 11; }
#buses { height: 5; }
Screen.-wide #devices { height: 14; }
#frames { height: 1fr; }
#filter { display: none; height: 1; }
#filter.-open { display: block; }

#time { height: 1; width: 100%; }
ToastRack { margin-bottom: 1; }
Toast { width: 60; max-width: 80%; background: $panel; padding: 0 1; margin-top: 0; }
Tooltip { display: none; }
CommandPalette { background: transparent; }
CommandPalette SearchIcon { display: none; }
CommandPalette CommandList > .option-list--option-highlighted {
    background: $foreground; color: $background; text-style: bold underline;
}
CommandPalette > Vertical { background: $surface; margin: 2 0 1 0; }
"""


class LookApp(App[str]):
    """An application in the program's colours."""

    def __init__(self, theme: str = "", *, plain: bool = False) -> None:
        """``theme``: a name of THEMES, "" = by the terminal; ``plain``: ASCII only."""
        super().__init__()
        self._theme_wanted = theme
        for known in THEMES.values():
            self.register_theme(known)
        self.theme = THEMES.get(theme, DARK).name
        self._last_filters: list[LineFilter] = [Colourless()] if self.no_color else []
        if plain:
            self._last_filters.append(AsciiOnly())

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the filters between screen and terminal; NO_COLOR removes all colour, not only its saturation."""
        if self._last_filters and self.no_color:
            return list(self._last_filters)
        return [*super().get_line_filters(), *self._last_filters]

    def choose_colours(self) -> None:
        """Use the sixteen colours if the terminal has no more, unless a theme was chosen."""
        if not self._theme_wanted and self.console.color_system == "standard":
            self.theme = THEMES["16"].name
