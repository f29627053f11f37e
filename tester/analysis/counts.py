"""How many of a condition's repeats were requested, made and valid, and which replace refused ones.

Every count in the program comes from this module. The counted items are those that make a value: repeats; pairs of
repeats where both directions are measured; replicates for the row of their mean.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

REPEATS: Final = "repeats"
PAIRS: Final = "pairs"
REPLICATES: Final = "replicates"


@dataclass(frozen=True, slots=True)
class Counts:
    """Counts of a condition: ``made`` is always ``valid`` plus ``left_out``.

    ``asked``: the least number that the recipe requests. ``valid``: those in the mean. ``make_ups``: places among
    ``made``, from 0, of those that replace refused ones.
    """

    asked: int = 0
    made: int = 0
    valid: int = 0
    make_ups: tuple[int, ...] = ()
    of: str = REPEATS

    @property
    def left_out(self) -> int:
        """Return how many are in no mean: refused, left out by hand, or not chosen."""
        return self.made - self.valid

    @property
    def made_up(self) -> int:
        """Return how many were made in place of refused ones."""
        return len(self.make_ups)

    @property
    def words(self) -> str:
        """Return valid of requested, as text: ``3 of 3``."""
        return f"{self.valid} of {self.asked}"


NO_COUNTS: Final = Counts()


def make_ups_of(asked: int, made: int, refused: Collection[int]) -> tuple[int, ...]:
    """Return the places, from 0, of make-ups among ``made``: each replaces a refused one before it.

    Repeats beyond ``asked`` that replace none serve precision or the drift test: they are no make-ups.
    """
    owed, make_ups = 0, list[int]()
    for place in range(made):
        if place >= asked and owed:
            owed -= 1
            make_ups.append(place)
        owed += place in refused
    return tuple(make_ups)
