"""The final value of a settling temperature and its uncertainty, from a fit of its tail before it has settled."""

from __future__ import annotations

from math import isfinite, nan, sqrt
from typing import Final

import numpy as np

MEAN_S: Final = 5.0
"""Averaging time of the fitted means, s [A]."""
PAST_SHARE: Final = 0.75
"""The tail begins once the rate of rise is down to this share of its maximum [A]: the faster modes have decayed."""
TAIL: Final = 12
"""Least number of fitted means: a minute."""
TIMES_S: Final = np.geomspace(20.0, 1000.0, 200)
"""Time constants to try, s."""


class SettlingFit:
    """Means of a temperature over ``MEAN_S`` each, and the final value of their tail."""

    def __init__(self) -> None:
        """Begin without readings."""
        self.means: list[float] = []

    def add(self, mean: float) -> None:
        """Add a mean, in any unit."""
        self.means.append(mean)

    def going(self) -> tuple[float, float]:
        """Return the tail's final value and its standard uncertainty; NaN while the tail is too short.

        y(t) = end - step exp(-t / T): least squares for end and step at each T of ``TIMES_S``; the best T's rows of
        d y / d (end, step, T) give the uncertainty, the residuals the noise.
        """
        tail = self._tail()
        count = len(tail)
        if count < TAIL:
            return nan, nan
        times = MEAN_S * np.arange(count)
        decays = np.exp(-times[None, :] / TIMES_S[:, None])
        centred, wanted = decays - decays.mean(axis=1, keepdims=True), tail - tail.mean()
        squares = (centred * centred).sum(axis=1)
        slopes = (centred @ wanted) / squares
        left = ((wanted[None, :] - slopes[:, None] * centred) ** 2).sum(axis=1)
        best = int(np.argmin(left))
        if best in (0, len(TIMES_S) - 1):
            return nan, nan
        decay, slope, time = decays[best], float(slopes[best]), float(TIMES_S[best])
        end = float(tail.mean()) - slope * float(decay.mean())
        rows = np.stack([np.ones(count), decay, slope * times / time**2 * decay], axis=1)
        noise = float(left[best]) / (count - 3)
        variance = float(np.linalg.pinv(rows.T @ rows)[0, 0]) * noise
        return (end, sqrt(variance)) if isfinite(variance) else (nan, nan)

    def _tail(self) -> np.ndarray:
        """Return the means of the tail: those after the maximum rate of rise, see ``PAST_SHARE``."""
        means = np.asarray(self.means)
        if len(means) < 2 * TAIL:
            return means[:0]
        smooth = np.convolve(means, np.ones(4) / 4.0, mode="valid")
        rises = np.abs(smooth[4:] - smooth[:-4])
        peak = int(np.argmax(rises))
        past = np.flatnonzero(rises[peak:] <= PAST_SHARE * rises[peak])
        return means[peak + int(past[0]) + 4 :] if len(past) else means[:0]
