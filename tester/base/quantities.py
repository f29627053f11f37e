"""Quantities: the channels of a kind of rig, in one ordered table for all code.

Every channel of the table is sampled, stored, averaged, exported and shown; no other list or order of channels exists.
This module defines the types. Each kind has its own table, to which the further sensors of a rig add rows
(tester.inputs.rig.further_sensors). A run's record keeps a copy of it, so that a stored run can be read without its
kind.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

_NAN: Final = float("nan")

TIME: Final = "time_s"
"""Channel of the rig time, s: the first of every table."""
GATE: Final = "gate"
"""Channel of the closed gates, a mask: 0 = the sample is accepted."""
BURST: Final = "burst"
"""Channel that counts the contacts within a repeat; 0 = outside a burst."""
KEY: Final = "repeat_key"
"""Channel of the repeat's row in the store, 0 = none."""
LAST: Final = (GATE, BURST, KEY)
"""The last channels of a sample, which the scan itself sets."""
FURTHER: Final = "readings.channels"
"""Source of the channels of a rig's further sensors; ``readings.channels.0`` is the first. They are in that order,
before the last three."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A number for a screen: ``scale`` times a key of the rig file, plus ``offset``; without a key the offset alone.

    ``key`` is dotted (``limits.load_n``); a number in it is a position in a list. ``otherwise`` replaces a key that the
    rig file leaves empty.
    """

    key: str = ""
    scale: float = 1.0
    offset: float = 0.0
    otherwise: float | None = None

    def of(self, rig: object) -> float:
        """Return the number for a rig; raises AttributeError for a key that rigs do not have."""
        node: Any = rig
        for part in self.key.split(".") if self.key else ():
            if node is None:
                break
            node = node[int(part)] if part.isdigit() else getattr(node, part)
        if node is None and self.otherwise is not None:
            return self.otherwise
        return self.offset + (self.scale * node if self.key and isinstance(node, int | float) else 0.0)


@dataclass(frozen=True, slots=True)
class Screen:
    """Appearance of a channel on screens and in the protocol; all numbers in the unit for people.

    ``key`` is its name there, ``rank`` its row, from 1 (low screens leave out the last). ``device`` is the source of
    its data, whose age is the channel's. ``low`` and ``high`` are the ends of its bar. ``limit`` is the threshold of an
    interlock or a hard limit of the rig; ``both``: its negative is a limit as well.
    """

    key: str
    rank: int
    device: str
    low: Figure
    high: Figure
    limit: Figure | None = None
    both: bool = False
    watched: bool = False
    """Whether an alarm reports missing data."""
    setpoint: str = ""
    """Channel that records its setpoint."""
    axis: str = ""
    """Axis of a condition with its setpoint."""
    trend: str = ""
    """Its column in the trend, with the unit for people; "" = none."""
    setpoint_trend: str = ""
    """Column of its setpoint in the trend; "" = none."""
    lower: Figure | None = None
    """The lower threshold, where it is not the negative of ``limit``."""
    optional: bool = False
    """Whether rigs without ``device`` leave the channel out of their screens."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One quantity.

    ``name`` is its column in samples and in the store, with its unit (``force_z_n``); ``unit`` that unit for people,
    ``label`` its name for people. ``source`` is where the scan reads it: the path from the run's context
    (``readings.force_z_n``, ``demand.load_n``, ``setpoints.hub_c``, ``gate``), a number in it a position in a list, a
    name in brackets at its end (``readings.positions[lift]``) a key of a mapping; "" = it is not recorded but computed
    for screens.

    ``mean`` is its place among the means over a block, from 1, and so among the measured columns of the results'
    tables; 0 = it is not averaged. Where the unit for people differs from the recorded one, ``shown_unit`` is that
    unit, ``scale`` converts values to it and ``column`` is the name with it.
    """

    name: str
    unit: str
    label: str
    source: str
    mean: int = 0
    decimals: int = 3
    whole: bool = False
    """Whether its values are whole numbers."""
    column: str = ""
    shown_unit: str = ""
    scale: float = 1.0
    screen: Screen | None = None

    @property
    def read_as(self) -> str:
        """Return the unit for people."""
        return self.shown_unit or self.unit

    @property
    def measured_column(self) -> str:
        """Return the column of its mean in the results' tables."""
        return f"measured_{self.column or self.name}"

    def scaled(self, value: float | None) -> float | None:
        """Return a value in the unit for people."""
        return value if value is None or self.scale == 1.0 else self.scale * value


@dataclass(frozen=True, slots=True)
class Roles:
    """Channels that the analysis uses.

    ``friction``: the horizontal force along the sliding, and the one across it where it is measured (N). ``normal``:
    the pressing force (N). ``turn``: the position that counts blocks, a whole turn, a length of travel or a time, and
    ``block`` the size of a block, in its unit. ``temperature``: of the rubber's surface (degC), on which friction
    depends, and ``sliding`` the sliding speed (m/s); ``depth``: how far the rubber is pressed in, from any zero
    (mm), and ``core`` the temperature behind the rubber (degC); "" where it is not measured.
    """

    friction: tuple[str, ...]
    normal: str
    turn: str
    block: float = 1.0
    temperature: str = ""
    sliding: str = ""
    depth: str = ""
    core: str = ""


class Quantities:
    """An immutable, ordered table of channels, with look-ups."""

    __slots__ = ("_index", "averaged", "channels", "further", "names", "recorded", "roles", "shown")

    def __init__(self, channels: tuple[Channel, ...], roles: Roles) -> None:
        """Store the table; raises ValueError for an invalid one."""
        self.channels: Final = channels
        self.roles: Final = roles
        self.recorded: Final = tuple(channel for channel in channels if channel.source)
        """The channels of a sample, in order."""
        self.names: Final = tuple(channel_.name for channel_ in self.recorded)
        """The columns of a sample, all float64, in order."""
        self.averaged: Final = tuple(
            sorted((channel_ for channel_ in self.recorded if channel_.mean), key=lambda channel_: channel_.mean)
        )
        """The channels that a block averages, in the order of the results' tables."""
        self.further: Final = tuple(channel_ for channel_ in self.recorded if channel_.source.startswith(f"{FURTHER}."))
        """The channels of a rig's further sensors, in order."""
        ranked = [(channel.screen.rank, channel) for channel in channels if channel.screen is not None]
        self.shown: Final = tuple(channel_ for _, channel_ in sorted(ranked, key=lambda pair: pair[0]))
        """The channels of the screens, the most important first."""
        self._index: Final = {name: i for i, name in enumerate(self.names)}
        self._check()

    def _check(self) -> None:
        means = {quantity.name for quantity in self.averaged}
        roles = self.roles
        wanted = {*roles.friction, roles.normal, roles.temperature, roles.sliding} - {""}
        if len({channel.name for channel in self.channels}) != len(self.channels):
            raise ValueError("two channels of one name")
        if strange := [channel.name for channel in self.channels if not channel.name.isidentifier()]:
            raise ValueError(f"a channel's name is letters, digits and _: {strange}")
        if self.names[:1] != (TIME,) or self.names[-3:] != LAST:
            raise ValueError(f"a sample begins with {TIME} and ends with {', '.join(LAST)}: {self.names}")
        if self.recorded[-len(LAST) - len(self.further) : -len(LAST)] != self.further:
            raise ValueError(f"further channels stand before {', '.join(LAST)}: {self.names}")
        if lacking := {roles.depth, roles.core} - {"", *self.names}:
            raise ValueError(f"depth and core are recorded channels: {sorted(lacking)}")
        if roles.turn not in self._index:
            raise ValueError(f"blocks are counted by {roles.turn}, which is not recorded")
        if missing := wanted - means:
            raise ValueError(f"the analysis needs means of channels that are not averaged: {sorted(missing)}")

    def __iter__(self) -> Iterator[Channel]:
        """Yield the channels in order."""
        return iter(self.channels)

    def __getitem__(self, name: str) -> Channel:
        """Return the channel of that name; raises KeyError."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        raise KeyError(name)

    def __deepcopy__(self, memo: dict[int, object]) -> Quantities:
        """Return itself: it is immutable."""
        return self

    def index(self, name: str) -> int:
        """Return the position of a channel in a sample; raises KeyError."""
        return self._index[name]

    def fitted_with(self, devices: Container[str]) -> Quantities:
        """Return the table of a rig with these devices: no screen of it shows a channel whose device is missing."""

        def fitted(channel: Channel) -> Channel:
            screen = channel.screen
            there = screen is None or not screen.optional or screen.device in devices
            return channel if there else replace(channel, screen=None)

        channels = tuple(map(fitted, self.channels))
        return self if channels == self.channels else Quantities(channels, self.roles)

    def with_further(self, channels: Sequence[Channel]) -> Quantities:
        """Return the table of a rig with these further channels; raises ValueError for an invalid one."""
        at = next(place for place, channel in enumerate(self.channels) if channel.name == LAST[0])
        return Quantities((*self.channels[:at], *channels, *self.channels[at:]), self.roles) if channels else self


class Means(Mapping[str, float]):
    """Means of the averaged channels, over a block, a repeat or a condition: by name, and by their roles.

    NaN for channels that were not measured. Without a table it is empty.
    """

    __slots__ = ("_given", "table")

    def __init__(self, table: Quantities | None = None, given: Iterable[float] = ()) -> None:
        """``given``: a value for each of the table's averaged channels, in order; raises ValueError."""
        self.table: Final = table
        names = (quantity.name for quantity in table.averaged) if table is not None else ()
        self._given: Final = dict(zip(names, given, strict=True))

    def __getitem__(self, name: str) -> float:
        """Return the mean of a channel; raises KeyError."""
        return self._given[name]

    def __iter__(self) -> Iterator[str]:
        """Yield the names, in order."""
        return iter(self._given)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._given)

    def __hash__(self) -> int:
        """Return a hash: means are immutable."""
        return hash(tuple(self._given.items()))

    def __repr__(self) -> str:
        """Return them with their names."""
        return f"Means({self._given})"

    def _role(self, name: str) -> float:
        return self._given.get(name, _NAN)

    @property
    def along(self) -> float:
        """Return the friction force along the sliding, N."""
        return self._role(self.table.roles.friction[0]) if self.table is not None else _NAN

    @property
    def across(self) -> float:
        """Return the horizontal force across it, N; 0 where it is not measured."""
        if self.table is None:
            return _NAN
        return self._role(self.table.roles.friction[1]) if len(self.table.roles.friction) > 1 else 0.0

    @property
    def normal(self) -> float:
        """Return the pressing force, N."""
        return self._role(self.table.roles.normal) if self.table is not None else _NAN

    @property
    def temperature(self) -> float:
        """Return the temperature of the rubber's surface, degC."""
        return self._role(self.table.roles.temperature) if self.table is not None else _NAN

    @property
    def sliding(self) -> float:
        """Return the sliding speed, m/s."""
        return self._role(self.table.roles.sliding) if self.table is not None else _NAN


def mean_of(parts: Iterable[Means]) -> Means:
    """Return the mean of at least one ``Means``, each of equal weight."""
    listed = list(parts)
    columns = zip(*(means.values() for means in listed), strict=True)
    return Means(listed[0].table, [sum(column) / len(column) for column in columns])


def temperatures(parts: Iterable[Means]) -> list[float]:
    """Return the surface temperatures of means, degC; zeros where the table has none: nothing depends on it then."""
    return [block.temperature if block.table is None or block.table.roles.temperature else 0.0 for block in parts]
