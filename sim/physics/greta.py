"""Adhesion and hysteresis of a rubber on a track of two waves (Farroni and others, GrETA; here paper G).

With E = |E*| and tan d of the rubber at a frequency and temperature, v the sliding speed, p the mean pressure:

    tau_s = tau_s0 [1 + (Einf / E0) / (1 + v_c / v)^n]                                 Eq 12
    Ac / A0 = 2 p / (E sqrt(pi m2)), at most 1;  m2 = (2 pi Ra / l)^2 / 2              Eq 13, the fine wave
    mu_adh = (tau_s / p) (Ac / A0)                                                     Eq 11, E at f = v / l fine
    mu_hys = pi tan d int_V s1^2 dV / (l E p A0)                                       Eq 20, E, tan d at v / l coarse

The formulas are those of the paper after repair (docs/explanation/errata-of-the-two-papers.md). The stress s1 is that
of ``sim.physics.scratch``; K in it, the friction that acts on the stress, is the adhesion, but at most
``friction_limit``. The modulus knows the equivalence of frequency and temperature (Eq 9). Adhesion does not depend on
the pressure until the contact is full.

The paper prints no parameters: coefficients of this law are only as good as its parameters, and no
measurement is known to agree with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from math import isfinite, pi, sqrt
from typing import TYPE_CHECKING, Annotated, Final, NamedTuple

import numpy as np

from sim.physics.figures import with_figures
from sim.physics.materials import Components, length_text
from sim.physics.scratch import Scratch

if TYPE_CHECKING:
    from sim.physics.materials import Array, Rubber, Shear, Sinusoid, Surface

SLOWEST_M_S: Final = 1e-6
"""Slower sliding has the coefficient of this speed, m/s: at it adhesion has reached its value for slow sliding [A]."""


@dataclass(frozen=True, slots=True)
class GretaParameters:
    """Parameters of the law besides a rubber and a surface."""

    area: Annotated[float, "mm2"] = 100.0  # [A] of the contact, over which the load is spread evenly
    tread: Annotated[float, "mm"] = 10.0  # [A] height of the rubber that is cycled
    friction_limit: Annotated[float, "1"] = 1.0  # [A] limit of K: above it shear of adhesion would outgrow the pressure

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
    """Return m2 of a wave's profile; like the paper it uses Ra as the amplitude."""
    return 0.5 * (2.0 * pi * wave.ra_m / wave.wavelength_m) ** 2


def contact_slope(wave: Sinusoid) -> float:
    """Return sqrt(pi m2) / 2, the ratio of the pressure of full contact to the modulus (Eq 13)."""
    return 0.5 * sqrt(pi * mean_square_slope(wave))


def found_waves(surface: Surface) -> str:
    """Return a remark on two waves that were found in a surface's spectrum; "" where its file states them."""
    if surface.split_m is None or surface.coarse is None or surface.fine is None:
        return ""
    coarse, fine = (f"{length_text(w.wavelength_m)}, {length_text(w.ra_m)}" for w in (surface.coarse, surface.fine))
    return (
        f"the two waves of {surface.name} are found in its spectrum, divided at {length_text(surface.split_m)}"
        f" (length, amplitude): coarse {coarse}; fine {fine}"
    )


class Greta:
    """The law of one rubber on one surface."""

    def __init__(self, rubber: Rubber, surface: Surface, parameters: GretaParameters | None = None) -> None:
        """Take the materials. Raises ValueError if one of them lacks data for the law."""
        if rubber.shear is None:
            raise ValueError(f"compound {rubber.name!r}: greta needs its shear (tau_s0, v_c, n, ratio)")
        if surface.coarse is None or surface.fine is None:
            raise ValueError(f"surface {surface.name!r}: greta needs its two waves, coarse and fine")
        self.rubber = rubber
        self.parameters = parameters if parameters is not None else GretaParameters()
        self.coarse, self.fine = surface.coarse, surface.fine
        self.full_per_modulus = pi * self.coarse.ra_m / (self.coarse.wavelength_m * (1.0 - rubber.poisson**2))
        """Ratio of the pressure of full contact with the coarse wave to the modulus there (Eqs 21 and 22)."""
        self._shear = rubber.shear
        self._found = found_waves(surface)
        self._scratch = Scratch(self.coarse.wavelength_m, 1e-3 * self.parameters.tread)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient. Raises OutsideError, PoleError if the modulus is not known."""
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
        """Yield a warning for found waves, a speed below the slowest, and full contact; raises as ``mu``."""
        if self._found:
            yield self._found
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
        """Return mu_hys (Eq 20) under a pressure; ``friction``: K, cut at ``friction_limit``."""
        normal_m, shear_m = self.stress_m(pressure_pa / (dynamic.magnitude_pa * self.full_per_modulus))
        squares_m = normal_m + min(friction, self.parameters.friction_limit) ** 2 * shear_m
        return pi * dynamic.tan_delta * squares_m * pressure_pa / (self.coarse.wavelength_m * dynamic.magnitude_pa)

    def stress_m(self, share: float) -> tuple[float, float]:
        """Return int s1^2 dV over p^2 A0 of pressure alone, and the factor of K^2; ``share``: of full contact."""
        return self._scratch.parts_m(share)

    def pressure_pa(self, load_n: float) -> float:
        """Return the mean pressure under a load above 0."""
        return 1e6 * load_n / self.parameters.area

    def dynamic(self, temperature_c: float, v_m_s: float) -> tuple[Dynamic, Dynamic]:
        """Return the modulus at the frequencies of the coarse and the fine wave; raises as ``mu``."""
        lengths = np.array([self.coarse.wavelength_m, self.fine.wavelength_m])
        rates: Array = 2.0 * pi * v_m_s / lengths
        found = 2.0 * (1.0 + self.rubber.poisson) * self.rubber.modulus.complex_pa(rates, temperature_c)
        coarse, fine = (Dynamic(abs(complex(one)), float(one.imag / one.real)) for one in found)
        return coarse, fine


def greta(rubber: Rubber, surface: Surface, figures: Mapping[str, float]) -> Greta:
    """Return the law of a rubber on a surface with these figures (keys of GretaParameters). Raises ValueError."""
    return Greta(rubber, surface, with_figures("greta", GretaParameters, rubber.name, figures))
