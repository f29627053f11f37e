"""A cubic through points that never overshoots them: Fritsch and Carlson's, with slopes of Fritsch and Butland."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim.physics.materials import Array


class MonotoneCubic:
    """y(x), once differentiable; between two points it stays between their values. Outside it is not defined."""

    def __init__(self, x: Array, y: Array) -> None:
        """Take at least two points, x strictly ascending."""
        self._x, self._y = x, y
        step = np.diff(x)
        rise = np.diff(y) / step
        slope = np.empty_like(y)
        if len(x) == 2:
            slope[:] = rise[0]
        else:
            slope[1:-1] = _inner(step, rise)
            slope[0] = _end(step[0], step[1], rise[0], rise[1])
            slope[-1] = _end(step[-1], step[-2], rise[-1], rise[-2])
        self._slope, self._step = slope, step

    def __call__(self, at: Array) -> Array:
        """Return y, of the shape of ``at``."""
        i = np.clip(np.searchsorted(self._x, at, side="right") - 1, 0, len(self._x) - 2)
        h = self._step[i]
        t = (at - self._x[i]) / h
        s = 1.0 - t
        return (
            self._y[i] * (s * s * (1.0 + 2.0 * t))
            + self._y[i + 1] * (t * t * (3.0 - 2.0 * t))
            + h * (self._slope[i] * (t * s * s) - self._slope[i + 1] * (t * t * s))
        )


def _inner(step: Array, rise: Array) -> Array:
    """Return the slopes at inner points: weighted harmonic means, 0 where the rise changes its sign."""
    left, right = rise[:-1], rise[1:]
    same = left * right > 0.0
    weight, other = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    safe_left, safe_right = np.where(same, left, 1.0), np.where(same, right, 1.0)
    return np.where(same, (weight + other) / (weight / safe_left + other / safe_right), 0.0)


def _end(step: float, next_step: float, rise: float, next_rise: float) -> float:
    """Return the slope at an end: three points' one, limited to keep the shape."""
    slope = ((2.0 * step + next_step) * rise - step * next_rise) / (step + next_step)
    if slope * rise <= 0.0:
        return 0.0
    if rise * next_rise <= 0.0 and abs(slope) > 3.0 * abs(rise):
        return 3.0 * rise
    return slope
