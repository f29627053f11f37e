"""How far each safety key of a rig file may be loosened: its direction, its hardest value, and why there.

An interlock's parameter holds its own ceiling (tester.inputs.rig.parameter); a kind lists its other keys
(``Rig.ceilings``). A looser value is a risk that a person has to accept in words (tester.inputs.rig.load).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, Final, cast

from drivers.canopen.dictionary import PRODUCT_CODE, VENDOR_ID
from tester.base.config_reader import key_of
from tester.base.units import parse
from tester.inputs.rig.parameter import Direction, Parameter

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from tester.inputs.rig.config import Rig

LOWER, HIGHER = Direction.LOWER, Direction.HIGHER
TRUE: Final = "true"
"""Hardest value of a switch that may not be off."""
AXES: Final = "axes.*."
_SAID_ONCE = {"heartbeat": "drive_heartbeat", "consumer_heartbeat": "consumer_heartbeat"}
"""Keys of an axis that the section ``can`` says for all: a risk is told once."""


@dataclass(frozen=True, slots=True)
class Ceiling:
    """A key of the rig file on which safety hangs. ``*`` in it stands for every axis that has a drive."""

    key: str
    unit: str
    """"" for a switch. The bare numbers of an axis count in its own unit: they have none of their own either."""
    direction: Direction
    """Which way is tighter; of a switch, true is the higher value."""
    hardest: str
    """The loosest value that is accepted, as text like that of the rig file."""
    because: str
    zero_is_off: bool = False
    """0 switches the watch off: looser than any other value."""

    @property
    def limit(self) -> float:
        """The hardest value in the key's unit; 1 for "true"."""
        return 1.0 if self.hardest == TRUE else parse(self.hardest, self.unit or "1")

    def looser(self, value: float, limit: float) -> bool:
        """Tell whether a value is looser than a limit; what is not a number is."""
        if self.zero_is_off and value == 0.0:
            return limit != 0.0
        if self.zero_is_off and limit == 0.0:
            return value != value
        return not (value <= limit) if self.direction is LOWER else not (value >= limit)

    def text(self, value: float) -> str:
        """Return a value as the rig file writes it."""
        if self.hardest == TRUE:
            return TRUE if value else "false"
        return f"{value:g} {self.unit}".removesuffix(" 1").rstrip()


def ceilings_of(section: str, parameters: Iterable[Parameter]) -> tuple[Ceiling, ...]:
    """Return the ceilings that the parameters of a section declare themselves."""
    return tuple(
        Ceiling(f"{section}.{one.key}", "" if one.unit == "1" else one.unit, one.direction, one.hardest, one.because)
        for one in parameters
        if one.hardest
    )


def ceiling_table(ceilings: Iterable[Ceiling]) -> str:
    """Return every safety key with its direction, its hardest value and the reason as Markdown, a line each."""
    lines = ["| key | tighter is | not looser than | because |", "|---|---|---|---|"]
    lines += [f"| {one.key} | {one.direction.value} | {one.hardest} | {one.because} |" for one in ceilings]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True)
class Risk:
    """A value of a rig that is looser than it may be without somebody's word for it."""

    ceiling: Ceiling
    location: tuple[str, ...]
    value: float
    limit: float

    @property
    def key(self) -> str:
        """The key, as it stands in the rig file."""
        return ".".join(self.location)

    def __str__(self) -> str:
        """Say key, value and limit."""
        return f"{self.key} {self.compared}"

    @property
    def compared(self) -> str:
        """Say value and limit."""
        one = self.ceiling
        hardest = f" and than {one.hardest}" if one.looser(self.value, one.limit) and self.limit != one.limit else ""
        return f"{one.text(self.value)} is looser than {one.text(self.limit)}{hardest}"


def counts_as_simulated(rig: Rig) -> bool:
    """Tell whether nobody can be hurt at a rig: it is simulated in this process, or behind a door.

    A rig behind a door is one whose every drive has to report the simulator's identity (0x1018). It is compared at
    every connect, before anything moves: with other drives on the wire nothing begins.
    """
    ids = {(drive.vendor_id, drive.product_code) for drive in rig.drives().values()}
    return rig.simulated or ids == {(VENDOR_ID, PRODUCT_CODE)}


def loosened(rig: Rig, than: Rig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser in one rig than in another; axes that only one has are left out."""
    found: list[Risk] = []
    for one, location, value in _values(rig):
        limit = value_at(than, location)
        if limit is not None and one.looser(value, limit):
            found.append(Risk(one, location, value, limit))
    return tuple(found)


def beyond(rig: Rig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser than their hardest values."""
    return tuple(
        Risk(one, location, value, one.limit) for one, location, value in _values(rig) if one.looser(value, one.limit)
    )


def _values(rig: Rig) -> Iterator[tuple[Ceiling, tuple[str, ...], float]]:
    """Yield every safety key that a rig has, with its place and its value (1 and 0 of a switch)."""
    for one in rig.ceilings:
        names = rig.drives() if "*" in one.key else ("",)
        for name in names:
            location = tuple(one.key.replace("*", name).split("."))
            value = value_at(rig, location)
            said = value_at(rig, ("can", _SAID_ONCE.get(location[-1], ""))) if name else None
            if value is not None and value != said:
                yield one, location, value


def value_at(rig: Rig, location: tuple[str, ...]) -> float | None:
    """Return the value at a place of the file, None where the rig has no such axis."""
    found: Any = rig
    for key in location:
        if isinstance(found, Mapping):
            found = cast("Mapping[str, Any]", found).get(key)
            continue
        name = _names(type(found)).get(key) if found is not None else None
        if name is None:
            return None
        found = getattr(found, name)
    return float(found)


@cache
def _names(kind: type[DataclassInstance]) -> dict[str, str]:
    """Return the fields of a section by their keys."""
    return {key_of(kind, field.name): field.name for field in fields(kind)}
