"""A compound and a road for the tests of ``sim.physics.greta``: a modulus in closed form, invented [A]."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from sim.physics.materials import Rubber, Shear, Sinusoid, Surface

if TYPE_CHECKING:
    from sim.physics.materials import Array, Complex

RELAXED_PA, GLASSY_PA = 7e6, 2e9
"""Of E' at 1 Hz, far above and far below the glass transition."""


@dataclass(frozen=True)
class Sigmoid:
    """E'(T, 1 Hz) between two plateaus, tan d with a maximum at -15 degC, 8 K a decade of frequency (paper G, Eq 9)."""

    stiffer: float = 1.0

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G*."""
        at = temperature_c - 8.0 * np.log10(np.asarray(rate_rad_s) / (2.0 * pi))
        lowest, highest = np.log10(RELAXED_PA), np.log10(GLASSY_PA)
        storage = self.stiffer * 10.0 ** (lowest + (highest - lowest) / (1.0 + np.exp((at + 25.0) / 6.0)))
        tan_delta = 0.12 + 0.55 * np.exp(-(((at + 15.0) / 18.0) ** 2))
        return storage / 3.0 * (1.0 + 1j * tan_delta)


SHEAR = Shear(strength_pa=1.2e4, speed_m_s=1.0, exponent=0.6, ratio=GLASSY_PA / RELAXED_PA)


def rubber(stiffer: float = 1.0, shear: Shear | None = SHEAR) -> Rubber:
    """Return the compound, or a ``stiffer`` one of the same losses."""
    return Rubber("demonstration", Sigmoid(stiffer), shear=shear)


def road(ra_mm: float = 0.8) -> Surface:
    """Return a road of a wave of 9.9 mm and one of a hundredth of that."""
    return Surface("road", coarse=Sinusoid(9.9e-3, 1e-3 * ra_mm), fine=Sinusoid(9.9e-5, 1e-5 * ra_mm))
