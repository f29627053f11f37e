"""The hardness that a compound's file states, and when a measured one is a doubt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from tester.base.units import SHORE_A, shown

HARDNESS_U: Final = 3.0
"""Expanded uncertainty of a hardness by hand, Shore A [A]: a pocket durometer and its operator differ by some 2."""


@dataclass(frozen=True, slots=True)
class BelievedHardness:
    """A compound's hardness, Shore A, as its file states it. ``tolerance``: its own, None where it states none."""

    shore_a: float
    tolerance: float | None = None

    def doubt(self, compound: str, shore_a: float) -> str:
        """Return why a measured hardness is doubtful; "" within the tolerance, or HARDNESS_U where none is stated."""
        within = HARDNESS_U if self.tolerance is None else self.tolerance
        if abs(shore_a - self.shore_a) <= within:
            return ""
        assumed = " [A]" if self.tolerance is None else ""
        return (
            f"{shore_a:g} {SHORE_A} is not that of {shown(compound)}: another compound, or an old one?"
            f" (expected {self.shore_a:g} of its file, within {within:g}{assumed})"
        )
