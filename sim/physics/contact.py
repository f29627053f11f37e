"""Load between wheel and belt from the depth, and the rate of the depth, to which the press drives the wheel in.

F = k d^n + c dd/dt, never below zero: the belt cannot pull. With n = 1.3 the stiffness grows with F^0.23,
as measured on rollers pressed on a plane (Hertz line); all values are assumptions of ``ContactParameters``.
The load follows from position and velocity alone, so no step length can make it unstable.

Rubber also relaxes at constant depth (``Relaxation``), and softens and grows with temperature (``Warmth``).
"""

from __future__ import annotations

from math import exp, expm1
from typing import Final

from sim.physics.parameters import ContactParameters, SimParameters

_A_S: Final = 1.0
_B_S: Final = 10.0
_C_S: Final = 100.0
_D_S: Final = 1000.0
_E_S: Final = 10_000.0
"""One relaxation time for each decade: together they lose the same share of the load in every decade between. Not a
tuple: the compiled module does not find a constant that is a tuple of numbers."""


class ContactModel:
    """Load of one wheel on the belt's support plate: ``factor`` k in N/mm^n, ``exponent`` n, ``damping_n_s_mm`` c."""

    def __init__(self, parameters: ContactParameters) -> None:
        """Find the factor k for the required stiffness at the reference load."""
        n = parameters.exponent
        slope = parameters.reference_stiffness / (n * parameters.reference_load ** (1.0 - 1.0 / n))
        self.factor = slope**n  # N/mm^n
        self.exponent = n
        self.damping_n_s_mm = 1e-3 * parameters.damping

    def load_n(self, depth_mm: float, rate_mm_s: float) -> float:
        """Return the load in N at a depth of engagement in mm that changes by ``rate_mm_s`` (positive = deeper)."""
        if depth_mm <= 0.0:
            return 0.0
        load = self.factor * depth_mm**self.exponent + self.damping_n_s_mm * rate_mm_s
        return load if load > 0.0 else 0.0

    def depth_mm(self, load_n: float) -> float:
        """Return the depth in mm at which a load of at least 0 N rests."""
        return (load_n / self.factor) ** (1.0 / self.exponent)


class Relaxation:
    """Loss of load in rubber at constant depth, and its recovery without load.

    A generalised Maxwell body (quasi-linear viscoelasticity): the load is the elastic load of the depth less ``share``
    times a memory of that load for each of five relaxation times. At constant depth that is a loss of ``share`` in
    every decade of time.
    """

    def __init__(self, share: float) -> None:
        """Take the share of the load that is lost in a decade, 0 to 0.15; the rubber has carried no load yet."""
        self.share = share
        self._gains = (0.0, 0.0, 0.0, 0.0, 0.0)
        self.forget()

    def forget(self) -> None:
        """Begin with rubber that has carried no load."""
        self._memory = (0.0, 0.0, 0.0, 0.0, 0.0)
        self._apart_s = 0.0

    def change(self, share: float) -> None:
        """Change the share (above 0) from now on; load lost so far stays lost."""
        scale = self.share / share
        a, b, c, d, e = self._memory
        self._memory = (a * scale, b * scale, c * scale, d * scale, e * scale)
        self.share = share

    def retime(self, dt_s: float) -> None:
        """Set the length of a step in s."""
        self._gains = (
            -expm1(-dt_s / _A_S), -expm1(-dt_s / _B_S), -expm1(-dt_s / _C_S), -expm1(-dt_s / _D_S),
            -expm1(-dt_s / _E_S),
        )  # fmt: skip

    @property
    def lost_n(self) -> float:
        """Load missing at present, N."""
        return self.share * sum(self._memory)

    def load_n(self, elastic_n: float) -> float:
        """Advance by a step in contact and return what remains of the elastic load, N (below 0: none)."""
        if self._apart_s > 0.0:
            self._recover()
        a, b, c, d, e = self._memory
        ga, gb, gc, gd, ge = self._gains
        a += (elastic_n - a) * ga
        b += (elastic_n - b) * gb
        c += (elastic_n - c) * gc
        d += (elastic_n - d) * gd
        e += (elastic_n - e) * ge
        self._memory = (a, b, c, d, e)
        return elastic_n - self.share * (a + b + c + d + e)

    def rest(self, dt_s: float) -> None:
        """Advance by a step out of contact."""
        self._apart_s += dt_s

    def _recover(self) -> None:
        """Recover for the time out of contact."""
        apart_s = self._apart_s
        a, b, c, d, e = self._memory
        self._memory = (
            a * exp(-apart_s / _A_S), b * exp(-apart_s / _B_S), c * exp(-apart_s / _C_S), d * exp(-apart_s / _D_S),
            e * exp(-apart_s / _E_S),
        )  # fmt: skip
        self._apart_s = 0.0


class Warmth:
    """Effect of the temperatures of rubber and hub on the wheel: stiffness and radius, by their excess over ambient.

    The layer is bonded to the hub and cannot grow along it. So nearly all its gain of volume goes outward, less
    only near the free side faces. The hub grows like metal.
    """

    def __init__(self, parameters: SimParameters) -> None:
        """Prepare the coefficients; ``matters`` is False if all are switched off."""
        p, contact = parameters, parameters.contact
        self._ambient_c = p.ambient
        self._softening_per_k = p.softening * contact.softening
        self._layer_per_k = p.growth * contact.rubber_expansion
        self._hub_radius_mm = 0.5 * p.wheel.outer_diameter - p.wheel.rubber_layer
        self._hub_mm_k = p.growth * contact.hub_expansion * self._hub_radius_mm
        self.matters = self._softening_per_k > 0.0 or self._layer_per_k > 0.0 or self._hub_mm_k > 0.0

    def stiffness_share(self, rubber_c: float) -> float:
        """Return the contact's stiffness at a mean temperature of the rubber (degC), as a share of that at ambient."""
        return exp(self._softening_per_k * (self._ambient_c - rubber_c))

    def growth_mm(self, rubber_c: float, hub_c: float, cold_mm: float) -> float:
        """Return the gain in radius of a wheel of ``cold_mm`` diameter at ambient for these temperatures, mm."""
        layer_mm = max(0.0, 0.5 * cold_mm - self._hub_radius_mm)
        return self._layer_per_k * layer_mm * (rubber_c - self._ambient_c) + self._hub_mm_k * (hub_c - self._ambient_c)
