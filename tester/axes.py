"""The axes of a condition: what is held while it is measured, and the one way to say it in words and columns.

Two conditions that differ in any axis read differently everywhere, because every line, table and plot asks here.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Protocol


class Held(Protocol):
    """What is held during a condition, in the units of the names; a plan's setpoint and a stored condition are one."""

    @property
    def compound(self) -> str:
        """Name of the rubber."""
        ...

    @property
    def slip_velocity_m_s(self) -> float:
        """Wheel speed less belt speed at no sideslip, m/s."""
        ...

    @property
    def load_n(self) -> float:
        """Normal load, N."""
        ...

    @property
    def sideslip_deg(self) -> float:
        """Angle of the wheel's plane to the belt's travel, degrees."""
        ...

    @property
    def camber_deg(self) -> float:
        """Tilt of the wheel's plane, degrees."""
        ...

    @property
    def temperature_c(self) -> float:
        """Temperature of the surface, degC."""
        ...

    @property
    def wheel_speed_m_s(self) -> float:
        """Line speed of the wheel, m/s."""
        ...


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis.

    ``name`` is its key in a recipe, in ``recipe_unit``; ``field`` its attribute of ``Held``, which ``scale`` turns into
    ``unit``, as people read it. ``column`` is its column in the project's tables, ``header`` in the paper's table,
    ``title`` on a narrow screen. ``word`` stands before the number where the unit does not tell which axis it is.
    ``default`` is a value that needs no words; None: there is none. ``paper``: the paper's table has a column for it.
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
    default: float | None
    paper: bool

    def of(self, held: Held) -> float:
        """Return the axis's value in ``unit``, without the noise of a float's last digits."""
        value: float = getattr(held, self.field)
        return round(self.scale * value, 6) + 0.0

    def at_default(self, held: Held) -> bool:
        """Tell whether a condition needs no words for this axis."""
        return self.default is not None and self.of(held) == self.default

    def words(self, held: Held) -> str:
        """Return the value with its unit, e.g. ``300 mm/s``, ``camber 5 deg``."""
        return f"{self.word} {plain(self.of(held))} {self.unit}".lstrip()


AXES: Final[tuple[Axis, ...]] = (
    Axis("slip_velocity", "m/s", "slip_velocity_m_s", "mm/s", 1e3, "slip_velocity_mm_s", "Slip Velocity /mm·s⁻¹",
         "Slip mm/s", "", None, True),
    Axis("load", "N", "load_n", "N", 1.0, "load_n", "Load /N", "Load N", "", None, True),
    Axis("sideslip", "deg", "sideslip_deg", "deg", 1.0, "sideslip_deg", "Sideslip Angle /°", "Angle °", "sideslip",
         0.0, True),
    Axis("camber", "deg", "camber_deg", "deg", 1.0, "camber_deg", "Camber Angle /°", "Camber °", "camber", 0.0, False),
    Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "", None,
         True),
    Axis("wheel_speed", "m/s", "wheel_speed_m_s", "m/s", 1.0, "wheel_speed_m_s", "Wheel Speed /m·s⁻¹", "Wheel m/s",
         "wheel", 0.8, False),
)  # fmt: skip
"""All axes in the order in which they are told. The paper held the wheel at 0.8 m/s and without camber throughout."""


def axis(name: str) -> Axis:
    """Return the axis of a recipe's key; raises KeyError."""
    for one in AXES:
        if one.name == name:
            return one
    raise KeyError(name)


def plain(value: float) -> str:
    """Return a setpoint as people write it: an integer where it is integral, else the shortest decimal."""
    return str(int(value)) if value == int(value) else repr(value)


def condition_words(held: Held, axes: Sequence[Axis] | None = None, *, compound: bool = True) -> str:
    """Return a condition in words: ``1#, 300 mm/s, 200 N, sideslip 10 deg, 40 degC``.

    An axis at its default is left out, any other is told. In a list of conditions ``axes`` says which are told of each,
    at their default or not: those in which they differ.
    """
    told = [one for one in AXES if not one.at_default(held)] if axes is None else axes
    return ", ".join([*([held.compound] if compound else []), *(one.words(held) for one in told)])


def differing(conditions: Iterable[Held]) -> tuple[Axis, ...]:
    """Return the axes in which conditions differ from each other."""
    listed = list(conditions)
    return tuple(one for one in AXES if len({one.of(held) for held in listed}) > 1)


class ListWords:
    """How the conditions of one list are told: by what differs between them, which fits where all of it would not."""

    def __init__(self, conditions: Iterable[Held]) -> None:
        """Find out what differs."""
        listed = list(conditions)
        self.compound = len({held.compound for held in listed}) > 1
        self.axes = differing(listed)
        self.first = listed[0] if listed else None

    def of(self, held: Held) -> str:
        """Return what tells a condition from the others; all of it where it is the only one."""
        if not self.axes and not self.compound:
            return condition_words(held)
        return condition_words(held, self.axes, compound=self.compound)

    @property
    def common(self) -> str:
        """What all of them share, for the list's heading; "" where ``of`` tells everything."""
        if self.first is None or not (self.axes or self.compound):
            return ""
        shared = [one for one in AXES if one not in self.axes and not one.at_default(self.first)]
        return condition_words(self.first, shared, compound=not self.compound)


def columns(conditions: Iterable[Held]) -> tuple[Axis, ...]:
    """Return the axes that a table of these conditions needs: the paper's, and any other that is off its default.

    An axis that differs between them is off its default in one of them.
    """
    listed = list(conditions)
    return tuple(one for one in AXES if one.paper or not all(one.at_default(held) for held in listed))
