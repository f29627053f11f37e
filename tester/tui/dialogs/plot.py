"""The plot of Results over the whole screen, for terminals that have no room for it beside the tables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from tester.tui.dialogs.dialog import Dialog
from tester.tui.stored import Row, Stored
from tester.tui.widgets.scatter import PlotPanel


class PlotDialog(Dialog):
    """Mu against one setpoint after another."""

    TITLE = "Plot"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("p", "next", "Next", show=False)]

    def __init__(self, stored: Stored, row: Row | None, axis: int) -> None:
        """``row``: the condition whose series is marked; ``axis``: the first one shown."""
        super().__init__()
        self.stored, self.row, self.axis = stored, row, axis

    def content(self) -> Iterable[Widget]:
        """Return the plot."""
        yield PlotPanel(id="big-plot")

    def on_mount(self) -> None:
        """Take the whole height and draw."""
        self.add_class("-tall")
        box = self.query_one("#box")
        box.border_subtitle = "p next axis · Esc closes · F12 STOP"
        self._plot()

    def _plot(self) -> None:
        panel = self.query_one(PlotPanel)
        panel.plot(self.stored, self.row, self.axis)
        self.query_one("#box").border_title = panel.title
        panel.show(self.host.scene)

    def action_next(self) -> None:
        """Plot against the next axis."""
        self.axis += 1
        self._plot()
