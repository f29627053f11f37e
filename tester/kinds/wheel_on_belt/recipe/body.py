"""Hub and rubber as one store of heat: how long a wheel takes to cool, and what it holds at a surface temperature.

A lump, good enough to add up hours; slip pulses need the surface itself (``.cost``).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig import RigConfig


class Body:
    """Hub and rubber as one heat store; temperatures are its mean, degC."""

    def __init__(self, rig: RigConfig) -> None:
        """Work out heat capacities (J/K) and losses (W/K) from the rig file's parameters of the wheel."""
        believed = rig.observer
        thermal, wheel = believed.thermal, believed.wheel
        outer, inner = 0.5e-3 * wheel.outer_diameter, 0.5e-3 * (wheel.outer_diameter - 2.0 * wheel.rubber_layer)
        width = 1e-3 * wheel.width
        ring = math.pi * (outer**2 - inner**2)
        tread = 2.0 * math.pi * outer * width
        sides = thermal.film_sides * 2.0 * ring
        self.ambient_c = rig.ambient_c
        self.rubber_j_k = thermal.density * thermal.heat_capacity * ring * width
        self.hub_j_k = thermal.hub_capacity
        self.stopped_w_k = thermal.hub_to_shaft + sides + thermal.film_stopped * tread
        self.turning_w_k = thermal.hub_to_shaft + sides + thermal.film_rotating * tread
        self.resistance_k_w = math.log(outer / inner) / (2.0 * math.pi * thermal.conductivity * width)
        surface_w_k = thermal.film_rotating * tread + believed.belt_conductance
        # Mean of hub and rubber above ambient, per kelvin of surface above ambient, in rolling contact.
        hub_ratio = 1.0 + self.resistance_k_w * surface_w_k
        self.hub_ratio = hub_ratio
        rubber = 0.5 * (1.0 + hub_ratio)
        total = self.hub_j_k + self.rubber_j_k
        self.mean_ratio = (self.hub_j_k * hub_ratio + self.rubber_j_k * rubber) / total

    def steady_c(self, surface_c: float) -> float:
        """Return the mean temperature that holds a surface temperature in rolling contact."""
        return self.ambient_c + self.mean_ratio * (surface_c - self.ambient_c)

    def surface_c(self, mean_c: float) -> float:
        """Return the surface temperature that belongs to a mean temperature."""
        return self.ambient_c + (mean_c - self.ambient_c) / self.mean_ratio

    def mean_at_hub_c(self, hub_c: float) -> float:
        """Return the mean temperature at which the hub, the warmest part, has come down to a temperature."""
        return self.ambient_c + (hub_c - self.ambient_c) * self.mean_ratio / self.hub_ratio

    def with_new_rubber(self, mean_c: float) -> float:
        """Return the mean after new rubber, at ambient, came onto the hub."""
        share = self.hub_j_k / (self.hub_j_k + self.rubber_j_k)
        return self.ambient_c + share * (mean_c - self.ambient_c)

    def warmed_k(self, joules: float) -> float:
        """Return the rise of the mean by heat put in."""
        return joules / (self.hub_j_k + self.rubber_j_k)

    def cooling_s(self, mean_c: float, to_c: float, *, turning: bool) -> float:
        """Return the seconds of cooling to a temperature; infinite where ambient is not below it."""
        if mean_c <= to_c:
            return 0.0
        if to_c <= self.ambient_c:
            return math.inf
        loss = self.turning_w_k if turning else self.stopped_w_k
        time_constant = (self.hub_j_k + self.rubber_j_k) / loss
        return time_constant * math.log((mean_c - self.ambient_c) / (to_c - self.ambient_c))

    def after_c(self, mean_c: float, seconds: float) -> float:
        """Return the mean after standing for some time."""
        rate = self.stopped_w_k / (self.hub_j_k + self.rubber_j_k)
        return self.ambient_c + (mean_c - self.ambient_c) * math.exp(-rate * seconds)
