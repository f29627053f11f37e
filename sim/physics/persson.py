"""Friction of rubber on a rough track by its dissipation: Persson's theory of hysteresis, as in paper S.

Paper S: R. Sharp, P. Gruber, E. Fina, Circuit racing, track texture, temperature and rubber friction, Vehicle System
Dynamics 54 (2016). Its equations, mended where they are misprinted (Eqs 3 and 4 integrate to the running q, not to q1):

    (1) mu = 1/2 int_{q0}^{q1} dq q^3 C(q) P(q) int_0^{2 pi} dphi cos(phi) Im[2 G(q v cos(phi), T) / (s (1 - nu))]
    (2) P(q) = erf(1 / (2 sqrt(F(q))))
    (3) F(q) = 1/8 int_{q0}^{q} dq' q'^3 C(q') int_0^{2 pi} dphi |2 G(q' v cos(phi), T) / ((1 - nu) s)|^2

with the nominal pressure s, G(-w) = conj G(w). P(q) is the share of the nominal area in contact at the
scale of q. The theory excludes adhesion and the heat in the contact: T is the rubber's temperature.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics.materials import Components, Rubber, ShearModulus, Spectrum, Surface

if TYPE_CHECKING:
    from sim.physics.materials import Array

PANELS: Final = 100
"""Panels of Simpson's rule over u, ln q = ln q0 + L u^4. P falls from 1 with 1 / sqrt(q - q0), within the first panel
if contact is poor: u^2 would make the integrand smooth, u^4 also makes it small there."""
NODES: Final = 32
"""Gauss's nodes over a quadrant of phi. With 100 panels they leave less than 1e-5 of mu up to 100 m/s."""
SLOWEST_M_S: Final = 1e-15
"""Below this speed friction is that at this speed, m/s: the modulus is never needed at frequency 0."""


@dataclass(frozen=True, slots=True)
class ContactByScale:
    """A contact at every scale, from the coarsest (q0) to the finest (q1)."""

    q_1_m: Array
    share: Array
    """P(q), share of the nominal area."""
    mu_up_to: Array
    """Coefficient of a track without roughness finer than q."""
    mu: float


class PerssonLaw:
    """The law of one rubber on one surface."""

    def __init__(
        self, modulus: ShearModulus, poisson: float, spectrum: Spectrum, panels: int = PANELS, nodes: int = NODES
    ) -> None:
        """Lay out the points of the integrals. Raises ValueError for a ratio of Poisson outside 0 to 0.5."""
        if not 0.0 <= poisson <= 0.5:
            raise ValueError(f"Poisson's ratio is 0 to 0.5, not {poisson!r}")
        self._modulus = modulus
        self._to_plane = 2.0 / (1.0 - poisson)
        q0, q1 = spectrum.band_1_m
        span = math.log(q1 / q0)
        u = np.linspace(0.0, 1.0, 2 * panels + 1)
        self._q = q0 * np.exp(span * u**4)
        self._q[-1] = q1  # rounding must not leave the band
        self._step = 1.0 / (2 * panels)
        # q^3 C dq = q^4 C d(ln q), d(ln q) = 4 L u^3 du
        self._weight = self._q**4 * spectrum.power_m4(self._q) * (4.0 * span) * u**3
        x, w = np.polynomial.legendre.leggauss(nodes)
        self._cos = np.cos(0.25 * math.pi * (x + 1.0))
        self._phi_weight = 0.25 * math.pi * w

    def components(self, temperature_c: float, pressure_pa: float, slip_m_s: float) -> Components:
        """Return zero adhesion and the hysteresis. Raises OutsideError, PoleError, ValueError for no pressure."""
        return Components(0.0, self.contact(temperature_c, pressure_pa, slip_m_s).mu)

    def contact(self, temperature_c: float, pressure_pa: float, slip_m_s: float) -> ContactByScale:
        """Return P(q) at the points of the integral (an array that the law keeps), with the coefficient; raises as
        ``components``."""
        square, loss = self._of_modulus(temperature_c, slip_m_s)
        share = self._share(square, pressure_pa)
        integrand = loss * share
        mu = self._simpson(integrand) / pressure_pa
        return ContactByScale(self._q, share, self._running(integrand) / pressure_pa, mu)

    def _of_modulus(self, temperature_c: float, slip_m_s: float) -> tuple[Array, Array]:
        """Return F s^2 and the integrand of mu s / P at every q: both integrals over phi have four equal quadrants."""
        rate = np.outer(self._q * max(slip_m_s, SLOWEST_M_S), self._cos)
        plane = self._to_plane * self._modulus.complex_pa(rate, temperature_c)
        squares = (plane.real**2 + plane.imag**2) @ self._phi_weight
        losses = plane.imag @ (self._phi_weight * self._cos)
        return self._running(0.5 * self._weight * squares), 2.0 * self._weight * losses

    def _share(self, square: Array, pressure_pa: float) -> Array:
        if not (math.isfinite(pressure_pa) and pressure_pa > 0.0):
            raise ValueError(f"the pressure must be finite and above 0 Pa, not {pressure_pa!r}")
        root = np.sqrt(np.maximum(square, 0.0)) / pressure_pa
        return np.array([math.erf(0.5 / one) if one > 0.0 else 1.0 for one in root.tolist()])

    def _running(self, y: Array) -> Array:
        """Return the integral of y du from 0 to every point: Simpson's rule, with its parabola to a panel's middle."""
        left, mid, right = y[:-2:2], y[1::2], y[2::2]
        up_to = np.zeros_like(y)
        up_to[2::2] = np.cumsum((left + 4.0 * mid + right) * (self._step / 3.0))
        up_to[1::2] = up_to[:-2:2] + (5.0 * left + 8.0 * mid - right) * (self._step / 12.0)
        return up_to

    def _simpson(self, y: Array) -> float:
        return float((y[0] + y[-1] + 4.0 * y[1::2].sum() + 2.0 * y[2:-1:2].sum()) * (self._step / 3.0))


class PerssonByLoad:
    """The law with loads on a nominal area of contact instead of pressures."""

    def __init__(self, law: PerssonLaw, area_mm2: float) -> None:
        """Take the law and the area in mm2, above 0."""
        self.law = law
        self.area_mm2 = area_mm2

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return zero adhesion and the hysteresis. Raises as the law."""
        return self.law.components(temperature_c, 1e6 * load_n / self.area_mm2, slip_m_s)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient. Raises as the law."""
        return self.components(temperature_c, load_n, slip_m_s).hysteresis


def persson(rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> PerssonByLoad:
    """Return the law of a rubber on a surface. Raises ValueError for figures, and for a surface without spectrum."""
    if figures:
        raise ValueError(f"law 'persson' is made of materials alone and takes no figures, not {', '.join(figures)}")
    if surface.spectrum is None:
        raise ValueError(f"surface {surface.name!r} has no spectrum of heights, which law 'persson' needs")
    return PerssonByLoad(PerssonLaw(rubber.modulus, rubber.poisson, surface.spectrum), area_mm2)
