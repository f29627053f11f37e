"""Faults of any sensor: what it shows instead of what is."""

from __future__ import annotations

from collections import deque
from math import expm1, nan
from typing import Final

from sim.noise import NormalStream

KINDS: Final = ("offset", "drift", "noise", "low", "gain", "lag", "delay", "open", "saturated", "frozen")
SLOW: Final = ("lag", "delay")
SEED: Final = 402
"""Key of the random numbers of noisy sensors: the same in every run."""
_OFF_SCALE_N: Final = 1e5
"""More than any load cell here can show, N: the transmitter shows the end of its range."""


class Slow:
    """Readings that come through a filter of first order ("lag"), or as they were some time ago ("delay")."""

    __slots__ = ("_delays", "_held", "_last_s", "_past", "_seconds")

    def __init__(self, kind: str, seconds: float) -> None:
        """With this time constant, or this late, s (at least 0)."""
        self._delays = kind == "delay"
        self._seconds = max(seconds, 1e-9)
        self._held: tuple[float, ...] = ()
        self._last_s = 0.0
        self._past: deque[tuple[float, tuple[float, ...]]] = deque()

    def shown(self, readings: tuple[float, ...], t: float) -> tuple[float, ...]:
        """Return what is shown at ``t`` s where the sensor has these readings now."""
        if self._delays:
            past = self._past
            past.append((t, readings))
            while len(past) > 1 and past[1][0] <= t - self._seconds:
                past.popleft()
            return past[0][1]
        if self._held:
            share = -expm1((self._last_s - t) / self._seconds)
            self._held = tuple(h + (r - h) * share for h, r in zip(self._held, readings, strict=True))
        else:
            self._held = readings
        self._last_s = t
        return self._held


def spoiled(kind: str, value: float, size: float, age_s: float, noise: NormalStream, floor: float) -> float:
    """Return what a sensor shows of ``value``: off by ``size``, drifting by ``size`` a second, noisy (rms ``size``),
    low (the share of ``size`` percent above ``floor`` is missing), with a gain of ``size`` percent above ``floor``, off
    scale, or nothing (not a number)."""
    if kind == "offset":
        return value + size
    if kind == "drift":
        return value + size * age_s
    if kind == "noise":
        return value + size * noise.next()
    if kind == "low":
        return floor + (value - floor) * (1.0 - 0.01 * size)
    if kind == "gain":
        return floor + (value - floor) * 0.01 * size
    return _OFF_SCALE_N if kind == "saturated" else nan
