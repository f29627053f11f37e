"""Heat of hub and rubber as one store, and the cost of the order of steps: heating up, the hub's lead, leftover heat.

These are closed formulas with constants from simulated runs (``tester.kinds.wheel_on_belt.recipe.constants``).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

from tester.base.axes import Setpoint
from tester.inputs.recipe.time_estimate import StepEstimate

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.recipe.constants import EstimateConstants
    from tester.kinds.wheel_on_belt.rig import RigConfig


class Body:
    """Hub and rubber as one heat store; temperatures are its mean, degC."""

    def __init__(self, rig: RigConfig) -> None:
        """Compute heat capacities (J/K) and losses (W/K) from the rig file's parameters of the wheel."""
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
        """Return the surface temperature for a mean temperature."""
        return self.ambient_c + (mean_c - self.ambient_c) / self.mean_ratio

    def mean_at_hub_c(self, hub_c: float) -> float:
        """Return the mean temperature at which the hub, the warmest part, has cooled to a temperature."""
        return self.ambient_c + (hub_c - self.ambient_c) * self.mean_ratio / self.hub_ratio

    def with_new_rubber(self, mean_c: float) -> float:
        """Return the mean after mounting new rubber at ambient."""
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


NEAR_K = 2.0
"""Within this of its temperature the wheel needs no heating: a short roll is enough."""


class Before:
    """State after the last steps: the surface before heating up, degC, or the heat of the condition before, W."""

    def __init__(self, surface_c: float) -> None:
        """A wheel at one temperature, degC."""
        self.pooled = 0
        """Degrees of freedom of the run's deviation between repeats."""
        self.heat(surface_c)

    def heat(self, surface_c: float) -> None:
        """Record that the wheel is heated from a surface temperature, degC."""
        self.from_c: float | None = surface_c
        self.heat_w = 0.0
        self.rolled = False


class OrderCosts:
    """Extra cost of a condition due to its place in the plan."""

    def __init__(self, rig: RigConfig, constants: EstimateConstants, body: Body) -> None:
        """Take the formulas' parameters from the rig."""
        self.constants = constants
        self.body = body
        self.ambient_c = rig.ambient_c
        self.offset_k = rig.loops.heat.rolling_offset_k

    def heat_s(self, from_c: float, to_c: float) -> float:
        """Return the seconds of heating up from a surface temperature, degC, to nearly the target."""
        c = self.constants
        rise_k = to_c - self.offset_k - from_c
        if rise_k <= NEAR_K:
            return c.heat_near_s
        return c.heat_s + c.heat_per_k_s * (rise_k - 1.0) + c.heat_level_s * max(from_c - self.ambient_c, 0.0)

    def after(self, before: Before, sp: Setpoint, estimate: StepEstimate) -> StepEstimate:
        """Return a condition's estimate with the cost of its place; update ``before`` for the next condition."""
        c = self.constants
        heat_w, from_c = estimate.heat_w, before.from_c
        if from_c is not None:
            waiting_s = self._settle_s(from_c, sp.number("temperature"))
            if heat_w > 0.0:
                share = max(c.settled_share - waiting_s / c.settled_s, 0.0)
                waiting_s += (share - 1.0) * estimate.waiting_s
            else:
                waiting_s *= c.rolling_settle
            before.from_c = None
        elif heat_w <= 0.0:
            waiting_s = 0.0 if before.rolled else c.rolling_after_s
        elif before.rolled:
            surface_c = sp.number("temperature")
            top_c = self.body.steady_c(surface_c)
            below_c = self.body.steady_c(surface_c - self.offset_k)
            waiting_s = min(self.body.cooling_s(top_c, below_c, turning=True), c.roll_at_most_s)
        else:
            waiting_s = 0.0
            if before.heat_w > heat_w:
                waiting_s = (c.after_hotter - 1.0) * estimate.waiting_s
            if before.heat_w > c.sunk_from_w:
                waiting_s += min(c.sunk_s_w * (before.heat_w - c.sunk_from_w), c.sunk_most_s)
        before.heat_w = heat_w
        before.rolled = heat_w <= 0.0
        return estimate._replace(seconds=estimate.seconds + waiting_s, waiting_s=estimate.waiting_s + waiting_s)

    def lift_later_s(self, sp: Setpoint, estimate: StepEstimate) -> float:
        """Return how much later, s, than by ``waits_most`` the first condition after heating may end near ambient.

        The settling is expected from the temperature's rise over ambient, as long as it grows with it; where that is
        short, the wheel may still be lifted once.
        """
        c = self.constants
        longest_k = c.settle_k[c.settle_s.index(max(c.settle_s))]
        if estimate.heat_w <= 0.0 or sp.number("temperature") - self.ambient_c >= longest_k:
            return 0.0
        return max(c.lift_s - (c.waits_most - 1.0) * estimate.waiting_s, 0.0)

    def _settle_s(self, from_c: float, to_c: float) -> float:
        """Return the seconds in contact from reaching a temperature until it is stable."""
        c = self.constants
        level_k = to_c - self.ambient_c
        if level_k <= c.settle_k[0]:
            return c.settle_s[0]
        place = min(bisect_right(c.settle_k, level_k), len(c.settle_k) - 1)
        low_k, high_k = c.settle_k[place - 1], c.settle_k[place]
        low_s, high_s = c.settle_s[place - 1], c.settle_s[place]
        share = min((level_k - low_k) / (high_k - low_k), 1.0)
        whole_s = low_s + share * (high_s - low_s)
        risen = (to_c - from_c) / level_k
        return whole_s * min(max((risen - c.settle_from) / (1.0 - c.settle_from) * 2.0, 0.0), 1.0)
