"""The loosest accepted value of each safety key of a rig file: its direction, its hardest value, and the reason.

An interlock's parameter has its own ceiling (tester.inputs.rig.parameter); a kind lists its other keys
(``Rig.ceilings``). A looser value is a risk that a person must accept in words (tester.inputs.rig.rig_files).
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
"""Hardest value of a switch that must not be off."""
AXES: Final = "axes.*."
_SAID_ONCE = {"heartbeat": "drive_heartbeat", "consumer_heartbeat": "consumer_heartbeat"}
"""Keys of an axis that the section ``can`` sets for all: their risk is reported once."""


@dataclass(frozen=True, slots=True)
class Ceiling:
    """A safety key of the rig file. ``*`` in it matches every axis with a drive."""

    key: str
    unit: str
    """"" for a switch. The bare numbers of an axis count in its own unit: they have none of their own either."""
    direction: Direction
    """The tighter direction; for a switch, true is the higher value."""
    hardest: str
    """The loosest accepted value, as text in the rig file's form."""
    because: str
    zero_is_off: bool = False
    """Whether 0 switches the watch off: looser than any other value."""

    @property
    def limit(self) -> float:
        """Return the hardest value in the key's unit; 1 for "true"."""
        return 1.0 if self.hardest == TRUE else parse(self.hardest, self.unit or "1")

    def looser(self, value: float, limit: float) -> bool:
        """Return whether a value is looser than a limit; NaN is."""
        if self.zero_is_off and value == 0.0:
            return limit != 0.0
        if self.zero_is_off and limit == 0.0:
            return value != value
        return not (value <= limit) if self.direction is LOWER else not (value >= limit)

    def text(self, value: float) -> str:
        """Return a value in the rig file's form."""
        if self.hardest == TRUE:
            return TRUE if value else "false"
        return f"{value:g} {self.unit}".removesuffix(" 1").rstrip()


def ceilings_of(section: str, parameters: Iterable[Parameter]) -> tuple[Ceiling, ...]:
    """Return the ceilings that the parameters of a section declare."""
    return tuple(
        Ceiling(
            f"{section}.{parameter.key}",
            "" if parameter.unit == "1" else parameter.unit,
            parameter.direction,
            parameter.hardest,
            parameter.because,
        )
        for parameter in parameters
        if parameter.hardest
    )


def ceiling_table(ceilings: Iterable[Ceiling]) -> str:
    """Return every safety key with its direction, its hardest value and the reason as Markdown, a line each."""
    lines = ["| key | tighter is | not looser than | because |", "|---|---|---|---|"]
    lines += [
        f"| {ceiling.key} | {ceiling.direction.value} | {ceiling.hardest} | {ceiling.because} |" for ceiling in ceilings
    ]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True)
class Risk:
    """A value of a rig that is looser than allowed without a person's acceptance."""

    ceiling: Ceiling
    location: tuple[str, ...]
    value: float
    limit: float

    @property
    def key(self) -> str:
        """Return the key as in the rig file."""
        return ".".join(self.location)

    def __str__(self) -> str:
        """Return key, value and limit."""
        return f"{self.key} {self.compared}"

    @property
    def compared(self) -> str:
        """Return value and limit in words."""
        ceiling = self.ceiling
        hardest = (
            f" and than {ceiling.hardest}"
            if ceiling.looser(self.value, ceiling.limit) and self.limit != ceiling.limit
            else ""
        )
        return f"{ceiling.text(self.value)} is looser than {ceiling.text(self.limit)}{hardest}"


def counts_as_simulated(rig: Rig) -> bool:
    """Return whether a rig is harmless: it is simulated in this process, or behind a door.

    A rig behind a door has drives that all must report the simulator's identity (0x1018). It is compared at every
    connect, before anything moves: with other drives on the wire the run does not begin.
    """
    ids = {(drive.vendor_id, drive.product_code) for drive in rig.drives().values()}
    return rig.simulated or ids == {(VENDOR_ID, PRODUCT_CODE)}


def loosened(rig: Rig, than: Rig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser in one rig than in another; axes that only one has are left out."""
    risks: list[Risk] = []
    for ceiling, location, value in _values(rig):
        limit = value_at(than, location)
        if limit is not None and ceiling.looser(value, limit):
            risks.append(Risk(ceiling, location, value, limit))
    return tuple(risks)


def beyond(rig: Rig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser than their hardest values."""
    return tuple(
        Risk(ceiling, location, value, ceiling.limit)
        for ceiling, location, value in _values(rig)
        if ceiling.looser(value, ceiling.limit)
    )


def _values(rig: Rig) -> Iterator[tuple[Ceiling, tuple[str, ...], float]]:
    """Yield every safety key that a rig has, with its place and its value (1 and 0 for a switch)."""
    for ceiling in rig.ceilings:
        names = rig.drives() if "*" in ceiling.key else ("",)
        for name in names:
            location = tuple(ceiling.key.replace("*", name).split("."))
            value = value_at(rig, location)
            common = value_at(rig, ("can", _SAID_ONCE.get(location[-1], ""))) if name else None
            # A value that `can` sets for all axes is reported once, there.
            if value is not None and value != common:
                yield ceiling, location, value


def value_at(rig: Rig, location: tuple[str, ...]) -> float | None:
    """Return the value at a place of the file, None where the rig has no such axis."""
    node: Any = rig
    for key in location:
        if isinstance(node, Mapping):
            node = cast("Mapping[str, Any]", node).get(key)
            continue
        name = _names(type(node)).get(key) if node is not None else None
        if name is None:
            return None
        node = getattr(node, name)
    return float(node)


@cache
def _names(kind: type[DataclassInstance]) -> dict[str, str]:
    """Return the fields of a section by their keys."""
    return {key_of(kind, field.name): field.name for field in fields(kind)}
