"""Mu against a setpoint, as points; the series of the chosen condition stands out."""

from __future__ import annotations

from tester.tui.plot import scatter
from tester.tui.scene import Scene
from tester.tui.stored import AXES, Row, Stored, points, series
from tester.tui.widgets.panel import FAINT, Panel, Parts, rows
from tester.tui.words import clean, fit


class PlotPanel(Panel):
    """A stored run's coefficients against one of AXES."""

    stored: Stored | None = None
    row: Row | None = None
    axis = 0

    def plot(self, stored: Stored | None, row: Row | None, axis: int) -> None:
        """Plot these from now on; ``row``: the condition whose series is marked."""
        self.stored, self.row, self.axis = stored, row, axis % len(AXES)
        self.redraw()

    @property
    def title(self) -> str:
        """Return what is plotted, and which series is marked."""
        name, unit = AXES[self.axis]
        what = f"mu against {name} ({unit})"
        if self.stored is None or self.row is None or len(series(self.stored, self.row, self.axis)) < 2:
            return what
        others = ", ".join(
            f"{at:g} {unit}" for i, (at, (_, unit)) in enumerate(zip(self.row.at, AXES, strict=True)) if i != self.axis
        )
        return f"{what}: ● {clean(self.row.compound, 20)}, {others}   · others"

    def picture(self, scene: Scene, width: int, height: int) -> Parts:
        """Return the plot."""
        if self.stored is None:
            return [("no run chosen", FAINT)]
        lines = scatter(points(self.stored, self.axis, self.row), width, height)
        shown: list[Parts] = [[fit(line, width)] for line in lines]
        return rows(shown) if shown else [("no values to plot", FAINT)]
