"""Plots in characters: a trend in braille dots (two by four in a cell) or, in ASCII, one sign in a cell; a scatter
plot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil, floor, log10

Bin = tuple[float, float]
"""Least and greatest value within one column of dots."""
BRAILLE = 0x2800
DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
"""Bits of a braille pattern by column and row (Unicode, block Braille Patterns)."""
WISH, LIMIT, BORDER = "╌", "─", "┆"
"""Signs of a setpoint, a limit, and a boundary between runs."""
SERIES = "●"
OTHER = "·"
"""Sign of a point that any other point may cover."""
BAR = "│"
"""Sign of a bar, which any point may cover."""
SHRINK = 4.0
"""A range narrows only when it is this many times wider than its content, so that it does not jump."""


@dataclass(slots=True)
class PlotRange:
    """The y range of a trend. It grows at once to round numbers, and shrinks only when it is much too wide."""

    low: float = 0.0
    high: float = 0.0
    least: float = 1.0
    """Least width of the range."""

    def cover(self, low: float, high: float) -> None:
        """Extend the range to these values."""
        if high - low < self.least:
            middle = 0.5 * (low + high)
            low, high = middle - 0.5 * self.least, middle + 0.5 * self.least
        width = self.high - self.low
        if low >= self.low and high <= self.high and width < SHRINK * (high - low):
            return
        step = round_step((high - low) / 4.0)
        self.low, self.high = step * floor(low / step), step * ceil(high / step)


def round_step(step: float) -> float:
    """Return the least of 1, 2, 5 times a power of ten that is not below ``step`` (> 0)."""
    power = 10.0 ** floor(log10(step))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= step * (1.0 - 1e-9))


@dataclass(slots=True)
class Canvas:
    """A grid of cells: data drawn in dots, and horizontal lines where there are no data."""

    width: int
    height: int
    plain: bool = False
    """Whether to use ASCII, with one dot in a cell."""
    _dots: list[list[int]] = field(default_factory=list[list[int]])
    _lines: dict[int, str] = field(default_factory=dict[int, str])
    _signs: dict[tuple[int, int], str] = field(default_factory=dict[tuple[int, int], str])
    """Signs in single cells, by row and column."""

    def __post_init__(self) -> None:
        """Begin empty."""
        self._dots = [[0] * self.width for _ in range(self.height)]

    @property
    def columns(self) -> int:
        """Return the number of columns of dots."""
        return self.width if self.plain else 2 * self.width

    def _row(self, y: float, scale: PlotRange) -> int:
        rows = self.height if self.plain else 4 * self.height
        share = (y - scale.low) / (scale.high - scale.low)
        return min(max(round((1.0 - share) * (rows - 1)), 0), rows - 1)

    def level(self, y: float | None, sign: str, scale: PlotRange) -> None:
        """Draw a horizontal line, if its value lies within the range."""
        if y is not None and scale.low <= y <= scale.high:
            row = self._row(y, scale)
            self._lines[row if self.plain else row // 4] = sign

    def track(self, levels: Sequence[float | None], sign: str, scale: PlotRange) -> None:
        """Draw a level that changes in the course of time, one for each column of dots, the last at the right edge."""
        shown = levels[-self.columns :]
        for at, y in enumerate(shown, self.columns - len(shown)):
            if y is not None and scale.low <= y <= scale.high:
                self._sign(self._row(y, scale), at, sign)

    def upright(self, at: int, sign: str) -> None:
        """Draw a vertical line through a column of dots."""
        for row in range(self.height):
            self._signs.setdefault((row, at if self.plain else at // 2), sign)

    def _sign(self, row: int, at: int, sign: str) -> None:
        self._signs[(row, at) if self.plain else (row // 4, at // 2)] = sign

    def bins(self, bins: Sequence[Bin | None], scale: PlotRange) -> None:
        """Draw the newest bins, with the last at the right edge."""
        shown = bins[-self.columns :]
        first = self.columns - len(shown)
        for at, ends in enumerate(shown, first):
            if ends is None:
                continue
            for row in range(self._row(ends[1], scale), self._row(ends[0], scale) + 1):
                if self.plain:
                    self._dots[row][at] = 1
                else:
                    self._dots[row // 4][at // 2] |= DOTS[at % 2][row % 4]

    def lines(self) -> list[str]:
        """Return the rows of characters."""
        rows: list[str] = []
        for number, row in enumerate(self._dots):
            empty = self._lines.get(number, " ")
            rows.append(
                "".join(
                    ("*" if self.plain else chr(BRAILLE + dots)) if dots else self._signs.get((number, column), empty)
                    for column, dots in enumerate(row)
                )
            )
        return rows


@dataclass(frozen=True, slots=True)
class Point:
    """One point of a scatter plot, with its sign, and half the length of its upright bar."""

    x: float
    y: float
    sign: str
    half: float = 0.0


def scatter(points: Sequence[Point], width: int, height: int, decimals: int = 2) -> list[str]:
    """Return points in a frame of axes, ``width`` by ``height`` characters; coinciding points show as ``+``."""
    margin = 7
    inner, rows = width - margin - 1, height - 2
    if inner < 4 or rows < 2 or not points:
        return []
    xs, ys = PlotRange(least=1e-6), PlotRange(least=0.02)
    xs.low, xs.high = min(p.x for p in points), max(p.x for p in points)
    if xs.high <= xs.low:
        xs.low, xs.high = xs.low - 1.0, xs.high + 1.0
    ys.cover(min(p.y - p.half for p in points), max(p.y + p.half for p in points))
    grid = [[" "] * inner for _ in range(rows)]

    def across(p: Point) -> int:
        return round((p.x - xs.low) / (xs.high - xs.low) * (inner - 1))

    def down(y: float) -> int:
        return round((ys.high - y) / (ys.high - ys.low) * (rows - 1))

    for p in points:
        for row in range(down(p.y + p.half), down(p.y - p.half) + 1) if p.half else ():
            grid[row][across(p)] = BAR
    for p in points:
        there = grid[down(p.y)][across(p)]
        if p.sign != OTHER or there == " ":
            grid[down(p.y)][across(p)] = p.sign if there in (" ", OTHER, BAR, p.sign) else "+"
    labels = {0: f"{ys.high:.{decimals}f}", rows - 1: f"{ys.low:.{decimals}f}"}
    if rows >= 9 and rows % 2:
        labels[rows // 2] = f"{0.5 * (ys.low + ys.high):.{decimals + 1}f}"
    lines = [f"{labels.get(n, ''):>{margin}}│{''.join(row)}" for n, row in enumerate(grid)]
    lines.append(" " * margin + "└" + "─" * inner)
    at = {round((x - xs.low) / (xs.high - xs.low) * (inner - 1)): f"{x:g}" for x in {p.x for p in points}}
    lines.append(" " * (margin + 1) + labels_below(at, inner))
    return lines


def labels_below(at: dict[int, str], width: int) -> str:
    """Return the texts below their columns as far as there is room. The first and the last have priority over those
    between.
    """
    line = [" "] * width
    columns = sorted(at)
    for column in dict.fromkeys((columns[0], columns[-1], *columns)):
        text = at[column]
        first = min(max(column - len(text) // 2, 0), width - len(text))
        if first >= 0 and not "".join(line[max(first - 1, 0) : first + len(text) + 1]).strip():
            line[first : first + len(text)] = text
    return "".join(line).rstrip()
