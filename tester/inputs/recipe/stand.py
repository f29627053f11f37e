"""How far a plan had come before an interruption: what its kind needs to say what is left to do."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Mounted:
    """Rubber that was mounted before the interruption. Diameter in mm (NaN: it has none), sliding distance in m."""

    number: int
    """Of all that were mounted, from 1."""
    specimen: int
    replicate: int
    diameter_mm: float
    sliding_m: float
    ground: bool
    """It was prepared: ground in, or run in, completely."""
    last_condition: int = 0
    """The last condition it was used in; 0: none yet."""


@dataclass(frozen=True, slots=True)
class Stand:
    """How far a plan has come: conditions by their numbers, rubber in the order in which it was mounted."""

    ended: frozenset[int] = frozenset()
    begun: frozenset[int] = frozenset()
    """Conditions of which a repeat was begun, ended ones included."""
    mounted: tuple[Mounted, ...] = ()
    travel_m: float = 0.0
    """How far the counterface has travelled under load."""
