"""Cost of measuring one condition: closed formulas, cached by setpoint and settings.

The length of a slip pulse follows from the temperature rise of a half-space heated by friction. The rise is
proportional to the square root of time: 2 q sqrt(t / pi) / sqrt(k rho c) (H. S. Carslaw, J. C. Jaeger, Conduction of
Heat in Solids, 2nd ed., 2.9).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from sim.physics.laws import FrictionLaw
from sim.physics.slip import slip_velocity
from sim.physics.wheel_law import WheelLaw
from tester.analysis.judge import ALONE
from tester.analysis.stability import REPEAT_WINDOWS
from tester.base.axes import Setpoint
from tester.base.source import InvalidSource
from tester.inputs.recipe.repeats_section import expected
from tester.inputs.recipe.time_estimate import HISTORIC_PERCENT, StepEstimate
from tester.kinds.wheel_on_belt.image.axes import HeldSetpoint, held_by
from tester.kinds.wheel_on_belt.recipe.twin_law import twin_law

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.recipe.constants import EstimateConstants
    from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelSettings
    from tester.kinds.wheel_on_belt.rig import RigConfig

ROLLING_M_S = 1e-9
"""Slower slip counts as none: the wheel rolls, in one contact per repeat."""


class ConditionMotion(NamedTuple):
    """The speeds and times of a condition. They depend on neither load nor temperature, so a grid has few of them."""

    model: FrictionLaw | None
    cornering: float
    """Factor of the coefficient at the sideslip angle."""
    slip_m_s: float
    """Resultant slip speed."""
    turn_s: float
    soak_s: float
    """Soak before the first repeat."""
    window_s: float
    """Time collected per repeat, extensions included."""
    edge_s: float
    """Sliding in a pulse that does not count."""
    repeat_s: float
    """Moves around a repeat."""
    moves_s: float
    """Moves around a pulse, beyond those around a repeat."""
    repeats: float
    """Expected number of repeats, with replacements."""
    run_in_s: float
    """Mean sliding after reversals, per repeat."""
    swing_k: float
    """Rise during a pulse that starts below the setpoint and ends as far above it."""


def _run_in_s(how: WheelSettings, repeats: float, slip_m_s: float) -> float:
    """Return the mean run-in sliding per repeat, s: one reversal per pair of repeats, and once more."""
    if not how.run_in_m or slip_m_s < ROLLING_M_S:
        return 0.0
    return how.run_in_m / slip_m_s * (0.5 * repeats + 1.0) / repeats


class ConditionCosts:
    """Costs of conditions on one rig; specimens and replicates share theirs."""

    def __init__(
        self, rig: RigConfig, constants: EstimateConstants, repeatability: Mapping[str, float] | None = None
    ) -> None:
        """Compute all that depends on the rig alone. ``repeatability``: s between repeats, per cent, by compound."""
        self.repeatability = repeatability or {}
        believed = rig.observer
        thermal = believed.thermal
        diameter_m = 1e-3 * rig.geometry.wheel_diameter_mm
        width_m = 1e-3 * rig.geometry.wheel_width_mm
        effusivity = math.sqrt(thermal.conductivity * thermal.density * thermal.heat_capacity)
        area_m2 = math.pi * diameter_m * width_m
        self.constants = constants
        self.ambient_c = rig.ambient_c
        self.turn_m = math.pi * diameter_m
        # K per W of friction and per sqrt(s): the turning tread spreads the heat over its whole circumference.
        self.rise_k = 2.0 * believed.friction_heat_fraction / (area_m2 * effusivity * math.sqrt(math.pi))
        # V = k F s; a ring of the tread's area, on both sides of the diameter.
        self.loss_mm_per_nm = 2.0 * rig.wear.rate_mm3_per_n_m / (area_m2 * 1e6)
        self.rubber_share = believed.friction_heat_fraction
        self.offset_k = rig.loops.heat.rolling_offset_k
        self._rig = rig
        self._laws: dict[str, WheelLaw | None] = {}
        self._costs: dict[tuple[object, ...], StepEstimate] = {}
        self._motions: dict[tuple[object, ...], ConditionMotion] = {}

    def mu(self, compound: str, temperature_c: float, load_n: float, slip_m_s: float, sideslip_deg: float) -> float:
        """Return the expected friction coefficient; a round figure for a compound without a model."""
        law = self.law(compound)
        if law is None:
            return self.constants.unknown_mu
        return law.mu(temperature_c, load_n, slip_m_s) * law.cornering_factor(sideslip_deg)

    def law(self, compound: str) -> WheelLaw | None:
        """Return the law of a compound, as far as it is known without the recipe's folder and surface."""
        if compound not in self._laws:
            try:
                found = twin_law(self._rig, compound)
                self._laws[compound] = found if self._rig.simulated or not found.assumed else None
            except (ValueError, InvalidSource):
                self._laws[compound] = None
        return self._laws[compound]

    def s_percent(self, compound: str) -> float:
        """Return the expected standard deviation between repeats, per cent of the coefficient."""
        return self.repeatability.get(compound, HISTORIC_PERCENT)

    def ground_mm(self, load_n: float, sliding_m: float) -> float:
        """Return the loss of diameter, mm, from sliding a distance (m) under a load (N)."""
        return self.loss_mm_per_nm * load_n * sliding_m

    def of(self, setpoint: Setpoint, how: WheelSettings) -> StepEstimate:
        """Return the estimate of a condition: a setpoint, measured with these settings."""
        procedure = (
            how.repeats, how.at_most, how.until_percent, how.window, how.temperature_band_k, how.soak, how.max_bursts,
            how.both_directions, how.run_in_m,
        )  # fmt: skip
        key = setpoint.compound, setpoint.values, procedure
        known = self._costs.get(key)
        if known is None:
            sp = held_by(setpoint)
            moving = sp.compound, sp.slip_velocity_m_s, sp.wheel_speed_m_s, *sp.positions.values(), procedure
            motion = self._motions.get(moving)
            if motion is None:
                motion = self._motions[moving] = self._motion(sp, how)
            known = self._costs[key] = self._cost(sp.load_n, sp.temperature_c, motion, how)
        return known

    def _cost(self, load_n: float, temperature_c: float, motion: ConditionMotion, how: WheelSettings) -> StepEstimate:
        model, slip_m_s, soak_s, repeats = motion.model, motion.slip_m_s, motion.soak_s, motion.repeats
        c = self.constants
        if slip_m_s < ROLLING_M_S:
            seconds = soak_s + repeats * (motion.repeat_s + motion.window_s)
            return StepEstimate(seconds, peak_c=temperature_c, bursts=1, repeats=repeats)
        mu = c.unknown_mu if model is None else model.mu(temperature_c, load_n, slip_m_s) * motion.cornering
        power_w = mu * load_n * slip_m_s
        rise_k = self.rise_k * power_w
        bursts, counted_s, held = self._bursts(motion, how, rise_k)
        if not held:
            repeats = 1.0
        slide_s = counted_s + bursts * motion.edge_s + motion.run_in_s
        sliding_m = repeats * slip_m_s * slide_s
        heat_w = self.rubber_share * power_w
        waiting_s = repeats * slide_s * self._cooling(temperature_c, heat_w)
        if heat_w > c.sink_from_w:
            waiting_s += c.sink_s_w * (heat_w - c.sink_from_w)
        above_k = min(rise_k * math.sqrt(slide_s / bursts), how.temperature_band_k, self.offset_k)
        return StepEstimate(
            soak_s + repeats * (motion.repeat_s + slide_s + bursts * motion.moves_s) + waiting_s,
            sliding_m,
            self.loss_mm_per_nm * load_n * sliding_m,
            repeats * power_w * slide_s,
            temperature_c + above_k,
            bursts,
            held,
            waiting_s,
            heat_w,
            repeats,
        )

    def _motion(self, sp: HeldSetpoint, how: WheelSettings) -> ConditionMotion:
        c = self.constants
        turn_s = self.turn_m / sp.wheel_speed_m_s
        yawed = sp.yawed
        law = self.law(sp.compound)
        slip_m_s = slip_velocity(sp.wheel_speed_m_s, sp.belt_speed_m_s, sp.sideslip_deg)[2]
        repeats = how.scheme.repeats_each * expected(how, self.s_percent(sp.compound))
        collected = REPEAT_WINDOWS * c.surplus if how.repeats > ALONE else c.alone
        return ConditionMotion(
            model=law.law if law is not None else None,
            cornering=1.0 if law is None else law.cornering_factor(sp.sideslip_deg),
            slip_m_s=slip_m_s,
            turn_s=turn_s,
            soak_s=how.soak.for_s + c.next_condition_s,
            window_s=collected * how.window.duration_s(1.0 / turn_s),
            edge_s=(c.yawed_slide_s if yawed else c.burst_edge_s) + c.split_turns * turn_s,
            repeat_s=0.0 if yawed else c.repeat_moves_s,
            moves_s=c.yawed_moves_s + 2.0 * abs(sp.sideslip_deg) / c.yaw_deg_s if yawed else 0.0,
            repeats=repeats,
            run_in_s=_run_in_s(how, repeats, slip_m_s),
            swing_k=self.offset_k + min(how.temperature_band_k, self.offset_k),
        )

    def _cooling(self, temperature_c: float, heat_w: float) -> float:
        """Return the seconds of cooling below the setpoint, per second of sliding."""
        c = self.constants
        above_k = max(temperature_c - self.offset_k - self.ambient_c, 1.0)
        heat_w -= c.carried_w + c.near_carried_wk / above_k
        if heat_w <= 0.0:
            return 0.0
        if heat_w > c.hot_w:
            heat_w = c.hot_w + c.hot_share * (heat_w - c.hot_w)
        return c.cooling_per_j * heat_w * (1.0 + c.near_k / (above_k + c.near_shift_k))

    def _bursts(self, motion: ConditionMotion, how: WheelSettings, rise_k: float) -> tuple[int, float, bool]:
        """Return bursts per repeat, seconds counted per repeat, and whether the temperature holds for a revolution.

        ``rise_k`` is the surface's rise in K per square root of a second.
        """
        turn_s, window_s, edge_s = motion.turn_s, motion.window_s, motion.edge_s
        if rise_k <= 0.0:
            return 1, window_s, True
        c = self.constants
        # From below the setpoint to as far above it, so that the samples centre on it ...
        each_s = (motion.swing_k / rise_k) ** 2 - edge_s
        few_s = c.few_turns * turn_s
        if each_s < few_s:
            # ... or, if that is too short, from below the band to its top.
            whole_s = ((2.0 * how.temperature_band_k + c.below_band_k) / rise_k) ** 2
            counted_s = whole_s - max(edge_s, (c.below_band_k / rise_k) ** 2)
            each_s = max(each_s, min(counted_s, few_s))
        if each_s < turn_s:
            return c.bursts_tried, 0.0, False
        # A warming pulse ends at half the window, so that a second rise separates temperature from time.
        least_s = window_s / REPEAT_WINDOWS
        if rise_k * math.sqrt(0.5 * least_s) > c.half_rise_k:
            least_s *= 0.5
        bursts = math.ceil(window_s / min(each_s, least_s) - 0.1)
        each_s = max(each_s, window_s / bursts)
        bursts = min(bursts, how.max_bursts)
        return bursts, min(bursts * each_s, window_s), True
