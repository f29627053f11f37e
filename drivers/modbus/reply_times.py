"""How long a station takes to answer beyond the time on the wire: measured when it is connected, then its time-out.

What is measured is the whole way: the device's own turnaround, the adapter (a USB adapter's latency timer holds
characters back, usually for 16 ms), the operating system, and how often the line is looked at.
"""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.profiles.model import Timing

REPLIES: Final = 5
"""Replies that are measured when a station is connected [A]."""
UNMEASURED_S: Final = 0.1
"""A reply is waited for this long beyond the wire until it is known how long replies take [A]: six latency timers of
16 ms. A slower line is as good as silent."""
REPLY_FACTOR: Final = 1.5
"""A reply may take this times the longest measured [A]. A USB adapter's timer adds 0 to 16 ms by chance, so that the
longest of five is above 10 ms in 99 of 100 cases. No less than the profile's own limit, no more than UNMEASURED_S."""


class ReplyTimes:
    """Times from the end of a request to the start of its reply, s, as they are seen here.

    ``count`` replies were measured, ``least_s`` and ``greatest_s`` of them; ``measured`` once there are enough.
    """

    def __init__(self) -> None:
        """Nothing is known."""
        self.forget()

    def forget(self) -> None:
        """Measure anew, from the next reply on."""
        self.count = 0
        self.least_s = inf
        self.greatest_s = 0.0
        self.total_s = 0.0
        self.measured = False

    def note(self, seconds: float) -> None:
        """Take a reply's time, s."""
        self.count += 1
        self.total_s += seconds
        self.least_s = min(self.least_s, seconds)
        self.greatest_s = max(self.greatest_s, seconds)
        self.measured = self.count >= REPLIES

    @property
    def mean_s(self) -> float:
        """Mean of what was measured, s; 0 before the first reply."""
        return self.total_s / self.count if self.count else 0.0

    def limit_s(self, timing: Timing) -> float:
        """Return how long a reply is waited for beyond the wire, s."""
        if not self.measured:
            return max(timing.reply_max_s, UNMEASURED_S)
        return max(timing.reply_max_s, min(REPLY_FACTOR * self.greatest_s, UNMEASURED_S))
