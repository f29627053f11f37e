"""Safety keys of a rig that are looser than those of another rig, or than their ceilings: a person must accept them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, cast

from drivers.canopen.dictionary import PRODUCT_CODE, VENDOR_ID
from tester.base.config_reader import key_of
from tester.inputs.rig.ceilings import Ceiling
from tester.inputs.rig.config import Rig

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_SAID_ONCE = {"heartbeat": "drive_heartbeat", "consumer_heartbeat": "consumer_heartbeat"}
"""Keys of an axis that the section ``can`` sets for all: their risk is reported once."""


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

    All drives of a rig behind a door must report the simulator's identity (0x1018). The identity is compared at every
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
