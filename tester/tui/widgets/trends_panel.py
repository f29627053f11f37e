"""Trends: ten minutes of one value, with its setpoint as it was, band and limits, and rig time below; the y range does
not jump.
"""

from __future__ import annotations

from dataclasses import dataclass

from tester.base.screen import PlotView, Value, setpoint_column
from tester.base.words import decimal, duration
from tester.service.protocol import SNAPSHOT_S, TREND_ROWS
from tester.tui.formatting import clean
from tester.tui.plot import BORDER, LIMIT, WISH, Bin, Canvas, PlotRange, labels_below
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import FAINT, Panel, Part, Parts

WINDOW_S = SNAPSHOT_S * TREND_ROWS
LABELS = 7
"""Width of the y labels, columns."""
AXIS_FROM, MIDDLE_FROM = 4, 6
"""Rows from which there is a time axis, and a label at half height."""
WALL, RIG = 0, 1
"""Columns of a trend's row: s since the service started, rig time of the run."""
Row = tuple[float | None, ...]


@dataclass(slots=True)
class TrendBin:
    """What a column of dots shows: least and greatest value, the last setpoint, the first rig time (s), and whether
    another run begins there, whose first rig time it then is.
    """

    ends: Bin | None = None
    setpoint: float | None = None
    t_s: float | None = None
    begins: bool = False

    def take(self, y: float | None, setpoint: float | None, t_s: float | None) -> None:
        """Include a row."""
        if y is not None:
            self.ends = (y, y) if self.ends is None else (min(self.ends[0], y), max(self.ends[1], y))
        self.setpoint = setpoint
        if self.t_s is None:
            self.t_s = t_s


class Bins:
    """The columns of dots of a window of time, updated with each new row of the trend."""

    def __init__(self, column: int, setpoint: int | None, count: int, epoch: int) -> None:
        """``column``, ``setpoint``: columns of the value and of its setpoint in the trend's rows; ``count``: number of
        intervals in the window.
        """
        self.column, self.setpoint, self.count, self.epoch = column, setpoint, count, epoch
        self.bins: list[TrendBin] = []
        self._first = 0
        self._seen = float("-inf")
        self._rig_s = float("-inf")

    def take(self, row: Row) -> None:
        """Include a row, if it is newer than those before."""
        wall_s = row[WALL]
        if wall_s is None or wall_s <= self._seen:
            return
        self._seen = wall_s
        slot = int(wall_s / WINDOW_S * self.count)
        if not self.bins:
            self._first = slot
        while self._first + len(self.bins) <= slot:
            if slot - self._first - len(self.bins) > self.count:
                self._first, self.bins = slot, []
            self.bins.append(TrendBin())
        t_s = row[RIG]
        self.bins[-1].take(row[self.column], row[self.setpoint] if self.setpoint is not None else None, t_s)
        if t_s is not None:
            if t_s < self._rig_s:  # rig time counts from the begin of each run
                self.bins[-1].begins, self.bins[-1].t_s = True, t_s
            self._rig_s = t_s
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
        axis = height >= AXIS_FROM
        canvas = Canvas(max(width - LABELS, 4), height - axis, plain=self.plain)
        bins = self._take(scene, plot.column, canvas.columns)[-canvas.columns :]
        self.entitle(_title(value))
        setpoints = [one.setpoint for one in bins]
        drawn = [y for one in bins for y in (one.ends or ())] + [y for y in setpoints if y is not None]
        if not drawn:
            return [("no data yet", FAINT)]
        scale = self._range
        scale.cover(min(drawn), max(drawn))
        for y, sign in ((value.low, LIMIT), (value.high, LIMIT), (value.band_low, "·"), (value.band_high, "·")):
            canvas.level(y, sign, scale)
        canvas.track(setpoints, WISH, scale)
        for at, one in enumerate(bins, canvas.columns - len(bins)):
            if one.begins:
                canvas.upright(at, BORDER)
        canvas.bins([one.ends for one in bins], scale)
        return [*_labelled(canvas.lines(), scale, faint=not scene.linked), *(_time_axis(bins, canvas) if axis else ())]

    def _take(self, scene: ScreenScene, column: str, count: int) -> list[TrendBin]:
        bins, columns = self._bins, scene.machine.trend
        if bins is None or bins.count != count or bins.epoch != scene.epoch:
            wanted = setpoint_column(columns, column)
            at = columns.index(wanted) if wanted else None
            bins = self._bins = Bins(columns.index(column), at, count, scene.epoch)
            for row in scene.trend:
                bins.take(row)
        elif scene.trend:
            bins.take(scene.trend[-1])
        return bins.bins


def _title(value: Value) -> str:
    unit = f" {clean(value.unit)}" if value.unit else ""
    wanted = "" if value.setpoint is None else f" {WISH}{WISH} SP {decimal(value.setpoint, value.decimals)}"
    return f"{clean(value.label)} {decimal(value.value, value.decimals)}{unit}{wanted}"


def _labelled(lines: list[str], scale: PlotRange, *, faint: bool) -> Parts:
    digits = 0 if scale.high - scale.low >= 10.0 else 1 if scale.high - scale.low >= 1.0 else 2
    last = len(lines) - 1
    labels = {0: f"{scale.high:.{digits}f}", last: f"{scale.low:.{digits}f}"}
    if last >= MIDDLE_FROM and last % 2 == 0:
        labels[last // 2] = f"{0.5 * (scale.low + scale.high):.{digits}f}"
    parts: Parts = []
    for at, line in enumerate(lines):
        text = f"{labels.get(at, ''):>{LABELS - 1}} "
        drawn: Part = (line, FAINT) if faint else line
        parts += ["\n" if at else "", (text, FAINT), drawn]
    return parts


def _time_axis(bins: list[TrendBin], canvas: Canvas) -> Parts:
    """Return the line below a trend: rig time at its ends and where a run begins, else in the middle."""
    first = canvas.columns - len(bins)
    known = {at: one.t_s for at, one in enumerate(bins, first) if one.t_s is not None}
    if not known:
        return []
    middle = min(known, key=lambda at: abs(2 * at - min(known) - max(known)))
    begun = [at for at, one in enumerate(bins, first) if one.begins and at in known]
    ticks = (min(known), max(known), *(begun or [middle]))
    texts = {(at if canvas.plain else at // 2): duration(known[at]) for at in reversed(ticks)}
    return ["\n", (f"{'rig':>{LABELS - 1}} {labels_below(texts, canvas.width)}", FAINT)]
