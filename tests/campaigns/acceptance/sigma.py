"""Expected difference between the mean of repeats and the model, from the twin's standard deviations."""

from __future__ import annotations

import math

from sim.physics.parameters import SimParameters


def mean_of_autoregressive(sigma: float, time_s: float, window_s: float) -> float:
    """Return the standard deviation of the mean of an AR(1) fluctuation over a window of more than 0 s."""
    share = time_s / window_s
    return sigma * math.sqrt(2.0 * share * (1.0 - share * -math.expm1(-1.0 / share)))


def stated_sigma(parameters: SimParameters, compound: str, repeats: int, window_s: float) -> float:
    """Return the relative standard deviation of the mean of a condition's repeats about the model.

    Wheel and condition scatter in full, repeat-to-repeat scatter and the fluctuation within a window of ``window_s``
    (total accepted time of one repeat, s) divided by the root of ``repeats``. Excludes sensor imperfections. Raises
    KeyError for a compound without a friction model.
    """
    v = parameters.variability
    within = mean_of_autoregressive(v.within, v.within_time, window_s)
    variance = v.wheel**2 + v.condition(compound) ** 2 + (v.run**2 + within**2) / repeats
    return parameters.scatter * math.sqrt(variance)
