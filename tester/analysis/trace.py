"""The samples in the blocks of a repeat: friction within a revolution."""

from __future__ import annotations

from array import array
from itertools import pairwise
from typing import Final

from tester.base.arrays import Array
from tester.base.quantities import TIME, Quantities

REVOLUTIONS: Final = "rev"
"""Unit of the position that counts blocks where it is a rotation angle."""


COLUMNS: Final = ("time_s", "position", "along", "across", "normal")


class Trace:
    """Accepted samples of whole blocks, contact by contact, in order of time.

    Columns of equal length: time (s), position (in units of the channel that counts blocks), forces along, across (0
    where it is not measured) and normal (N). ``starts`` has the index at which each contact begins.
    """

    __slots__ = ("across", "along", "normal", "position", "starts", "time_s", "turns")

    def __init__(self, quantities: Quantities) -> None:
        """Start empty; ``turns``: the position is a rotation angle, in revolutions."""
        self.turns = quantities[quantities.roles.turn].unit == REVOLUTIONS
        self.starts: list[int] = []
        self.time_s = array("d")
        self.position = array("d")
        self.along = array("d")
        self.across = array("d")
        self.normal = array("d")

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.time_s)

    def contacts(self) -> list[dict[str, Array]]:
        """Return the columns of each contact as arrays, by name."""
        import numpy as np

        columns: dict[str, Array] = {name: np.array(getattr(self, name), dtype=np.float64) for name in COLUMNS}
        edges = [*self.starts, len(self)]
        return [{name: column[a:b] for name, column in columns.items()} for a, b in pairwise(edges)]


def columns_of(quantities: Quantities) -> tuple[str, str, str, str, str]:
    """Return the channels of a trace's columns, in order; "" for a force across that is not measured."""
    roles = quantities.roles
    along, *across = roles.friction
    return TIME, roles.turn, along, "".join(across), roles.normal
