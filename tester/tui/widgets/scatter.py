"""Mu against a setpoint, as points; the series of the chosen condition stands out."""

from __future__ import annotations

from tester.axes import AXES, Axis, condition_words
from tester.tui.plot import scatter
from tester.tui.scene import Scene
from tester.tui.stored import PLOTTED, Row, Stored, points, series
from tester.tui.widgets.panel import FAINT, Panel, Parts, rows
from tester.tui.words import clean, fit


class PlotPanel(Panel):
    """A stored run's coefficients against one of its axes."""

    stored: Stored | None = None
    row: Row | None = None
    axis = 0

    def plot(self, stored: Stored | None, row: Row | None, axis: int) -> None:
        """Plot these from now on; ``row``: the condition whose series is marked."""
        self.stored, self.row, self.axis = stored, row, axis % len(stored.plotted if stored is not None else PLOTTED)
        self.redraw()

    @property
    def title(self) -> str:
        """Return what is plotted, and which series is marked."""
        along = self.along
        what = f"mu against {along.name.replace('_', ' ')} ({along.unit})"
        if self.stored is None or self.row is None or len(series(self.stored, self.row, along)) < 2:
            return what
        held = self.row.held
        others = condition_words(held, [one for one in AXES if one is not along and not one.at_default(held)])
        return f"{what}: ● {clean(others, 80)}   · others"

    @property
    def along(self) -> Axis:
        """Return the axis that is plotted against."""
        return (self.stored.plotted if self.stored is not None else PLOTTED)[self.axis]

    def picture(self, scene: Scene, width: int, height: int) -> Parts:
        """Return the plot."""
        if self.stored is None:
            return [("no run chosen", FAINT)]
        lines = scatter(points(self.stored, self.along, self.row), width, height)
        shown: list[Parts] = [[fit(line, width)] for line in lines]
        return rows(shown) if shown else [("no values to plot", FAINT)]
