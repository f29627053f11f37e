"""A parameter of an interlock: what it is, its unit, what the packaged rig file says, how far it may be loosened.

A parameter is declared beside the row that it belongs to, and nowhere else: the rig file's section ``interlocks`` with
its comments, ``tester rig init`` and the page docs/kinds/wheel-on-belt.md are made from these declarations.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final, TypeAlias

from tester.base.config_reader import SUFFIXES, Range
from tester.base.units import known_unit, parse

SECTION: Final = "interlocks"
"""Of a rig file: where parameters stand."""
POSITIVE: Final = Range(gt=0.0)
NOT_NEGATIVE: Final = Range(ge=0.0)
SHARE: Final = Range(gt=0.0, le=1.0)
AT_LEAST_ONE: Final = Range(ge=1.0)
ANY: Final = Range()
WIDTH: Final = 36
"""Column at which a comment begins in a rig file."""


class Direction(Enum):
    """Which way a parameter is tightened: the interlock then trips sooner, or the machine may do less."""

    LOWER = "lower"
    HIGHER = "higher"


@dataclass(frozen=True, eq=False, slots=True)
class Parameter:
    """One key of the rig file's section ``interlocks``. Two parameters are the same only if they are one object."""

    name: str
    """Field of ``InterlocksConfig``: the key with the suffix of the unit, e.g. ``stale_cell_s`` (config_reader)."""
    unit: str
    default: str
    """What the packaged rig file says, as it stands there: "50 ms"."""
    text: str
    """The comment beside it: what it limits and where the number comes from; [A] marks an engineering assumption."""
    bounds: Range = POSITIVE
    """What the key accepts at all, in its unit."""
    direction: Direction = Direction.LOWER
    """Which way is tighter, where ``hardest`` limits it."""
    hardest: str = ""
    """How far it may be loosened before a row no longer does what it is there for, as text like ``default``; "" where
    no harm hangs on it. On a real machine anything looser is a risk that somebody has to accept."""
    because: str = ""
    """Why there."""

    def __post_init__(self) -> None:
        """Raise UnitError for a unit that the table lacks."""
        known_unit(self.unit.replace(".", " "), f"interlock parameter {self.name}")

    def __deepcopy__(self, memo: dict[int, object]) -> Parameter:
        """Return itself: a copied rig looks its values up under the same parameters."""
        return self

    @property
    def key(self) -> str:
        """The key in the rig file."""
        return self.name.removesuffix(SUFFIXES.get(self.unit, ""))

    @property
    def value(self) -> float:
        """What the packaged rig file says, in the parameter's unit; raises UnitError for a text in another."""
        return parse(self.default, self.unit)

    @property
    def hardest_value(self) -> float | None:
        """How far it may be loosened, in the parameter's unit; None where nothing is said of that."""
        return parse(self.hardest, self.unit) if self.hardest else None

    def looser(self, value: float) -> bool:
        """Tell whether a value is looser than the hardest; what is not a number is."""
        limit = self.hardest_value
        if limit is None:
            return False
        return not (value <= limit) if self.direction is Direction.LOWER else not (value >= limit)


Values: TypeAlias = dict[Parameter, float]
"""What the parameters are on a rig, each in its unit."""


def key_line(parameter: Parameter, indent: str = "  ") -> str:
    """Return a parameter's line of a rig file: key, packaged value, comment."""
    return f"{indent}{parameter.key}: {parameter.default}".ljust(WIDTH - 1) + f" # {parameter.text}"
