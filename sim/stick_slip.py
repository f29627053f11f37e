"""Stick-slip: friction that rises while the contact sticks and falls back as it slips, over and over.

Its course is a saw-tooth about the mean: a slow rise, a fall within ``SLIP_SHARE`` of the period. No two periods are
quite alike.
"""

from __future__ import annotations

from typing import Final

from sim.noise import NormalStream

SLIP_SHARE: Final = 0.15
"""Share of a period in which friction falls back [A]."""
PERIOD_SIGMA: Final = 0.03
"""Relative standard deviation of a period [A]."""
_LEAST_PERIOD: Final = 0.5
"""A drawn period is at least this share of the mean one."""


class StickSlip:
    """What stick-slip multiplies friction by, step by step. Deep-copyable; the periods come from a stream of noise."""

    def __init__(self, share: float, frequency_hz: float, noise: NormalStream) -> None:
        """Swing by ``share`` to either side of the mean, ``frequency_hz`` times a second in the mean (above 0)."""
        self._share = share
        self._frequency_hz = self._rate_hz = frequency_hz
        self._at = 0.0
        self._noise = noise

    def restart(self, noise: NormalStream) -> None:
        """Draw the periods to come from another stream."""
        self._noise = noise

    def factor(self, dt: float) -> float:
        """Return the factor after ``dt`` s more, 1 - share to 1 + share; its mean is 1."""
        self._at = at = self._at + self._rate_hz * dt
        if at >= 1.0:
            self._at = at = at % 1.0
            period = 1.0 + PERIOD_SIGMA * self._noise.next()
            self._rate_hz = self._frequency_hz / (period if period > _LEAST_PERIOD else _LEAST_PERIOD)
        rising = 1.0 - SLIP_SHARE
        wave = 2.0 * at / rising - 1.0 if at < rising else 1.0 - 2.0 * (at - rising) / SLIP_SHARE
        return 1.0 + self._share * wave
