"""Trends: ten minutes of one value, with its setpoint, band and limits; the y range does not jump."""

from __future__ import annotations

from tester.base.screen import PlotView
from tester.base.words import decimal
from tester.service.protocol import SNAPSHOT_S, TREND_ROWS
from tester.tui.formatting import clean
from tester.tui.plot import LIMIT, WISH, Bin, Canvas, PlotRange
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import FAINT, Panel, Part, Parts

WINDOW_S = SNAPSHOT_S * TREND_ROWS
LABELS = 7
"""Width of the y labels, columns."""


class Bins:
    """Least and greatest value in each interval of time, updated with each new row of the trend."""

    def __init__(self, column: int, count: int, epoch: int) -> None:
        """``column``: the column in the trend's rows; ``count``: number of intervals in the window."""
        self.column, self.count, self.epoch = column, count, epoch
        self.bins: list[Bin | None] = []
        self._first = 0
        self._seen = float("-inf")

    def take(self, row: tuple[float | None, ...]) -> None:
        """Include a row, if it is newer than those before."""
        wall_s = row[0]
        if wall_s is None or wall_s <= self._seen:
            return
        self._seen = wall_s
        slot = int(wall_s / WINDOW_S * self.count)
        if not self.bins:
            self._first = slot
        while self._first + len(self.bins) <= slot:
            if slot - self._first - len(self.bins) > self.count:
                self._first, self.bins = slot, []
            self.bins.append(None)
        y = row[self.column]
        if y is not None:
            known = self.bins[-1]
            self.bins[-1] = (y, y) if known is None else (min(known[0], y), max(known[1], y))
        if len(self.bins) > 2 * self.count:
            self._first += len(self.bins) - self.count
            del self.bins[: len(self.bins) - self.count]


class TrendPanel(Panel):
    """The trend of one of the machine's plots."""

    def __init__(self, place: int, *, plain: bool = False, id: str | None = None) -> None:  # noqa: A002
        """``place``: index among the plots of the machine, from 0."""
        super().__init__(id=id, classes="trend box")
        self.place, self.plain = place, plain
        self._plot: PlotView | None = None
        self._range = PlotRange()
        self._bins: Bins | None = None

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the plot, and show the present value in the title."""
        plots, columns = scene.machine.plots, scene.machine.trend
        plot = plots[self.place] if self.place < len(plots) else None
        value = scene.value(plot.key) if plot is not None else None
        if plot is None or value is None or plot.column not in columns:
            self.entitle("")
            return ["—"]
        if plot != self._plot:
            self._plot, self._range, self._bins = plot, PlotRange(least=plot.least), None
        canvas = Canvas(max(width - LABELS, 4), height, plain=self.plain)
        bins = self._take(scene, columns.index(plot.column), canvas.columns)
        known = [one for one in bins[-canvas.columns :] if one is not None]
        ends = [y for one in known for y in one] + ([value.setpoint] if value.setpoint is not None else [])
        wanted = "" if value.setpoint is None else f" ── SP {decimal(value.setpoint, value.decimals)}"
        self.entitle(f"{clean(value.label)} {decimal(value.value, value.decimals)}{wanted}")
        if not ends:
            return [("no data yet", FAINT)]
        scale = self._range
        scale.cover(min(ends), max(ends))
        for y, sign in ((value.low, LIMIT), (value.high, LIMIT), (value.band_low, "·"), (value.band_high, "·"),
                        (value.setpoint, WISH)):  # fmt: skip
            canvas.level(y, sign, scale)
        canvas.bins(bins, scale)
        return self._labelled(canvas.lines(), scale, faint=not scene.linked)

    def _take(self, scene: ScreenScene, column: int, count: int) -> list[Bin | None]:
        bins = self._bins
        if bins is None or bins.count != count or bins.epoch != scene.epoch:
            bins = self._bins = Bins(column, count, scene.epoch)
            for row in scene.trend:
                bins.take(row)
        elif scene.trend:
            bins.take(scene.trend[-1])
        return bins.bins

    @staticmethod
    def _labelled(lines: list[str], scale: PlotRange, *, faint: bool) -> Parts:
        digits = 0 if scale.high - scale.low >= 10.0 else 1 if scale.high - scale.low >= 1.0 else 2
        labels = {0: f"{scale.high:.{digits}f}", len(lines) - 1: f"{scale.low:.{digits}f}"}
        parts: Parts = []
        for at, line in enumerate(lines):
            text = f"{labels.get(at, ''):>{LABELS - 1}} "
            drawn: Part = (line, FAINT) if faint else line
            parts += ["\n" if at else "", (text, FAINT), drawn]
        return parts
