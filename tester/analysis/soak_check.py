"""The thermometer of a surface against the sensor of what heats it, after a soak."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SoakCheck:
    """What the surface's thermometer shows at the end of a condition's soak, and what it should show.

    Temperatures in degC: ``surface_c`` by the thermometer, ``hub_c`` by the heater's sensor, ``model_c`` what a model
    of the heat flow makes of the latter for the surface. ``allowed_k``: by how much both may part as far as sensors
    and model are believed, K.
    """

    condition: int
    t_s: float
    surface_c: float
    model_c: float
    hub_c: float
    allowed_k: float

    @property
    def off_k(self) -> float:
        """Return by how much the thermometer shows more than it should, K."""
        return self.surface_c - self.model_c

    @property
    def agrees(self) -> bool:
        """Return whether both are as near as they are believed."""
        return abs(self.off_k) <= self.allowed_k
