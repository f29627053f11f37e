"""The loosest accepted value of each safety key of a rig file: its direction, its hardest value, and the reason.

An interlock's parameter has its own ceiling (tester.inputs.rig.parameter); a kind lists its other keys
(``Rig.ceilings``). A looser value is a risk that a person must accept in words (tester.inputs.rig.risks).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from tester.base.units import parse
from tester.inputs.rig.parameter import Direction, Parameter

LOWER, HIGHER = Direction.LOWER, Direction.HIGHER
TRUE: Final = "true"
"""Hardest value of a switch that must not be off."""
AXES: Final = "axes.*."


@dataclass(frozen=True, slots=True)
class Ceiling:
    """A safety key of the rig file. ``*`` in it matches every axis with a drive."""

    key: str
    unit: str
    """"" for a switch, and for the bare numbers of an axis, which count in the axis's unit."""
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
