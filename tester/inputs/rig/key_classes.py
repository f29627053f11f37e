"""The class of each key of a rig file: bounded, held against another, or free of harm.

A field of a section carries its class in its type: ``Annotated[float, "N", Bounded(LOWER, "450 N", "...")]``. It may
be bounded both ways. A section whose fields another package declares carries theirs (``Inside``); a class of a whole
section counts for all its keys. An interlock's parameter has its own (tester.inputs.rig.parameter.Parameter).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Final, TypeAlias

from tester.base.units import parse
from tester.inputs.rig.parameter import Direction, Parameter

LOWER, HIGHER = Direction.LOWER, Direction.HIGHER
TRUE: Final = "true"
"""Hardest value of a switch that must not be off."""


@dataclass(frozen=True, slots=True)
class Bounded:
    """A safety key: a looser value than its hardest is a risk that a person must accept (tester.inputs.rig.risks)."""

    direction: Direction
    """The tighter direction; for a switch, true is the higher value."""
    hardest: str
    """The loosest accepted value, as text in the rig file's form."""
    because: str
    zero_is_off: bool = False
    """Whether 0 switches the watch off: looser than any other value."""
    own: bool = False
    """Whether every machine has a value of its own: a real rig's file may differ from the packaged one up to the
    hardest value without an accepted risk."""


@dataclass(frozen=True, slots=True)
class Held:
    """A key that describes the machine: something else contradicts a wrong value; only a real rig's file sets it."""

    against: str
    """What contradicts a wrong value, and by which check."""
    within: float = inf
    """Greatest share by which the file of a real rig may differ from the packaged value without an accepted risk."""


@dataclass(frozen=True, slots=True)
class Free:
    """A key that no harm depends on."""

    because: str


KeyClass: TypeAlias = Bounded | Held | Free
Classes: TypeAlias = "KeyClass | tuple[KeyClass, ...] | Mapping[str, Classes]"
"""The class of a key, its two bounds, or the classes of a section by key."""


@dataclass(frozen=True, slots=True)
class Inside:
    """The classes of the keys of a section whose fields are declared elsewhere; in the fields of its type, ignored."""

    classes: Mapping[str, Classes] = field(hash=False)


@dataclass(frozen=True, slots=True)
class Ceiling:
    """A bound of a safety key of a kind. ``*`` in its key matches every name that a file chooses."""

    key: str
    unit: str
    """"" for a switch, and for the bare numbers of an axis, which count in the axis's unit."""
    bound: Bounded

    @property
    def limit(self) -> float:
        """Return the hardest value in the key's unit; 1 for "true"."""
        return 1.0 if self.bound.hardest == TRUE else parse(self.bound.hardest, self.unit or "1")

    def looser(self, value: float, limit: float) -> bool:
        """Return whether a value is looser than a limit; NaN is."""
        if self.bound.zero_is_off and value == 0.0:
            return limit != 0.0
        if self.bound.zero_is_off and limit == 0.0:
            return value != value
        return not (value <= limit) if self.bound.direction is LOWER else not (value >= limit)

    def text(self, value: float) -> str:
        """Return a value in the rig file's form."""
        if self.bound.hardest == TRUE:
            return TRUE if value else "false"
        return f"{value:g} {self.unit}".removesuffix(" 1").rstrip()


def class_of(parameter: Parameter) -> tuple[KeyClass, ...]:
    """Return the class of an interlock's parameter; none for a parameter without a reason."""
    if parameter.hardest:
        return (Bounded(parameter.direction, parameter.hardest, parameter.because),)
    return (Free(parameter.because),) if parameter.because else ()
