"""The axes of a condition: its setpoints, and their single wording for texts and columns.

An axis is a row of a kind's table, the table is an ``Axes``, and the state during a condition is a ``Setpoint``: the
compound and a value for each axis, looked up by the axis's name. Two conditions that differ in any axis read
differently everywhere, because every line, table and plot takes its words from here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Final, NamedTuple, TypeAlias, cast

AxisValue: TypeAlias = float | str
"""Value of an axis: a number in the axis's ``recipe_unit``, or a text."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis.

    ``name`` is its key in a recipe, in ``recipe_unit``; ``field`` its column in the record of a run, in the same unit,
    which ``scale`` converts to ``unit``, the unit for people. ``column`` is its column in the project's tables,
    ``header`` in the paper's table, ``title`` on a narrow screen. ``word`` comes before the value where the unit does
    not identify the axis. ``default`` is a value (in ``unit``) that needs no words and may be left out of a recipe;
    None: there is none. ``paper``: the paper's table has a column for it.
    """

    name: str
    recipe_unit: str
    field: str
    unit: str
    scale: float
    column: str
    header: str
    title: str
    word: str
    default: AxisValue | None
    paper: bool
    plotted: int = 0
    """Its rank for the abscissa of plots, lowest first; 0: never."""
    ge: float | None = None
    gt: float | None = None
    le: float | None = None
    """Range in any recipe, in ``recipe_unit``: at least, more than, at most."""
    choices: tuple[str, ...] = ()
    """The values of an axis that is not a number; without choices such an axis takes any name."""
    in_measure: bool = False
    """Whether a recipe sets it in ``measure``, for all grids without their own value."""
    limit: str = ""
    """Key of the rig's limit on it, such as ``limits.load``; "" where the kind defines the limit."""
    drive: str = ""
    """The rig's drive for it, such as ``axes.camber``, where a person may set it instead; only 0 is then possible
    without the drive. "" where a device always sets it."""

    @property
    def textual(self) -> bool:
        """Return whether the values are texts: one of ``choices``, or names, with a text as default."""
        return bool(self.choices) or isinstance(self.default, str)

    @property
    def recipe_default(self) -> AxisValue | None:
        """Return the default in ``recipe_unit``."""
        return self.default / self.scale if isinstance(self.default, float) else self.default

    def of(self, held: Setpoint) -> AxisValue:
        """Return the axis's value in ``unit``, without the noise of a float's last digits."""
        value = held.value(self.name)
        return value if isinstance(value, str) else round(self.scale * value, 6) + 0.0

    def number(self, held: Setpoint) -> float:
        """Return the axis's value in ``unit``; raises TypeError for an axis of texts."""
        return _number(self.of(held), self.name)

    def at_default(self, held: Setpoint) -> bool:
        """Return whether a condition needs no words for this axis."""
        return self.default is not None and self.of(held) == self.default

    def words(self, held: Setpoint) -> str:
        """Return the value with its unit, e.g. ``300 mm/s``, ``camber 5 deg``."""
        return f"{self.word} {plain(self.of(held))} {self.unit}".strip()


class Setpoint(NamedTuple):
    """The state during a condition: the compound, and a value for each axis of a table.

    A tuple: plans have tens of thousands of them and look conditions up by setpoint. ``values`` are in the order of
    ``Axes.nested``, which only ``Axes`` and ``value`` need to know.
    """

    compound: str
    values: tuple[AxisValue, ...]
    axes: Axes

    def value(self, name: str) -> AxisValue:
        """Return the value of an axis, in its ``recipe_unit``; raises KeyError."""
        return self.values[self.axes.places[name]]

    def number(self, name: str) -> float:
        """Return the value of a numeric axis; raises KeyError, and TypeError for an axis of texts."""
        return _number(self.value(name), name)

    def numbers(self) -> dict[str, float]:
        """Return the values of the numeric axes, in their ``recipe_unit``, by name."""
        return {axis.name: self.number(axis.name) for axis in self.axes if not axis.textual}

    def key(self, without: str = "") -> tuple[str, tuple[AxisValue, ...]]:
        """Return the compound and the values of the axes, as shown to people, except the axis ``without``."""
        return self.compound, tuple(axis.of(self) for axis in self.axes if axis.name != without)

    def but(self, compound: str | None = None, /, **values: AxisValue) -> Setpoint:
        """Return the setpoint with other values, by axis name; raises KeyError."""
        changed = list(self.values)
        for name, value in values.items():
            changed[self.axes.places[name]] = value
        return Setpoint(self.compound if compound is None else compound, tuple(changed), self.axes)


SURFACE: Final = "surface"
"""Name of the axis of a kind that changes the surface under the rubber."""


def surface_of(held: Setpoint) -> str:
    """Return the surface that a setpoint names, "" where it names none, or in a record without such an axis."""
    return str(held.value(SURFACE)) if SURFACE in held.axes.places else ""



class Axes:
    """A kind's table of axes, in the order of their words.

    ``blocks`` is the slowest axis: conditions are measured in blocks of one value of it, ascending; in a
    recipe's rows it is innermost. Tables with the same names in the same order are equal: a record's and its kind's.
    """

    __slots__ = ("blocks", "nested", "places", "table")

    def __init__(self, table: Iterable[Axis], blocks: str) -> None:
        """Make a table; raises ValueError for a repeated name, or if ``blocks`` is not in it."""
        self.table = tuple(table)
        self.blocks = blocks
        names = [axis.name for axis in self.table]
        if len(set(names)) < len(names) or blocks not in names:
            raise ValueError(f"axes {', '.join(names)}: each once, and {blocks} among them")
        self.nested = (*(name for name in names if name != blocks), blocks)
        """Names in the order in which a grid's values nest, which is the order of a setpoint's values."""
        self.places: Mapping[str, int] = {name: place for place, name in enumerate(self.nested)}

    def __iter__(self) -> Iterator[Axis]:
        return iter(self.table)

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, name: str) -> Axis:
        """Return the axis of a name; raises KeyError."""
        for axis in self.table:
            if axis.name == name:
                return axis
        raise KeyError(name)

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, Axes) and self.nested == other.nested)

    def __repr__(self) -> str:
        return f"Axes({', '.join(self.nested)})"

    def __hash__(self) -> int:
        return hash(self.nested)

    def __reduce__(self) -> tuple[type[Axes], tuple[tuple[Axis, ...], str]]:
        return Axes, (self.table, self.blocks)

    def setpoint(self, compound: str, /, **values: AxisValue) -> Setpoint:
        """Return a setpoint of values by axis name; missing axes are at their defaults. Raises KeyError."""
        unknown = values.keys() - self.places.keys()
        if unknown:
            raise KeyError(f"no axis {', '.join(sorted(unknown))} (expected {', '.join(self.nested)})")
        defaults = {axis.name: axis.recipe_default for axis in self.table if axis.recipe_default is not None}
        complete: Mapping[str, AxisValue] = defaults | values
        return Setpoint(compound, tuple(complete[name] for name in self.nested), self)

    def numbers_of(self, *names: str) -> Callable[[tuple[AxisValue, ...]], tuple[float, ...]]:
        """Return a fast getter of the numbers of these axes (two or more) from a setpoint's ``values``."""
        getter = itemgetter(*(self.places[name] for name in names))
        return cast("Callable[[tuple[AxisValue, ...]], tuple[float, ...]]", getter)

    def number_of(self, name: str) -> Callable[[tuple[AxisValue, ...]], float]:
        """Return a fast getter of the number of an axis from a setpoint's ``values``."""
        return cast("Callable[[tuple[AxisValue, ...]], float]", itemgetter(self.places[name]))

    def as_data(self) -> list[dict[str, object]]:
        """Return the table as plain data, from which ``axes_from`` makes a table with the same words.

        The ranges for recipes are left out: they do not describe setpoints.
        """
        rows: list[dict[str, object]] = []
        for axis in self.table:
            row: dict[str, object] = {name: getattr(axis, name) for name in WORDING}
            rows.append(row | {"choices": list(axis.choices), "blocks": axis.name == self.blocks})
        return rows

    def differing(self, conditions: Iterable[Setpoint]) -> tuple[Axis, ...]:
        """Return the axes in which conditions differ from each other."""
        listed = list(conditions)
        return tuple(axis for axis in self.table if len({axis.of(held) for held in listed}) > 1)

    def columns(self, conditions: Iterable[Setpoint]) -> tuple[Axis, ...]:
        """Return the axes that a table of these conditions needs: the paper's, and any other that is off its default.

        An axis that differs between them is off its default in one of them.
        """
        listed = list(conditions)
        return tuple(axis for axis in self.table if axis.paper or not all(axis.at_default(held) for held in listed))


WORDING = ("name", "recipe_unit", "field", "unit", "scale", "column", "header", "title", "word", "default", "paper",
        "plotted")  # fmt: skip
"""Fields of an axis that determine its words; with its choices and the axis of blocks, a table as plain data."""


def axes_from(rows: Iterable[Mapping[str, object]]) -> Axes:
    """Return a table from plain data (``Axes.as_data``); raises KeyError and ValueError for anything else."""
    listed = list(rows)
    table = [_axis_from(row) for row in listed]
    blocks = [axis.name for axis, row in zip(table, listed, strict=True) if row["blocks"]]
    return Axes(table, blocks[0] if blocks else "")


def _axis_from(row: Mapping[str, object]) -> Axis:
    text = {name: str(row[name]) for name in WORDING}
    scale, default, choices, plotted = row["scale"], row["default"], row["choices"], row["plotted"]
    if not isinstance(scale, int | float) or not isinstance(plotted, int) or not isinstance(choices, list | tuple):
        raise ValueError(f"no axis: {row}")
    known = default if isinstance(default, str) else float(default) if isinstance(default, int | float) else None
    listed = cast("Sequence[object]", choices)
    return Axis(
        text["name"], text["recipe_unit"], text["field"], text["unit"], float(scale), text["column"], text["header"],
        text["title"], text["word"], known, bool(row["paper"]), plotted, choices=tuple(map(str, listed)),
    )  # fmt: skip


def _number(value: AxisValue, name: str) -> float:
    if isinstance(value, str):
        raise TypeError(f"{name} is {value}, not a number")
    return value


def numbers(values: Iterable[AxisValue]) -> tuple[float, ...]:
    """Return the values of an axis of numbers; raises TypeError for a choice."""
    return tuple(_number(value, "the axis") for value in values)


def plain(value: AxisValue) -> str:
    """Return a setpoint as people write it: an integer where it is integral, else the shortest decimal."""
    if isinstance(value, str):
        return value
    return str(int(value)) if value == int(value) else repr(value)


def condition_words(held: Setpoint, axes: Sequence[Axis] | None = None, *, compound: bool = True) -> str:
    """Return a condition in words: ``1#, 300 mm/s, 200 N, sideslip 10 deg, 40 degC``.

    An axis at its default is left out. ``axes``: those that differ within a list of conditions, named for each even at
    their default.
    """
    named = [axis for axis in held.axes if not axis.at_default(held)] if axes is None else axes
    return ", ".join([*([held.compound] if compound else []), *(axis.words(held) for axis in named)])


class ListWords:
    """Wording of the conditions of one list: by their differences, which fit where the full words would not."""

    def __init__(self, conditions: Iterable[Setpoint]) -> None:
        """Find the differences; all conditions have the same axes."""
        listed = list(conditions)
        self.compound = len({held.compound for held in listed}) > 1
        self.first = listed[0] if listed else None
        self.axes = self.first.axes.differing(listed) if self.first is not None else ()

    def of(self, held: Setpoint) -> str:
        """Return the words that distinguish a condition from the others; all of them where it is the only one."""
        if not self.axes and not self.compound:
            return condition_words(held)
        return condition_words(held, self.axes, compound=self.compound)

    @property
    def common(self) -> str:
        """Return the words that all of them share, for the list's heading; "" where ``of`` already includes
        everything."""
        if self.first is None or not (self.axes or self.compound):
            return ""
        shared = [axis for axis in self.first.axes if axis not in self.axes and not axis.at_default(self.first)]
        return condition_words(self.first, shared, compound=not self.compound)
