"""A relay beside the program: safe torque off of wheel and belt once one of them stands and the other turns."""

from __future__ import annotations

from math import inf
from typing import Final

TURNS_M_S: Final = 0.15
"""Speed from which wheel or belt turns, m/s [A]: in a cool-down the wheel alone turns, at 0.1 m/s."""
STANDS_M_S: Final = 0.01
"""A slower wheel or belt is at rest, m/s [A]."""
REACTS_S: Final = 0.02
"""Time from the condition to the torque off, s [A]: a standstill monitor and a contactor's coil."""


class StandstillRelay:
    """The relay, with speed sensors of its own on the wheel's shaft and on the belt."""

    def __init__(self) -> None:
        """The relay works, and torque is on."""
        self.works = True
        self.reaches = ["wheel", "belt"]
        """Axes whose drives have its contacts in their safe torque off."""
        self.off = False
        """Whether it has taken the torque off; both have to stand before it comes back."""
        self._since_s = inf

    def look(self, wheel_m_s: float, belt_m_s: float, now_s: float) -> bool:
        """Read the speeds of tread and belt at ``now_s``; return whether ``off`` has changed."""
        if wheel_m_s >= STANDS_M_S and belt_m_s >= STANDS_M_S and not self.off:  # both turn, as nearly always
            self._since_s = inf
            return False
        wheel_turns = not -STANDS_M_S < wheel_m_s < STANDS_M_S
        belt_turns = not -STANDS_M_S < belt_m_s < STANDS_M_S
        before = self.off
        if before:
            self.off = wheel_turns or belt_turns
        elif wheel_turns is belt_turns or not (abs(wheel_m_s) > TURNS_M_S or abs(belt_m_s) > TURNS_M_S):
            self._since_s = inf
        elif self._since_s == inf:
            self._since_s = now_s
        else:
            self.off = self.works and now_s - self._since_s >= REACTS_S
        return self.off is not before
