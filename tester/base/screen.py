"""Screen content for a kind of machine, and its manual controls: plain values, types only.

The tables belong to the kind (``tester/kinds/<kind>/screen``). A service sends them to its clients, so that a client
draws any kind; values that change from scan to scan are sent separately, four times a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tester.base.axes import Axes
from tester.base.quantities import Quantities

Quality = Literal["good", "stale", "bad", "none"]
"""good; older than its limit; reported invalid by its device; never received."""


@dataclass(frozen=True, slots=True)
class Value:
    """One measured value beside its setpoint and its limits.

    ``key``, ``label``, ``unit``, ``decimals`` and the ends of a bar (``scale_low``, ``scale_high``), fixed for a rig,
    are those of a channel in the kind's table. ``low``, ``high``: thresholds of an interlock, or hard limits of the
    rig. ``band_low``, ``band_high``: the gate around the setpoint, inside which samples count.
    """

    key: str
    label: str
    unit: str
    value: float | None
    setpoint: float | None
    low: float | None
    high: float | None
    band_low: float | None
    band_high: float | None
    scale_low: float
    scale_high: float
    decimals: int
    age_s: float | None
    quality: Quality


@dataclass(frozen=True, slots=True)
class Gate:
    """One gate of the samples: ``open`` while samples pass it."""

    key: str
    open: bool


@dataclass(frozen=True, slots=True)
class SoakView:
    """A soak in progress: 39.6 of 40.0 +- 1.0 degC, in band 190 s of 600 s, given up after ``at_most_s``."""

    surface_c: float | None
    target_c: float
    within_k: float
    in_band_s: float
    for_s: float
    waited_s: float
    at_most_s: float


@dataclass(frozen=True, slots=True)
class Check:
    """One line of the pre-flight list: ``ok`` None where the rig must be connected first."""

    name: str
    ok: bool | None
    text: str


@dataclass(frozen=True, slots=True)
class PlotView:
    """A plotted trend: the value, its column in the trend, the narrowest range, in its unit."""

    key: str
    column: str
    least: float


@dataclass(frozen=True, slots=True)
class HandAxis:
    """A manual movement: its name in ``jog``, its title, its step and its condition in words."""

    name: str
    title: str
    step: str


@dataclass(frozen=True, slots=True)
class AxisView:
    """An axis of a condition: key in a recipe, unit for people, column in tables, title, word before its number.

    A value equal to ``default`` needs no words; None: there is none.
    """

    name: str
    unit: str
    column: str
    title: str
    word: str
    default: float | str | None


@dataclass(frozen=True, slots=True)
class Shape:
    """One part of a drawing, in its units.

    ``points``: of a line x, y of each corner; of a box left, top, width, height, radius of its corners; of a circle x
    and y of its centre, radius; of a text x and y of its start. ``text``: that of a text. ``role``: a part of the
    machine (body), the part that is tested (rubber), what it touches (surface), an arrow of a force or a movement
    (arrow), an enclosure (shell).
    """

    form: Literal["line", "box", "circle", "text"]
    points: tuple[float, ...]
    role: Literal["body", "rubber", "surface", "arrow", "shell"] = "body"
    text: str = ""


@dataclass(frozen=True, slots=True)
class Anchor:
    """The place of a value in a drawing: its key, and where its text begins, is centred or ends."""

    key: str
    x: float
    y: float
    side: Literal["start", "middle", "end"] = "start"


@dataclass(frozen=True, slots=True)
class Drawing:
    """A machine seen from the side, as data: size, the same in words, shapes, places of values."""

    width: float
    height: float
    text: str
    shapes: tuple[Shape, ...]
    anchors: tuple[Anchor, ...]


@dataclass(frozen=True, slots=True)
class MachineView:
    """Constants of a kind of machine, for clients that draw it.

    ``trend``: columns of a row of the trend; the first two are seconds, of the service and of the run, a column with
    ``_setpoint`` in it is a setpoint. ``plots``: trends to plot, the most important first. ``by_hand``: keys of the
    values for manual movement, ``hand``: the manual movements.
    """

    kind: str
    trend: tuple[str, ...]
    plots: tuple[PlotView, ...] = ()
    by_hand: tuple[str, ...] = ()
    hand: tuple[HandAxis, ...] = ()
    axes: tuple[AxisView, ...] = ()
    specimen: str = "specimen"
    """Name for people of the part that wears and is changed."""
    moves: str = "the machine"
    """The part that turns or travels, and must be seen at standstill."""
    look: tuple[str, ...] = ()
    """Further checks by a person at a machine without a controller, a sentence each."""
    ring: str = ""
    """Name for people of the slip ring to a device on a turning part; "" where there is none."""
    drawing: Drawing | None = None
    """The machine with the places of its values; None: a client lists the values instead."""


def axis_views(axes: Axes) -> tuple[AxisView, ...]:
    """Return a table of axes in the form for screens."""
    return tuple(AxisView(axis.name, axis.unit, axis.column, axis.title, axis.word, axis.default) for axis in axes)


UNKNOWN = MachineView("", ("wall_s", "t_s"))
"""A machine before its description has arrived."""


def trend_columns(quantities: Quantities) -> tuple[str, ...]:
    """Return the columns of a trend's row.

    ``wall_s``: s since the service started, ``t_s``: rig time of the run, then those that the table names, each value
    before its setpoint, the most important first.
    """
    columns = ["wall_s", "t_s"]
    for channel in quantities.shown:
        if channel.screen is not None:
            columns += [column for column in (channel.screen.trend, channel.screen.setpoint_trend) if column]
    return tuple(columns)


def setpoint_column(columns: tuple[str, ...], column: str) -> str:
    """Return the column of a trend that holds the setpoint of the value in ``column``; "" if there is none.

    It follows its value's column and has ``setpoint`` in its name.
    """
    at = columns.index(column) + 1
    return columns[at] if at < len(columns) and "setpoint" in columns[at] else ""
