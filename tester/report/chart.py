"""A figure as data: panels with series of points, bars and curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, NamedTuple

Look = Literal["measured", "published", "law", "left out", "limit"]
"""Style of a series: filled marks with bars; hollow marks; a line alone; crosses; a grey line alone."""


@dataclass(frozen=True, slots=True)
class Series:
    """Points of one look: ``style`` selects colour, mark and dash, the same for points that belong together."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    look: Look
    style: int
    bars: tuple[float, ...] = ()
    """Half the length of the bar at each point, NaN for none."""
    widths: tuple[float, ...] = ()
    """Half the extent of each point along x, such as its duration."""
    names: tuple[str, ...] = ()
    """Label of each point, in words, for drawings with tooltips; without it, its place on the axes."""


class Mark(NamedTuple):
    """A point of a series: its place, its bar, its extent along x and its label, as in Series."""

    x: float
    y: float
    bar: float | None = None
    width: float | None = None
    name: str = ""


def series_of(label: str, marks: Iterable[Mark], look: Look, style: int) -> Series:
    """Return the series of marks; all have a bar, a width or a name if the first does."""
    x, y, bars, widths, names = zip(*marks, strict=True)
    return Series(
        label, x, y, look, style,
        bars if bars[0] is not None else (), widths if widths[0] is not None else (), names if names[0] else (),
    )  # fmt: skip


class SecondScale(NamedTuple):
    """A scale on the other side of a pair of axes, for the same places in another unit."""

    label: str
    factor: float
    """Its number for 1 of the axis, above 0."""


@dataclass(frozen=True, slots=True)
class ChartPanel:
    """One pair of axes."""

    title: str
    series: tuple[Series, ...]
    y_label: str = ""
    """Label of its vertical axis, if other than the chart's."""
    x_label: str = ""
    """Label of its horizontal axis, if other than the chart's."""
    joined: bool = True
    """Whether a line joins measured points that no law goes through."""
    log_y: bool = False
    """Whether its vertical axis is logarithmic."""
    y_second: SecondScale | None = None
    """A further scale on its right."""


@dataclass(frozen=True, slots=True)
class Chart:
    """A figure of panels that share their axes. ``name`` is that of its file, ``note`` is printed below it."""

    name: str
    title: str
    x_label: str
    y_label: str
    panels: tuple[ChartPanel, ...]
    note: str = ""
    from_zero: bool = True
    """Whether the vertical axis begins at 0."""
    own_x: bool = False
    """Whether each panel has a horizontal axis of its own."""
    log_x: bool = False
    """Whether the horizontal axis is logarithmic."""
    stacked: bool = False
    """Whether panels are stacked, with a common horizontal axis and a vertical axis each."""
    x_second: SecondScale | None = None
    """A further scale at the top of each panel."""


@dataclass(frozen=True, slots=True)
class ChartSurface:
    """A coefficient over two axes, a panel for each table: ``values[j][i]`` belongs to ``x[i]`` and ``y[j]``, NaN for
    none."""

    name: str
    title: str
    x_label: str
    y_label: str
    z_label: str
    panels: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[tuple[float, ...], ...]], ...]
    note: str = ""
    x_second: SecondScale | None = None
    """A further scale at the top of each panel."""
    y_second: SecondScale | None = None
    """A further scale on the right of each panel."""


Figure = Chart | ChartSurface
