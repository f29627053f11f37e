"""A figure as data, before anything is drawn: panels with series of points, bars and curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Look = Literal["measured", "published", "law", "left out", "limit"]
"""How a series is drawn: filled marks with bars; hollow marks; a line alone; crosses; a grey line alone."""


@dataclass(frozen=True, slots=True)
class Series:
    """Points of one look: ``style`` is the place of colour, mark and dash, the same for what belongs together."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    look: Look
    style: int
    bars: tuple[float, ...] = ()
    """Half the length of the bar at each point, NaN for none."""
    widths: tuple[float, ...] = ()
    """Half the extent of each point along x, such as of the time that it took."""
    names: tuple[str, ...] = ()
    """Of each point, in words, where a drawing can name what a pointer is on; none: by its place on the axes."""


@dataclass(frozen=True, slots=True)
class ChartPanel:
    """One pair of axes."""

    title: str
    series: tuple[Series, ...]
    y_label: str = ""
    """Of its upright axis, where it is not the chart's."""
    x_label: str = ""
    """Of its axis along, where it is not the chart's."""
    joined: bool = True
    """Whether measured points that no law goes through are joined by a line."""


@dataclass(frozen=True, slots=True)
class Chart:
    """A figure of panels that share their axes. ``name`` is that of its file, ``note`` stands below it."""

    name: str
    title: str
    x_label: str
    y_label: str
    panels: tuple[ChartPanel, ...]
    note: str = ""
    from_zero: bool = True
    """Whether the upright axis begins at 0."""
    own_x: bool = False
    """Whether each panel has an axis along of its own."""
    log_x: bool = False
    """Whether the axis along is logarithmic."""
    stacked: bool = False
    """Whether panels stand one above the other, with the axis along in common and each with its own upright."""


@dataclass(frozen=True, slots=True)
class ChartSurface:
    """A coefficient over two axes, a panel a table: ``values[j][i]`` belongs to ``x[i]`` and ``y[j]``, NaN for none."""

    name: str
    title: str
    x_label: str
    y_label: str
    z_label: str
    panels: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[tuple[float, ...], ...]], ...]
    note: str = ""


Figure = Chart | ChartSurface
