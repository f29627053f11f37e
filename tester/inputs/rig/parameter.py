"""A parameter of an interlock: its meaning, its unit, the packaged rig file's value, its loosest accepted value.

A parameter is declared beside its row, and nowhere else: the rig file's section ``interlocks`` with its comments,
``tester rig init`` and the page docs/kinds/wheel-on-belt.md are made from these declarations.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final, TypeAlias

from tester.base.config_reader import SUFFIXES, Range
from tester.base.units import known_unit, parse

SECTION: Final = "interlocks"
"""Section of a rig file with the parameters."""
POSITIVE: Final = Range(gt=0.0)
NOT_NEGATIVE: Final = Range(ge=0.0)
SHARE: Final = Range(gt=0.0, le=1.0)
AT_LEAST_ONE: Final = Range(ge=1.0)
ANY: Final = Range()
WIDTH: Final = 36
"""Column at which a comment begins in a rig file."""


class Direction(Enum):
    """The direction in which a parameter is tightened: the interlock then trips sooner, or the machine may do less."""

    LOWER = "lower"
    HIGHER = "higher"


@dataclass(frozen=True, eq=False, slots=True)
class Parameter:
    """One key of the rig file's section ``interlocks``. Two parameters are the same only if they are one object."""

    name: str
    """Field of ``InterlocksConfig``: the key with the suffix of the unit, e.g. ``stale_cell_s`` (config_reader)."""
    unit: str
    default: str
    """The packaged rig file's value, as text: "50 ms"."""
    text: str
    """The comment beside it: its effect and the origin of the number; [A] marks an engineering assumption."""
    bounds: Range = POSITIVE
    """Accepted range, in its unit."""
    direction: Direction = Direction.LOWER
    """The tighter direction, where ``hardest`` limits it."""
    hardest: str = ""
    """The loosest value with which a row still serves its purpose, as text like ``default``; "" where no harm depends
    on it. On a real machine anything looser is a risk that a person must accept."""
    because: str = ""
    """Reason for ``hardest``, or why no harm depends on it."""

    def __post_init__(self) -> None:
        """Raise UnitError for a unit that the table lacks."""
        known_unit(self.unit.replace(".", " "), f"interlock parameter {self.name}")

    def __deepcopy__(self, memo: dict[int, object]) -> Parameter:
        """Return itself: a copied rig looks its values up under the same parameters."""
        return self

    @property
    def key(self) -> str:
        """Return the key in the rig file."""
        return self.name.removesuffix(SUFFIXES.get(self.unit, ""))

    @property
    def value(self) -> float:
        """Return the packaged rig file's value, in the parameter's unit; raises UnitError for a text in another."""
        return parse(self.default, self.unit)


Values: TypeAlias = dict[Parameter, float]
"""Values of the parameters on a rig, each in its unit."""


def key_line(parameter: Parameter, indent: str = "  ") -> str:
    """Return a parameter's line of a rig file: key, packaged value, comment."""
    return f"{indent}{parameter.key}: {parameter.default}".ljust(WIDTH - 1) + f" # {parameter.text}"
