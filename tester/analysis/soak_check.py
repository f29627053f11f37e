"""Compares the thermometer of a surface with the heater's sensor, after a soak."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SoakCheck:
    """Reading of the surface's thermometer at the end of a condition's soak, and its expected value.

    Temperatures in degC: ``surface_c`` by the thermometer, ``hub_c`` by the heater's sensor, ``model_c`` the surface's
    by a model of the heat flow from the latter. ``allowed_k``: largest difference that the uncertainties of sensors and
    model explain, K.
    """

    condition: int
    t_s: float
    surface_c: float
    model_c: float
    hub_c: float
    allowed_k: float

    @property
    def off_k(self) -> float:
        """Return the thermometer's reading less its expected value, K."""
        return self.surface_c - self.model_c

    @property
    def agrees(self) -> bool:
        """Return whether the difference is within its limit."""
        return abs(self.off_k) <= self.allowed_k
