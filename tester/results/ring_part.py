"""A kind's contribution for a machine that reaches a device on a turning part through a slip ring."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tester.analysis.ring_runs import RingRun
from tester.store.run_reader import RunReader


@dataclass(frozen=True, slots=True)
class RingPart:
    """Description of the ring, in words: ``title`` its name, ``counted`` the counted requests, ``turns`` the part that
    turns it."""

    title: str
    counted: str
    turns: str
    of: Callable[[RunReader, str], RingRun]
    """Reads a run of some name; raises StoreError."""
