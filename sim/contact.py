"""Load between wheel and belt from how far, and how fast, the press drives one into the other.

F = k d^n + c dd/dt, never below zero: the belt cannot pull. With n = 1.3 the stiffness grows with F^0.23,
as measured on rollers pressed on a plane (Hertz line); all values are assumptions of ``ContactParameters``.
The load follows from position and velocity alone, so no step length can make it unstable.
"""

from __future__ import annotations

from sim.parameters import ContactParameters


class ContactModel:
    """Load of one wheel on the belt's support plate: ``factor`` k in N/mm^n, ``exponent`` n, ``damping_n_s_mm`` c."""

    __slots__ = ("damping_n_s_mm", "exponent", "factor")

    def __init__(self, parameters: ContactParameters) -> None:
        """Find the factor k that gives the stiffness asked for at the reference load."""
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

    def stiffness_n_mm(self, load_n: float) -> float:
        """Return dF/dd in N/mm at a load above 0 N."""
        return self.exponent * load_n / self.depth_mm(load_n)
