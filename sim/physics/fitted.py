"""Laws of materials with the figures that a fit found: ``persson`` up to a wave number, ``greta`` with its own shear.

A fit of ``persson`` finds the largest wave number q1 that the rubber follows (paper S, section 8); one of ``greta``
the shear strength of the contact, tau_s0, v_c and n (paper G, Eq 12). The rest is that of the compound and the surface.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics.materials import Rubber, Shear, Spectrum, Surface

if TYPE_CHECKING:
    from sim.physics.laws import LawOfParts
    from sim.physics.materials import Array

FITTED_FIGURES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {"persson": ("q1",), "greta": ("tau_s0", "v_c", "n")}
)
"""The figures that a fit finds, by the name of the law: 1/m; Pa, m/s and a number."""


@dataclass(frozen=True, slots=True)
class SpectrumUpTo:
    """A measured spectrum up to a smaller wave number."""

    whole: Spectrum
    q1_1_m: float

    @property
    def band_1_m(self) -> tuple[float, float]:
        """Return q0 and q1 in 1/m."""
        return self.whole.band_1_m[0], self.q1_1_m

    @property
    def rms_height_m(self) -> float:
        """Return that of the whole: long waves make it."""
        return self.whole.rms_height_m

    @property
    def rms_slope(self) -> float:
        """Return the root of the mean square slope, 2 pi int q^3 C dq up to q1."""
        q = np.geomspace(*self.band_1_m, 2001)
        y = q**3 * self.power_m4(q)
        return float(np.sqrt(pi * np.sum((y[1:] + y[:-1]) * np.diff(q))))

    def power_m4(self, q_1_m: Array) -> Array:
        """Return C(q) in m^4."""
        return self.whole.power_m4(q_1_m)


def fitted_law(form: str, rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> LawOfParts:
    """Return the law of a rubber on a surface with a fit's figures, and ``area`` in mm2.

    Raises ValueError where rubber, surface or figures are unsuitable.
    """
    from sim.physics.greta import greta  # numpy takes a tenth of a second to import: only when a law needs it
    from sim.physics.persson import persson

    known = FITTED_FIGURES[form]
    found = {name: figures[name] for name in known}
    rest = {name: value for name, value in figures.items() if name not in known}
    if form == "persson":
        on = replace(surface, spectrum=_up_to(surface, found["q1"]))
        return persson(rubber, on, rest.pop("area"), rest)
    if rubber.shear is None:
        raise ValueError(f"compound {rubber.name!r}: greta needs its shear (ratio)")
    shear = Shear(found["tau_s0"], found["v_c"], found["n"], rubber.shear.ratio)
    return greta(replace(rubber, shear=shear), surface, rest)


def _up_to(surface: Surface, q1_1_m: float) -> Spectrum | None:
    from sim.physics.roughness import SelfAffine

    spectrum = surface.spectrum
    if spectrum is None:
        return None  # the law says what it needs
    if isinstance(spectrum, SelfAffine):
        return replace(spectrum, q1_1_m=q1_1_m)
    low, high = spectrum.band_1_m
    if not low < q1_1_m <= high:
        raise ValueError(f"surface {surface.name!r}: q1 {q1_1_m:g} 1/m is outside its spectrum, {low:g} to {high:g}")
    return SpectrumUpTo(spectrum, q1_1_m)
