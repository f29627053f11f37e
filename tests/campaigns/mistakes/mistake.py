"""A mistake on the simulated rig, and the finding that must name it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Mistake:
    """A mistake on the simulated rig: ``find`` makes a rig of a seed with the mistake and returns the findings."""

    name: str
    named_by: str
    """A regular expression that one of the findings must match."""
    find: Callable[[int], list[str]]
    disagrees: Callable[[int], str] = lambda seed: ""
    """Returns how the exit code contradicts a run of the same rig; "" if it agrees, or has no exit code."""
