"""The interlock table: the rows of every subject in one order, and their bits.

The order is that of importance: of rows that trip in one scan the first becomes the cause. A row's bit is its place.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from tester.interlocks import (
    devices,
    friction,
    hub,
    load,
    motion,
    operation,
    rest,
    stops,
    surface,
    wires,
    witness,
)
from tester.interlocks.inputs import Inputs
from tester.interlocks.parameter import Parameter
from tester.interlocks.row import ALWAYS, ENDING, LOADED, WARN, Condition, Interlock

INTERLOCKS: Final[tuple[Interlock, ...]] = (
    *wires.ROWS, *motion.ROWS, *load.ROWS, *witness.ROWS, *friction.ROWS, *surface.ROWS, *hub.ROWS, *devices.ROWS,
    *stops.ROWS, *rest.ROWS, *wires.WARNINGS,
)  # fmt: skip


def parameters_of(rows: Iterable[Interlock]) -> tuple[Parameter, ...]:
    """Return the parameters that rows declare, each once, with the first row that has it."""
    return tuple(dict.fromkeys(parameter for row in rows for parameter in row.declared()))


PARAMETERS: Final[tuple[Parameter, ...]] = (*parameters_of(INTERLOCKS), *operation.PARAMETERS)
"""Every key of the rig file's section ``interlocks``, in its order."""


class Group:
    """Conditions that are evaluated together, with their bits."""

    __slots__ = ("bits", "conditions")

    def __init__(self, members: Iterable[tuple[int, Condition]]) -> None:
        """Take (bit, condition) pairs."""
        found = tuple(members)
        self.bits: tuple[int, ...] = tuple(one for one, _ in found)
        self.conditions: tuple[Condition, ...] = tuple(condition for _, condition in found)

    def held(self, v: Inputs) -> int:
        """Return the bits of the conditions that hold. Nearly always none does: only then is it asked which."""
        for condition in self.conditions:
            if condition(v):
                return self._which(v)
        return 0

    def _which(self, v: Inputs) -> int:
        held = 0
        for i, condition in enumerate(self.conditions):
            if condition(v):
                held |= self.bits[i]
        return held


_BITS: Final = {row.name: 1 << i for i, row in enumerate(INTERLOCKS)}


def bit(name: str) -> int:
    """Return the bit of a row; raises KeyError for a name that is not in the table."""
    return _BITS[name]


_ALWAYS: Final = Group((bit(row.name), row.condition) for row in INTERLOCKS if row.when is ALWAYS)
_LOADED: Final = Group((bit(row.name), row.condition) for row in INTERLOCKS if row.when is LOADED)
_ENDING: Final = Group((bit(row.name), row.condition) for row in INTERLOCKS if row.when is ENDING)
_UNSEEN: Final = Group((bit(row.name), row.unseen) for row in INTERLOCKS if row.unseen is not None)

AT_REST: Final = sum(bit(row.name) for row in INTERLOCKS if row.at_rest is not None)
"""Rows that trip in idle, too."""
WARNINGS: Final = sum(bit(row.name) for row in INTERLOCKS if row.reaction is WARN)
"""Rows that stop nothing: they do not stand in the way of arming or acknowledging."""


def held(v: Inputs) -> int:
    """Return the bits of the rows that hold in a scan; every row that can apply is evaluated."""
    found = _ALWAYS.held(v)
    if v.loaded and not v.unpowered:
        found |= _LOADED.held(v)
    if v.lifting_s >= 0.0 or v.resting or v.unpowered:
        found |= _ENDING.held(v)
    return found


def still_there(v: Inputs) -> int:
    """Return the bits of rows that are watched only while drives, load or heat are wanted, as if they were."""
    return _UNSEEN.held(v)


def names_of(bits: int) -> list[str]:
    """Return the names of the rows whose bits are set."""
    return [row.name for i, row in enumerate(INTERLOCKS) if bits >> i & 1]
