"""Scatter of the rubber: what multiplies the friction of a wheel, a condition, a repeat."""

from __future__ import annotations

import math
import zlib

from sim.noise import mean_of_autoregressive, normal
from sim.physics.parameters import SimParameters


def wheel_factor(parameters: SimParameters, seed: int, specimen: int, wheel: int) -> float:
    """Return what multiplies the friction of one wheel."""
    sigma = parameters.scatter * parameters.variability.wheel
    return 1.0 + sigma * normal(seed, "wheel", specimen, wheel)


def condition_factor(parameters: SimParameters, seed: int, compound: str, condition: int) -> float:
    """Return what multiplies the friction of a compound in one condition: how far the model misses it."""
    sigma = parameters.scatter * parameters.variability.condition(compound)
    return 1.0 + sigma * normal(seed, "condition", zlib.crc32(compound.encode()), condition)


def run_factor(parameters: SimParameters, seed: int, *place: int) -> float:
    """Return what multiplies the friction of one repeat (specimen, wheel, condition, repeat, attempt)."""
    return 1.0 + parameters.scatter * parameters.variability.run * normal(seed, "run", *place)


def stated_sigma(parameters: SimParameters, compound: str, repeats: int, window_s: float) -> float:
    """Return the relative standard deviation by which the mean of a condition's repeats misses the model.

    Wheel and condition scatter in full, repeat-to-repeat scatter and the fluctuation within a window of
    ``window_s`` (total accepted time of one repeat, s) divided by the root of ``repeats``. Sensor
    imperfections are not in it. Raises KeyError for a compound without a friction model.
    """
    v = parameters.variability
    within = mean_of_autoregressive(v.within, v.within_time, window_s)
    variance = v.wheel**2 + v.condition(compound) ** 2 + (v.run**2 + within**2) / repeats
    return parameters.scatter * math.sqrt(variance)
