"""The law ``persson`` (``sim.physics.persson``) for many conditions and many upper ends q1 of the spectrum at once.

The share of contact at a wave number depends only on smaller wave numbers. One integral up to the largest q1 therefore
serves every q1: its running value at a lower q1 is the coefficient for that q1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import log
from typing import Final

import numpy as np

from sim.physics.materials import OutsideError, Rubber, Surface
from sim.physics.persson import PerssonLaw
from sim.physics.roughness import SelfAffine
from sim.physics.wlf import PoleError
from tester.analysis.fit.fit_law import Band, FitError, Law
from tester.base.arrays import Array
from tester.kinds.specimen_on_track.fit.laws import PERSSON, below_glass
from tester.kinds.specimen_on_track.fit.nodes import GridAxis, GridNodes
from tester.kinds.specimen_on_track.fit.run_data import LOAD, SPEED, TEMPERATURE

AREA_MM2: Final = 100.0
"""Default contact area [A]; the load is spread evenly over it."""
BEYOND: Final = 30.0
"""A self-affine spectrum may extend to this many times the q1 of its file; a measured spectrum is not extended."""
END: Final = 1.01
"""A q1 within this factor of an end of the spectrum is a search limit, not a fitted value [A]."""
_AXES: Final = (GridAxis(-150.0, 250.0, 1.0), GridAxis(-9.0, 4.0, 0.1), GridAxis(2.0, 9.0, 0.2))
"""Temperature in degC, decades of the speed in m/s and of the pressure in Pa. Coefficients are
interpolated linearly: the error is at most 0.3 % over a bell of three decades."""
_PANELS, _NODES = 100, 16


def bound(rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> Law:
    """Return the law of a rubber on a surface; ``figures``: area in mm2. Raises ValueError for unusable inputs."""
    unknown = [name for name in figures if name != "area"]
    area_mm2 = figures.get("area", AREA_MM2)
    if unknown or not area_mm2 > 0.0:
        raise ValueError(f"law persson is given area, above 0 mm2, not {', '.join(unknown) or area_mm2}")
    spectrum = surface.spectrum
    if spectrum is None:
        raise ValueError(f"surface {surface.name!r} has no spectrum of heights, which law persson needs")
    start = spectrum.band_1_m[1]
    if isinstance(spectrum, SelfAffine):
        spectrum = replace(spectrum, q1_1_m=BEYOND * start)
    law = PerssonLaw(rubber.modulus, rubber.poisson, spectrum, _PANELS, _NODES)
    many = _ManyPersson(law, spectrum.band_1_m, rubber.name, area_mm2)
    first, last = spectrum.band_1_m
    band = Band(END * first, last / END, f"the spectrum of surface {surface.name}")
    q1 = replace(PERSSON.parameters[0], start=start, band=band)
    return replace(PERSSON, value=many.value, parameters=(q1,), beyond=partial(below_glass, rubber.glass_c))


class _ManyPersson:
    """The law with its table of running integrals."""

    def __init__(self, law: PerssonLaw, band_1_m: tuple[float, float], rubber: str, area_mm2: float) -> None:
        self._law, self._rubber, self._per_n = law, rubber, 1e6 / area_mm2
        self._low, self._span = log(band_1_m[0]), log(band_1_m[1] / band_1_m[0])
        self._nodes = GridNodes(_AXES, self._up_to)

    def value(self, p: Array, x: Array) -> Array:
        """Return coefficients (``Law.value``). Raises FitError where the modulus is unknown."""
        last = 2 * _PANELS
        reached = np.clip((np.log(p[..., 0, None]) - self._low) / self._span, 0.0, 1.0)
        at = np.minimum(last * reached**0.25, last - 1e-6)  # the integral's points are evenly spaced in this
        below = np.floor(at).astype(np.intp)
        on = at - below
        pressure = np.log10(self._per_n * x[..., LOAD])
        found = np.zeros(np.broadcast_shapes(at.shape, pressure.shape))
        for row, weight in self._nodes.corners(x[..., TEMPERATURE], np.log10(x[..., SPEED]), pressure):
            values = self._nodes.values
            found = found + weight * (values[row, below] * (1.0 - on) + values[row, below + 1] * on)
        return found

    def _up_to(self, at: Sequence[float]) -> Array:
        try:
            return self._law.contact(at[0], 10.0 ** at[2], 10.0 ** at[1]).mu_up_to
        except (OutsideError, PoleError) as error:
            raise FitError(f"compound {self._rubber!r}: {error}") from error
