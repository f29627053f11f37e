"""How many of a condition's repeats were asked for, made and valid, and which were made up: the one place that counts.

What is counted is whatever makes a value: repeats; pairs of repeats where both directions are measured; replicates for
the row that stands for them.
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

    ``asked``: what the recipe asks for at least. ``valid``: those in the mean. ``make_ups`` are the places, from 0, of
    those made in place of refused ones; they are among ``made``.
    """

    asked: int = 0
    made: int = 0
    valid: int = 0
    make_ups: tuple[int, ...] = ()
    of: str = REPEATS

    @property
    def left_out(self) -> int:
        """Return how many of those made are in no mean: refused, left out by hand, or not chosen."""
        return self.made - self.valid

    @property
    def made_up(self) -> int:
        """Return how many were made in place of refused ones."""
        return len(self.make_ups)

    @property
    def words(self) -> str:
        """Return what is in the mean, of what was asked for: ``3 of 3``."""
        return f"{self.valid} of {self.asked}"


NO_COUNTS: Final = Counts()


def make_ups_of(asked: int, made: int, refused: Collection[int]) -> tuple[int, ...]:
    """Return the places, from 0, of make-ups among ``made``: each stands in place of a refused one before it.

    What is made beyond ``asked`` while none is owed is for precision, or to show that a drift is small: no make-up.
    """
    owed, make_ups = 0, list[int]()
    for place in range(made):
        if place >= asked and owed:
            owed -= 1
            make_ups.append(place)
        owed += place in refused
    return tuple(make_ups)
