"""How fast a temperature changes from scan to scan, and so whether it may reach a limit soon."""

from __future__ import annotations

from math import nan
from typing import Final

FADES: Final = 0.98
"""Share of a change that counts in the next scan: that of a second ago counts 0.7 to 0.8 [A]."""
SURE: Final = 4.0
"""A temperature further from a limit than so many of its changes from scan to scan does not reach it soon [A]: ten
standard deviations of noise.
"""


class TemperatureTrend:
    """The greatest change of a temperature from one scan to the next, which fades."""

    __slots__ = ("last_c", "moved_k")

    def __init__(self) -> None:
        """Begin without a reading."""
        self.last_c = nan
        self.moved_k = 0.0

    def follow(self, temperature_c: float) -> None:
        """Take the reading of a scan, degC; NaN counts as no change."""
        moved_k = abs(temperature_c - self.last_c)
        self.last_c = temperature_c
        faded_k = FADES * self.moved_k
        self.moved_k = moved_k if moved_k > faded_k else faded_k

    def far(self, off_k: float) -> bool:
        """Return whether a limit ``off_k`` away is not reached soon; NaN: it may be."""
        return off_k > SURE * self.moved_k
