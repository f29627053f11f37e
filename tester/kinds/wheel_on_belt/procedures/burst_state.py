"""The state of a repeat: phase, burst in progress, remaining run-in, start and end temperatures of bursts.

A burst begins with the surface below the setpoint and ends as far above it, so that its samples centre on the
setpoint. The start offset is learned: some conditions heat up before the first sample counts.

A rubber's abrasion pattern reverses with the slip. Sliding after a reversal does not count before the run-in is over.
Like all sliding, the run-in comes in pulses, each as long as the surface stays inside its band.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import isnan, pi
from typing import Final

from sim.physics.slip import slip_velocity
from tester.analysis.blocks import BlockCounter
from tester.analysis.directions import is_reversed
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.axes import HeldSetpoint
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.machine.measured import MeasuredRepeat

COLDER_K: Final = 0.3
"""Greatest distance of a burst's start below its target, K [A]: colder samples would be off the setpoint."""
OFFSET_STEP_K: Final = 0.5
"""Step by which the next burst starts lower after a burst that warmed through the band too quickly, K [A]."""
FEW_REVOLUTIONS: Final = 3
"""A burst with fewer whole turns makes the next burst start lower."""
SLOW_COOLING_S: Final = 45.0
SLOW_COOLING_K: Final = 0.15
"""Cooling that is slower than this, with the surface below the setpoint, is not worth waiting for [A]."""
CENTRED_K: Final = 0.2
"""A start this far below the setpoint still lets samples centre on it [A]."""
MEAN_LIMIT_K: Final = 0.45
"""A burst ends before the mean surface temperature of the repeat's samples is more than this off the setpoint [A]
(required: within 0.7 K).
"""
ROLLING_START_K: Final = 0.4
"""Tolerance of the start without slip, K [A]: nothing changes the surface during the window."""
BELOW_K: Final = 0.3
"""After a burst with samples on average further below the setpoint, the next burst starts higher, K [A]."""
OFFSET_LEAST_K: Final = 0.2
SPLIT_RISE_K: Final = 0.25
"""A burst that has warmed by this much ends at half the window, any other at a whole window: a second rise separates
the effect of temperature from that of time [A]."""
BLIND_S: Final = 20.0
"""A burst is given up after this long without a counted sample, s [A]."""
WARM_SHARE: Final = 1.2
"""Revolutions that a sufficient band must hold, including the ramp."""


class Phase(Enum):
    """The phase of a repeat."""

    TARE = "tare"
    ROLL = "roll"
    READY = "wait for temperature"
    COOL = "cool lifted"
    MOVE_IN = "bring slip in"
    RUN_IN = "run in reversed"
    COUNT = "measure"
    MOVE_OUT = "take slip out"
    LIFT = "lift"


@dataclass(slots=True)
class BurstNotes:
    """State of the burst in progress."""

    began_s: float = 0.0
    began_c: float = float("nan")
    blocks_before: int = 0
    counted_s: float = float("-inf")
    slid_s: float = float("nan")
    slid_c: float = float("nan")
    """Time at which half of the slip was reached, and the surface's reading then."""
    peak_rate_k_s: float = 0.0
    sum_before_k: float = 0.0
    count_before: int = 0


class RunIn:
    """The remaining run-in distance, m, and the number of its pulses."""

    def __init__(self, distance_m: float) -> None:
        """Begin with the whole distance."""
        self.left_m = distance_m
        self.pulses = 0

    def slide(self, distance_m: float) -> bool:
        """Subtract the distance slid in a scan; return whether the run-in is over."""
        self.left_m -= distance_m
        return self.left_m <= 0.0


def slides_reversed(step: WheelCondition, repeat: int) -> bool:
    """Return whether a repeat of a condition (counted from 1) slides with reversed slip."""
    return step.both_directions and is_reversed(repeat)


def run_in_m(step: WheelCondition, repeat: int) -> float:
    """Return a repeat's run-in distance, m: for the first of a condition, and after each reversal."""
    turned = repeat == 1 or slides_reversed(step, repeat) is not slides_reversed(step, repeat - 1)
    return step.run_in_m if step.both_directions and turned else 0.0


class CentredBursts(MeasuredRepeat):
    """The temperature rules of a repeat's bursts: start, end, and the learned start offset."""

    def __init__(self, step: WheelCondition, setpoint: HeldSetpoint, offset_k: float, counter: BlockCounter) -> None:
        """``offset_k``: distance of the start below the setpoint, from the previous repeat."""
        super().__init__(counter)
        self.condition = step
        self.setpoint = setpoint
        self.offset_k = offset_k
        self.burst = BurstNotes()
        self.bursts: int = 0
        self.empty = 0
        """Bursts without a whole turn since the last burst with one."""
        self.mark_s = 0.0
        self.mark_c = float("inf")
        self.surface_sum_k: float = 0.0
        self.surface_count: int = 0
        self.belt_m_s = setpoint.belt_speed_m_s
        self.slip_m_s = slip_velocity(setpoint.wheel_speed_m_s, self.belt_m_s, setpoint.sideslip_deg)[2]
        self.target_c = setpoint.temperature_c
        self.band_k = step.temperature_band_k
        self.window_rev = step.window.revolutions
        self.yawed = setpoint.yawed
        self.rolling_only = not self.yawed and abs(setpoint.slip_velocity_m_s) < 1e-9

    @property
    def revolutions(self) -> int:
        """Whole revolutions that count so far."""
        return len(self.counter.blocks)

    def _demand_heat(self, ctx: Context) -> None:
        ctx.demand.surface_c = self.setpoint.temperature_c - (0.0 if self.rolling_only else self.offset_k)
        ctx.demand.freeze_heat = False

    def _start_now(self, ctx: Context, surface: float, target: float) -> bool:
        if self.rolling_only:
            return abs(surface - target) <= min(ROLLING_START_K, self.condition.temperature_band_k)
        if surface < target - max(self.offset_k, ctx.rig.loops.heat.rolling_offset_k) - COLDER_K:
            return False
        if surface <= target - self.offset_k + 0.1:
            return True
        if ctx.now - self.mark_s >= SLOW_COOLING_S:
            slow = self.mark_c - surface < SLOW_COOLING_K
            self.mark_s, self.mark_c = ctx.now, surface
            return slow and surface <= target - CENTRED_K
        return False

    def _burst_over(self, ctx: Context, surface: float, rate: float) -> bool:
        if self.rolling_only:
            return ctx.now - self.burst.counted_s > BLIND_S
        target, start = self.target_c, self.burst.began_c
        if surface > target:
            below = self.offset_k if isnan(start) else target - start
            if surface >= target + min(self.band_k, max(below, CENTRED_K) + 0.2):
                return True
            mean = self.surface_sum_k / self.surface_count if self.surface_count else 0.0
            if mean > MEAN_LIMIT_K and surface > target + MEAN_LIMIT_K:
                return True
        window = self.window_rev
        if window is not None and not isnan(start):
            share = 0.5 if surface - start > SPLIT_RISE_K else 1.0
            if len(self.counter.blocks) - self.burst.blocks_before >= share * window:
                return True
        return ctx.now - self.burst.counted_s > BLIND_S

    def _learn_offset(self, gained: int, furthest_k: float) -> None:
        """Start lower after a burst that warmed up too quickly, higher after one that stayed below the setpoint."""
        count = self.surface_count - self.burst.count_before
        mean_k = (self.surface_sum_k - self.burst.sum_before_k) / count if count else 0.0
        if gained < FEW_REVOLUTIONS:
            self.offset_k = min(self.offset_k + OFFSET_STEP_K, furthest_k)
        elif mean_k < -BELOW_K:
            self.offset_k = max(self.offset_k + 0.7 * mean_k, OFFSET_LEAST_K)

    def _band_needed(self, ctx: Context) -> str:
        """Return the surface's rate of warming and the band that would hold a whole revolution, as text.

        The trend's filter needs seconds to follow: in a short burst the rise from reading to reading is more exact.
        A band in which nothing could be counted is never reported as sufficient.
        """
        r, burst = ctx.readings, self.burst
        turn_s = pi * r.diameter_mm * 1e-3 / self.setpoint.wheel_speed_m_s
        lag_s = ctx.rig.gates.ir_lag_s
        elapsed = r.surface_at_s - burst.slid_s
        rise = (r.surface_c - burst.slid_c) / elapsed if elapsed >= lag_s else 0.0
        self.warming_k_s = max(burst.peak_rate_k_s, rise)
        self.holdable_band_k = 0.5 * self.warming_k_s * (WARM_SHARE * turn_s + lag_s)
        if self.empty:
            self.holdable_band_k = max(self.holdable_band_k, WARM_SHARE * self.condition.temperature_band_k)
        return f"surface warms by {self.warming_k_s:.2f} K/s; a band of {self.holdable_band_k:.1f} K would do"
