"""The outer heat loop: surface error to hub setpoint, once a second.

The inner loop is the jacket controller's own PID on its hub sensor. The rubber between hub and surface is slow
(minutes) and the hub cools only through it, so the setpoint is mostly feed-forward: the steady hub
temperature for the wanted surface temperature, plus a proportional lead and a slow integral.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from tester.kinds.wheel_on_belt.rig import HeatLoopConfig


@dataclass(slots=True)
class HeatLoop:
    """State of the outer loop."""

    hub_setpoint_c: float = 25.0
    target_c: float = float("nan")
    integral_k: float = 0.0
    due_s: float = float("-inf")

    def update(
        self, now: float, target_c: float, surface_c: float, ambient_c: float, loss_ratio: float, loop: HeatLoopConfig
    ) -> float:
        """Return the hub setpoint in degC, recomputed once every ``loop.period_s``.

        ``loss_ratio`` is the steady hub-surface difference per kelvin of surface above ambient: the rubber's
        resistance times the surface's loss conductance (dimensionless).
        """
        if target_c != self.target_c:
            self.target_c = target_c
            self.integral_k = 0.0
            self.due_s = now
        if now < self.due_s or not isfinite(surface_c):
            return self.hub_setpoint_c
        self.due_s = now + loop.period_s
        error = target_c - surface_c
        if abs(error) < loop.integral_band_k:
            self.integral_k += loop.outer_gain * error * loop.period_s / loop.outer_integral_s
            self.integral_k = min(max(self.integral_k, -loop.integral_limit_k), loop.integral_limit_k)
        steady = target_c + max(0.0, target_c - ambient_c) * loss_ratio
        wanted = steady + loop.outer_gain * error + self.integral_k
        self.hub_setpoint_c = min(max(wanted, loop.hub_min_c), loop.hub_max_c)
        return self.hub_setpoint_c
