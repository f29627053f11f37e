"""Participants in the traffic of a simulated CAN bus: listeners, devices that answer SYNC, periodic frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from math import inf
from typing import Protocol

Listener = Callable[[bytes, float], None]
"""Called with the data of a frame and its arrival time in s."""


class WiredNode(Protocol):
    """A device on the wire: it is advanced in time and listens through ``CanWire.listen``."""

    due_s: float

    def advance(self, t0: float, t1: float) -> None:
        """Advance from ``t0`` to ``t1`` seconds, and send the frames that fall due."""
        ...


class SyncFollower(ABC):
    """A device that answers SYNC.

    ``plain``: the next SYNC needs only one TPDO, ``sample`` under ``sample_id``, which takes ``sample_s`` on the wire;
    if that is ``stale``, the result of ``take_sample``.
    """

    __slots__ = ("plain", "sample", "sample_id", "sample_s", "stale", "take_sample")

    def __init__(self, take_sample: Callable[[], bytes]) -> None:
        """Begin not ``plain``: the device answers by ``on_sync``."""
        self.plain = False
        self.stale = True
        self.sample = b""
        self.sample_id = 0
        self.sample_s = 0.0
        self.take_sample = take_sample

    @abstractmethod
    def on_sync(self, t: float, plainly: bool = False) -> bool:
        """Act on a SYNC that arrived at ``t`` s and answer it.

        ``plainly``: if it becomes ``plain`` by that, its answer is left to the wire; return whether it is.
        """


class Beat:
    """A frame that a node sends by itself in a fixed period; ``due_s`` is its next time."""

    __slots__ = ("can_id", "data", "due_s", "period_s")

    def __init__(self, can_id: int, data: bytes, period_s: float) -> None:
        """Take the identifier, the data and the period in s (> 0)."""
        self.can_id = can_id
        self.data = data
        self.due_s = inf
        self.period_s = period_s


def frame_bits(length: int) -> int:
    """Return the worst-case bits of a standard data frame with ``length`` data bytes, intermission included.

    44 bits of frame and 3 of intermission around the data, and one stuff bit for every four of the 34 + 8 n - 1
    stuffable ones (ISO 11898-1; 135 bits at 8 bytes).
    """
    return 47 + 8 * length + (33 + 8 * length) // 4
