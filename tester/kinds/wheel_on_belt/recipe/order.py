"""Cost of the order of the steps: heating up, the hub's lead that has to decay, heat of the condition before.

Closed formulas; their constants show what simulated runs do (``tester.kinds.wheel_on_belt.recipe.constants``).
"""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

from tester.base.axes import Setpoint
from tester.inputs.recipe.time_estimate import StepEstimate
from tester.kinds.wheel_on_belt.recipe.body import Body

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.recipe.constants import EstimateConstants
    from tester.kinds.wheel_on_belt.rig import RigConfig

NEAR_K = 2.0
"""Nearer than this to its temperature the wheel needs no heating: a short roll does."""


class Before:
    """State after the last steps: the surface before heating up, degC, or the heat of the condition before, W."""

    def __init__(self, surface_c: float) -> None:
        """A wheel at one temperature, degC."""
        self.pooled = 0
        """Degrees of freedom of the run's deviation between repeats."""
        self.heat(surface_c)

    def heat(self, surface_c: float) -> None:
        """Note that the wheel is heated from a surface temperature, degC."""
        self.from_c: float | None = surface_c
        self.heat_w = 0.0
        self.rolled = False


class OrderCosts:
    """Extra cost of a condition for its place in the plan."""

    def __init__(self, rig: RigConfig, constants: EstimateConstants, body: Body) -> None:
        """Take what the formulas need of the rig."""
        self.constants = constants
        self.body = body
        self.ambient_c = rig.ambient_c
        self.offset_k = rig.loops.heat.rolling_offset_k

    def heat_s(self, from_c: float, to_c: float) -> float:
        """Return the seconds of heating up from a surface temperature, degC, until it is nearly there."""
        c = self.constants
        rise_k = to_c - self.offset_k - from_c
        if rise_k <= NEAR_K:
            return c.heat_near_s
        return c.heat_s + c.heat_per_k_s * (rise_k - 1.0) + c.heat_level_s * max(from_c - self.ambient_c, 0.0)

    def after(self, before: Before, sp: Setpoint, estimate: StepEstimate) -> StepEstimate:
        """Return a condition's estimate with what its place costs, and note what it leaves to the next."""
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
