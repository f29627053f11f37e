"""What a kind brings whose machine reaches a device on a turning part through a ring with brushes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tester.analysis.ring_runs import RingRun
from tester.store.reader import RunReader


@dataclass(frozen=True, slots=True)
class RingPart:
    """``title``: what people call it; ``counted``: which requests are; ``turns``: what it turns with; all in words."""

    title: str
    counted: str
    turns: str
    of: Callable[[RunReader, str], RingRun]
    """Read a run of some name; raises StoreError."""
