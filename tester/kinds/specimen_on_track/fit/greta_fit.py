"""The law ``greta`` (``sim.physics.greta``) for many conditions and many sets of parameters at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import pi
from typing import Final

import numpy as np

from sim.physics.greta import Greta, contact_slope, greta
from sim.physics.materials import OutsideError, Rubber, Surface
from sim.physics.wlf import PoleError
from tester.analysis.fit.fit_law import FitError, Law
from tester.base.arrays import Array
from tester.kinds.specimen_on_track.fit.laws import GRETA, below_glass
from tester.kinds.specimen_on_track.fit.nodes import GridAxis, GridNodes
from tester.kinds.specimen_on_track.fit.run_data import LOAD, SPEED, TEMPERATURE

CELSIUS: Final = GridAxis(-150.0, 250.0, 0.5)
DECADES: Final = GridAxis(-9.0, 4.0, 0.05)
"""Decades of the speed in m/s. Between nodes the logarithm of a modulus is interpolated linearly: the error is at most
0.1 % where it changes by a factor of 300 over 30 K."""
SHARES: Final = np.linspace(-8.0, 8.0, 1601)
"""Decades of pressure over full-contact pressure at which the stress is computed; linear between them."""


def bound(rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> Law:
    """Return the law of a rubber on a surface; ``figures``: values of GretaParameters.

    Raises ValueError where rubber or surface lacks data. The rubber gives the ratio of the moduli of glass and
    rubber, but none of the fitted values.
    """
    law = greta(rubber, surface, figures)
    assert rubber.shear is not None  # greta() needs it
    beyond = partial(below_glass, rubber.glass_c)
    return replace(GRETA, value=_ManyGreta(law, rubber.shear.ratio).value, beyond=beyond)


class _ManyGreta:
    """The law with its tables of moduli and stress."""

    def __init__(self, law: Greta, ratio: float) -> None:
        self._law, self._ratio = law, ratio
        self._nodes = GridNodes((CELSIUS, DECADES), self._moduli)
        parts: Array = np.log([law.stress_m(10.0**decades) for decades in SHARES])
        self._normal, self._shear = parts[:, 0], parts[:, 1]

    def value(self, p: Array, x: Array) -> Array:
        """Return coefficients (``Law.value``). Raises FitError where the modulus is unknown."""
        law = self._law
        strength, v_c, n = (p[..., i, None] for i in range(3))
        v, pressure = x[..., SPEED], law.pressure_pa(1.0) * x[..., LOAD]
        corners = self._nodes.corners(x[..., TEMPERATURE], np.log10(v))
        found = sum((weight[..., None] * self._nodes.values[row] for row, weight in corners), np.zeros(3))
        fine, coarse, tan_delta = np.exp(found[..., 0]), np.exp(found[..., 1]), found[..., 2]
        with np.errstate(over="ignore"):  # a search may step where the power overflows; tau stays finite
            tau = strength * (1.0 + self._ratio / (1.0 + v_c / v) ** n)
        adhesion = tau * np.minimum(1.0 / pressure, 1.0 / (fine * contact_slope(law.fine)))
        friction = np.minimum(adhesion, law.parameters.friction_limit)
        share: Array = np.log10(pressure / (coarse * law.full_per_modulus))
        normal, shear = (np.exp(np.interp(share, SHARES, one)) for one in (self._normal, self._shear))
        factor = pi * tan_delta * pressure / (law.coarse.wavelength_m * coarse)
        return np.asarray(adhesion + factor * (normal + friction**2 * shear))

    def _moduli(self, at: Sequence[float]) -> Array:
        """Return ln E at the fine wave, then ln E and tan d at the coarse wave."""
        try:
            coarse, fine = self._law.dynamic(at[0], 10.0 ** at[1])
        except (OutsideError, PoleError) as error:
            raise FitError(f"compound {self._law.rubber.name!r}: {error}") from error
        return np.array([np.log(fine.magnitude_pa), np.log(coarse.magnitude_pa), coarse.tan_delta])
