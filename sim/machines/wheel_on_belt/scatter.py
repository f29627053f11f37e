"""Scatter of the rubber: what multiplies the friction of a wheel, a setting, a repeat.

A setting has one factor for each compound, however often a recipe measures it, on whichever wheel, in whichever place:
it is how far the model misses the rubber there. What differs from wheel to wheel is the wheel's own.
"""

from __future__ import annotations

import zlib
from typing import NamedTuple

from sim.noise import normal
from sim.physics.parameters import SimParameters


def wheel_factor(parameters: SimParameters, seed: int, specimen: int, wheel: int) -> float:
    """Return what multiplies the friction of one wheel."""
    sigma = parameters.scatter * parameters.variability.wheel
    return 1.0 + sigma * normal(seed, "wheel", specimen, wheel)


class WheelSetting(NamedTuple):
    """What a condition is held at, as far as friction depends on it: slip m/s, load N, angles deg, surface degC."""

    slip_m_s: float
    load_n: float
    angles_deg: tuple[float, ...]
    """Of the driven angles, in the order of the machine's axes."""
    temperature_c: float

    @property
    def key(self) -> tuple[int, ...]:
        """Return whole numbers of at least 0 that are the same for the same setting.

        In steps of 0.1 mm/s, 0.1 N, 0.01 deg and 0.1 K, finer than a rig holds any of them. Slip and angles without
        their sign, as in the friction law.
        """
        return (
            round(1e4 * abs(self.slip_m_s)),
            round(10.0 * self.load_n),
            *(round(100.0 * abs(angle)) for angle in self.angles_deg),
            round(10.0 * (self.temperature_c + 273.0)),
        )


def condition_factor(parameters: SimParameters, seed: int, compound: str, setting: WheelSetting) -> float:
    """Return what multiplies the friction of a compound at a setting: how far the model misses it."""
    sigma = parameters.scatter * parameters.variability.condition(compound)
    return 1.0 + sigma * normal(seed, "condition", zlib.crc32(compound.encode()), *setting.key)


def run_factor(parameters: SimParameters, seed: int, *place: int) -> float:
    """Return what multiplies the friction of one repeat (specimen, wheel, condition, repeat, attempt)."""
    return 1.0 + parameters.scatter * parameters.variability.run * normal(seed, "run", *place)
