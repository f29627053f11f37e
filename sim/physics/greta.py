"""Adhesion and hysteresis of a rubber on a track of two waves (Farroni and others, GrETA; here paper G).

With E = |E*| and tan d of the rubber at a frequency and temperature, v the sliding speed, p the mean pressure:

    tau_s = tau_s0 [1 + (Einf / E0) / (1 + v_c / v)^n]                                 Eq 12
    Ac / A0 = 2 p / (E sqrt(pi m2)), at most 1;  m2 = (2 pi Ra / l)^2 / 2              Eq 13, the fine wave
    mu_adh = (tau_s / p) (Ac / A0)                                                     Eq 11, E at f = v / l fine
    mu_hys = pi tan d int_V s1^2 dV / (l E p A0)                                       Eq 20, E, tan d at v / l coarse

The formulas are those of the paper after repair (docs/explanation/errata-of-the-two-papers.md); the stress s1 is that
of ``sim.physics.scratch``, with K, the friction that the stress sees, the adhesion, but at most ``friction_limit``.
How frequency and temperature stand for each other (Eq 9) the modulus knows. Adhesion does not depend on the pressure
until the contact is full.

The paper prints no parameters: coefficients of this law are only as good as those that it is given, and nothing
measured is known to agree with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from math import isfinite, pi, sqrt
from typing import TYPE_CHECKING, Annotated, Final, NamedTuple

import numpy as np

from sim.physics.materials import Components
from sim.physics.scratch import Scratch

if TYPE_CHECKING:
    from sim.physics.materials import Array, Rubber, Shear, Sinusoid, Surface

SLOWEST_M_S: Final = 1e-6
"""Slower sliding has the coefficient of this speed: adhesion has reached that of slow sliding by then [A]."""


@dataclass(frozen=True, slots=True)
class GretaParameters:
    """What the law needs beside a rubber and a surface."""

    area: Annotated[float, "mm2"] = 100.0  # [A] of the contact, over which the load is spread evenly
    tread: Annotated[float, "mm"] = 10.0  # [A] height of the rubber that is cycled
    friction_limit: Annotated[float, "1"] = 1.0  # [A] K at most: shear of adhesion above it would outgrow the pressure

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        for item in fields(self):
            value: float = getattr(self, item.name)
            least = value >= 0.0 if item.name == "friction_limit" else value > 0.0
            if not (isfinite(value) and least):
                raise ValueError(f"GretaParameters.{item.name} must be finite and above 0, not {value!r}")


class Dynamic(NamedTuple):
    """A rubber's modulus in tension at one frequency."""

    magnitude_pa: float
    """E = |E*|"""
    tan_delta: float


def shear_strength_pa(shear: Shear, v_m_s: float) -> float:
    """Return tau_s (Eq 12) at a speed above 0."""
    return shear.strength_pa * (1.0 + shear.ratio / (1.0 + shear.speed_m_s / v_m_s) ** shear.exponent)


def mean_square_slope(wave: Sinusoid) -> float:
    """Return m2 of a wave's profile; with its Ra taken for the amplitude, as the paper does."""
    return 0.5 * (2.0 * pi * wave.ra_m / wave.wavelength_m) ** 2


def contact_slope(wave: Sinusoid) -> float:
    """Return sqrt(pi m2) / 2: the pressure of full contact over the modulus, by Eq 13."""
    return 0.5 * sqrt(pi * mean_square_slope(wave))


class Greta:
    """The law of one rubber on one surface."""

    def __init__(self, rubber: Rubber, surface: Surface, parameters: GretaParameters | None = None) -> None:
        """Take the materials. Raises ValueError where one of them lacks what the law needs."""
        if rubber.shear is None:
            raise ValueError(f"compound {rubber.name!r}: greta needs its shear (tau_s0, v_c, n, ratio)")
        if surface.coarse is None or surface.fine is None:
            raise ValueError(f"surface {surface.name!r}: greta needs its two waves, coarse and fine")
        self.rubber = rubber
        self.parameters = parameters if parameters is not None else GretaParameters()
        self.coarse, self.fine = surface.coarse, surface.fine
        self.full_per_modulus = pi * self.coarse.ra_m / (self.coarse.wavelength_m * (1.0 - rubber.poisson**2))
        """Pressure of full contact with the coarse wave over the modulus there (Eqs 21 and 22)."""
        self._shear = rubber.shear
        self._scratch = Scratch(self.coarse.wavelength_m, 1e-3 * self.parameters.tread)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient. Raises OutsideError, PoleError where the modulus is not known."""
        return sum(self.components(temperature_c, load_n, slip_m_s))

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion and hysteresis; raises as ``mu``."""
        v = max(slip_m_s, SLOWEST_M_S)
        pressure_pa = self.pressure_pa(load_n)
        coarse, fine = self.dynamic(temperature_c, v)
        share = min(1.0, pressure_pa / (fine.magnitude_pa * contact_slope(self.fine)))
        adhesion = shear_strength_pa(self._shear, v) / pressure_pa * share
        return Components(adhesion, self.hysteresis(pressure_pa, coarse, adhesion))

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield that a speed is below the slowest, and that the contact is full; raises as ``mu``."""
        if slip_m_s < SLOWEST_M_S:
            yield f"below {1e3 * SLOWEST_M_S:g} mm/s the coefficient is that of this speed"
        _, fine = self.dynamic(temperature_c, max(slip_m_s, SLOWEST_M_S))
        full_pa = fine.magnitude_pa * contact_slope(self.fine)
        pressure_pa = self.pressure_pa(load_n)
        if pressure_pa > full_pa:
            yield (
                f"at {1e-6 * pressure_pa:.3g} MPa the contact is full ({1e-6 * full_pa:.3g} MPa would do): the law's"
                " contact is of a pressure below that"
            )

    def hysteresis(self, pressure_pa: float, dynamic: Dynamic, friction: float) -> float:
        """Return mu_hys (Eq 20) under a pressure; ``friction``: K, of which more than the limit does not count."""
        normal_m, shear_m = self.stress_m(pressure_pa / (dynamic.magnitude_pa * self.full_per_modulus))
        squares_m = normal_m + min(friction, self.parameters.friction_limit) ** 2 * shear_m
        return pi * dynamic.tan_delta * squares_m * pressure_pa / (self.coarse.wavelength_m * dynamic.magnitude_pa)

    def stress_m(self, share: float) -> tuple[float, float]:
        """Return int s1^2 dV over p^2 A0, of pressure alone and what K^2 multiplies; ``share``: of full contact."""
        return self._scratch.parts_m(share)

    def pressure_pa(self, load_n: float) -> float:
        """Return the mean pressure under a load above 0."""
        return 1e6 * load_n / self.parameters.area

    def dynamic(self, temperature_c: float, v_m_s: float) -> tuple[Dynamic, Dynamic]:
        """Return the modulus as the coarse and the fine wave see it; raises as ``mu``."""
        lengths = np.array([self.coarse.wavelength_m, self.fine.wavelength_m])
        rates: Array = 2.0 * pi * v_m_s / lengths
        found = 2.0 * (1.0 + self.rubber.poisson) * self.rubber.modulus.complex_pa(rates, temperature_c)
        coarse, fine = (Dynamic(abs(complex(one)), float(one.imag / one.real)) for one in found)
        return coarse, fine


def greta(rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> Greta:
    """Return the law of a rubber on a surface with these figures (keys of GretaParameters). Raises ValueError."""
    known = [item.name for item in fields(GretaParameters)]
    unknown = [name for name in figures if name not in known]
    if unknown:
        raise ValueError(f"compound {rubber.name!r}: greta has no {', '.join(unknown)}; it has {', '.join(known)}")
    return Greta(rubber, surface, GretaParameters(**figures))
