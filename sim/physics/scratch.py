"""Stress in rubber that slides over a wave of a track, and the energy lost in it: the base of hysteresis.

Paper G (Farroni and others, GrETA: adhesion and hysteresis of tread rubber), Eqs 20 to 22, plane strain across the
wave. A wave of length l and amplitude Ra is in contact with rubber of modulus E under the mean pressure p. They touch
over 2 N of each l (Eq 22, which is Westergaard's), under

    p(x) = 2 p cos(pi x / l) / sin^2(pi N / l) sqrt(sin^2(pi N / l) - sin^2(pi x / l)),   sin^2(pi N / l) = p / p_full,
    p_full = pi E Ra / (l (1 - nu^2)):

above p_full they touch everywhere, and p(x) = p + p_full cos(2 pi x / l). A harmonic P cos(kx) of this pressure, with
the shear K P cos(kx) of friction, causes at depth z of a half space, with u = kz,

    sz = -P (1 + u) e^-u cos(kx) + K P u e^-u sin(kx)
    sx = -P (1 - u) e^-u cos(kx) + K P (2 - u) e^-u sin(kx)
    sy = -P (1 - u) e^-u cos(kx)

sy is the stress along the crest. An asperity is as wide as it is long, so the pressure makes the same stress along it
as across it; shear acts along x alone. Across the crest, from its middle at t = 0 to the next valley at t = +-1, all
stresses fade as 1 - t^2, whose mean square is 8/15. The mean pressure (k = 0) presses the rubber evenly at any depth.
It does not alternate and dissipates nothing, so it is left out. The paper prints neither its stresses nor the fade;
these are this program's [A].
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from sim.physics.materials import Array

FADE: Final = 8.0 / 15.0
"""Mean of (1 - t^2)^2 over -1 to 1."""
HARMONICS: Final = 100
"""Number of harmonics of the pressure over a wave length."""
DEPTHS: Final = 50
"""Number of depths of the tread, for trapezia: the integral is 1.8 to 2.2 % above its limit for infinitely many."""


def normal_z(u: Array) -> Array:
    """Return the part of -sz from pressure, divided by P cos(kx)."""
    return (1.0 + u) * np.exp(-u)


def normal_x(u: Array) -> Array:
    """Return the part of -sx, and of -sy, from pressure, divided by P cos(kx)."""
    return (1.0 - u) * np.exp(-u)


def shear_x(u: Array) -> Array:
    """Return the part of sx from shear, divided by K P sin(kx)."""
    return (2.0 - u) * np.exp(-u)


def shear_z(u: Array) -> Array:
    """Return the part of sz from shear, divided by K P sin(kx)."""
    return u * np.exp(-u)


def harmonics(share: float, count: int) -> Array:
    """Return the amplitudes of cos(2 pi n x / l), n = 1 to ``count``, of the pressure in shares of its mean.

    ``share``: p / p_full, above 0; from 1 on rubber and wave touch everywhere. Below 1, with c = 1 - 2 share and the
    polynomials P of Legendre (P of -1 is 1), the integral of Westergaard's pressure times a cosine has a closed form:

        a_n = [(P_(n-1) - P_(n+1)) / (2n + 1) + (P_(n-2) - P_n) / (2n - 1)](c) / (1 - c)
    """
    found = np.zeros(count)
    if share >= 1.0:
        found[0] = 1.0 / share
        return found
    c = 1.0 - 2.0 * share
    before, now = 1.0, 1.0  # P_-1, P_0
    polynomials = [before, now]
    for n in range(count + 1):
        before, now = now, ((2 * n + 1) * c * now - n * before) / (n + 1)
        polynomials.append(now)
    p = np.array(polynomials)
    n = np.arange(1, count + 1)
    return ((p[1:-2] - p[3:]) / (2 * n + 1) + (p[:-3] - p[2:-1]) / (2 * n - 1)) / (2.0 * share)


class Scratch:
    """Integrals of the squared stress under a wave of some length, down to some depth."""

    def __init__(self, wavelength_m: float, depth_m: float, count: int = HARMONICS, depths: int = DEPTHS) -> None:
        """Calculate the parts that do not depend on the pressure, for these numbers. Raises ValueError for values out
        of range."""
        if not (wavelength_m > 0.0 and depth_m > 0.0):
            raise ValueError(f"a wave length and a depth are above 0 m, not {wavelength_m!r} and {depth_m!r}")
        if count < 1 or depths < 2:
            raise ValueError(f"a field has 1 harmonic and 2 depths or more, not {count} and {depths}")
        self._count = count
        depth = np.linspace(0.0, depth_m, depths)
        u = 2.0 * pi / wavelength_m * np.outer(np.arange(1, count + 1), depth)
        trapezia = np.full(depths, depth_m / (depths - 1))
        trapezia[[0, -1]] *= 0.5

        # Means over a wave length of cos^2 and sin^2 are 1/2.
        self._normal: Array = 0.5 * ((normal_z(u) ** 2 + 2.0 * normal_x(u) ** 2) @ trapezia)
        self._shear: Array = 0.5 * ((shear_x(u) ** 2 + shear_z(u) ** 2) @ trapezia)

    def parts_m(self, share: float) -> tuple[float, float]:
        """Return the mean over a square of l by l of int s1^2 dz, s1^2 = sx^2 + sy^2 + sz^2 in shares of p^2, in m.

        The result has two parts: of pressure alone, and the factor of K^2. ``share``: p / p_full, above 0. Products of
        cos and sin are 0 in the mean, so each harmonic adds by itself.
        """
        squares = FADE * harmonics(share, self._count) ** 2
        return float(squares @ self._normal), float(squares @ self._shear)
