"""Mu against a setpoint, as points; the series of the chosen condition stands out."""

from __future__ import annotations

from tester.base.axes import Axis, condition_words
from tester.tui.formatting import clean, fit
from tester.tui.plot import scatter
from tester.tui.scene import ScreenScene
from tester.tui.stored import Row, Stored, points, series
from tester.tui.widgets.panel import FAINT, Panel, Parts, rows


class PlotPanel(Panel):
    """A stored run's coefficients against one of its axes."""

    stored: Stored | None = None
    row: Row | None = None
    axis = 0

    def plot(self, stored: Stored | None, row: Row | None, axis: int) -> None:
        """Plot these from now on; ``row``: the condition whose series is marked."""
        self.stored, self.row, self.axis = stored, row, axis % len(stored.plotted) if stored is not None else 0
        self.redraw()

    @property
    def title(self) -> str:
        """Return what is plotted, and which series is marked."""
        along = self.along
        if along is None:
            return "mu"
        what = f"mu against {along.name.replace('_', ' ')} ({along.unit})"
        if self.stored is None or self.row is None or len(series(self.stored, self.row, along)) < 2:
            return what
        held = self.row.held
        others = [one for one in held.axes if one.name != along.name and not one.at_default(held)]
        return f"{what}: ● {clean(condition_words(held, others), 80)}   · others"

    @property
    def along(self) -> Axis | None:
        """Return the axis that is plotted against; None while no run is chosen."""
        return self.stored.plotted[self.axis] if self.stored is not None else None

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the plot."""
        along = self.along
        if self.stored is None or along is None:
            return [("no run chosen", FAINT)]
        lines = scatter(points(self.stored, along, self.row), width, height)
        shown: list[Parts] = [[fit(line, width)] for line in lines]
        return rows(shown) if shown else [("no values to plot", FAINT)]
