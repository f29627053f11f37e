"""The law ``greta`` (``sim.physics.greta``) for many conditions and many sets of parameters at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics.greta import Greta, contact_slope, greta
from sim.physics.materials import OutsideError, Rubber, Surface
from sim.physics.wlf import PoleError
from tester.fit.law import FitError, Law
from tester.kinds.specimen_on_track.fit.laws import GRETA
from tester.kinds.specimen_on_track.fit.runs import LOAD, SPEED, TEMPERATURE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_COLDEST_C, _HOTTEST_C, _STEP_K = -150.0, 250.0, 0.5
_SLOWEST, _FASTEST, _STEP = -9.0, 4.0, 0.05
"""Nodes of the moduli: temperature in degC, decades of the speed in m/s. Between them the logarithm of the modulus is
taken as straight, which is right within 0.1 % where it changes by a factor of 300 over 30 K."""
_SHARES: Final = np.linspace(-8.0, 8.0, 1601)
"""Decades of the pressure over that of full contact at which the stress is worked out; straight between them."""


def bound(rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> Law:
    """Return the law of a rubber on a surface with figures (of GretaParameters).

    Raises ValueError where one of them lacks what it needs. What is fitted is not taken from the rubber; the ratio of
    the moduli of glass and rubber is.
    """
    law = greta(rubber, surface, figures)
    assert rubber.shear is not None  # a law has been made of it
    return replace(GRETA, value=_Many(law, rubber.shear.ratio).value)


class _Many:
    """The law with its tables."""

    def __init__(self, law: Greta, ratio: float) -> None:
        self._law, self._ratio = law, ratio
        shape = (round((_HOTTEST_C - _COLDEST_C) / _STEP_K) + 1, round((_FASTEST - _SLOWEST) / _STEP) + 1)
        self._nodes = np.full((3, *shape), np.nan)
        """ln E at the fine wave, ln E and tan d at the coarse one; NaN: not worked out yet."""
        parts = np.array([law.stress_m(10.0**decades) for decades in _SHARES])
        self._normal, self._shear = np.log(parts).T

    def value(self, p: Array, x: Array) -> Array:
        """Return coefficients (``Law.value``). Raises FitError where the modulus is not known."""
        law = self._law
        strength, v_c, n = (p[..., i, None] for i in range(3))
        v, pressure = x[..., SPEED], law.pressure_pa(1.0) * x[..., LOAD]
        fine, coarse, tan_delta = self._moduli(x[..., TEMPERATURE], v)
        tau = strength * (1.0 + self._ratio / (1.0 + v_c / v) ** n)
        adhesion = tau * np.minimum(1.0 / pressure, 1.0 / (fine * contact_slope(law.fine)))
        friction = np.minimum(adhesion, law.parameters.friction_limit)
        share = np.log10(pressure / (coarse * law.full_per_modulus))
        normal, shear = (np.exp(np.interp(share, _SHARES, one)) for one in (self._normal, self._shear))
        factor = pi * tan_delta * pressure / (law.coarse.wavelength_m * coarse)
        return np.asarray(adhesion + factor * (normal + friction**2 * shear))

    def _moduli(self, temperature_c: Array, v_m_s: Array) -> tuple[Array, Array, Array]:
        """Return E at the fine wave, E and tan d at the coarse one."""
        i, up = _place(temperature_c, _COLDEST_C, _STEP_K, self._nodes.shape[1])
        j, right = _place(np.log10(v_m_s), _SLOWEST, _STEP, self._nodes.shape[2])
        for di in (0, 1):
            for dj in (0, 1):
                self._work_out(i + di, j + dj)
        found: list[Array] = []
        for nodes in self._nodes:
            low = nodes[i, j] * (1.0 - right) + nodes[i, j + 1] * right
            high = nodes[i + 1, j] * (1.0 - right) + nodes[i + 1, j + 1] * right
            found.append(low * (1.0 - up) + high * up)
        return np.exp(found[0]), np.exp(found[1]), found[2]

    def _work_out(self, i: NDArray[np.intp], j: NDArray[np.intp]) -> None:
        missing = np.isnan(self._nodes[0][i, j])
        if not missing.any():
            return
        for row, column in sorted({*zip(i[missing].tolist(), j[missing].tolist(), strict=True)}):
            at_c, at_m_s = _COLDEST_C + _STEP_K * row, 10.0 ** (_SLOWEST + _STEP * column)
            try:
                coarse, fine = self._law.dynamic(at_c, at_m_s)
            except (OutsideError, PoleError) as error:
                raise FitError(f"compound {self._law.rubber.name!r}: {error}") from error
            self._nodes[:, row, column] = np.log(fine.magnitude_pa), np.log(coarse.magnitude_pa), coarse.tan_delta


def _place(values: Array, first: float, step: float, count: int) -> tuple[NDArray[np.intp], Array]:
    """Return the node below each value, and how far on to the next it lies, 0 to 1; beyond the ends those hold."""
    at = np.clip((values - first) / step, 0.0, count - 1.000001)
    below = np.floor(at)
    return below.astype(np.intp), at - below
