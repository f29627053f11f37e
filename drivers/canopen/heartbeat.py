"""Heartbeats, both ways (CiA 301, 7.2.8.3.2): 0x1016 and 0x1017 values, and a consumer's monitor."""

from __future__ import annotations

import math
from typing import Final

MISSED: Final = 3
"""A producer is lost after this many of its periods without a heartbeat (safety.md: 3 x 50 ms)."""


def consumer_entry(node_id: int, timeout_s: float) -> int:
    """Return the U32 of 0x1016 that watches a node (1..127) with a time-out in s (up to 65.535)."""
    return node_id << 16 | round(timeout_s * 1000)


def state_of(data: bytes) -> int | None:
    """Return the NMT state of a heartbeat frame, or None if it is not one byte long.

    Bit 7, the toggle of the obsolete node guarding, is masked.
    """
    if len(data) != 1:
        return None
    return data[0] & 0x7F


class HeartbeatMonitor:
    """Watches one producer, from ``arm`` on; a lost producer stays lost until the next ``arm``.

    ``due`` is the time (s) at which the producer counts as lost; infinite while not armed, or after a loss.
    """

    def __init__(self, period_s: float) -> None:
        self.timeout_s = MISSED * period_s
        self.heard_s = -math.inf
        self.armed = False
        self.lost = False
        self.due = math.inf

    def arrived(self, t: float) -> None:
        """Note a heartbeat that arrived at ``t`` (s)."""
        self.heard_s = t
        if self.armed and not self.lost:
            self.due = t + self.timeout_s

    def arm(self) -> None:
        """Begin to watch; the next heartbeat is due one time-out after the last one received."""
        self.armed = True
        self.lost = False
        self.due = self.heard_s + self.timeout_s

    def disarm(self) -> None:
        """Stop watching, and forget earlier heartbeats."""
        self.heard_s = -math.inf
        self.armed = False
        self.lost = False
        self.due = math.inf

    def expired(self, now: float) -> bool:
        """Return True once, when the time-out has passed; the loss then stays until ``arm``."""
        if now < self.due:
            return False
        self.lost = True
        self.due = math.inf
        return True
