"""How long a plan takes, what it rubs off and how warm it gets: closed formulas, no simulation.

The times are sums of the moves that the executor makes; how long a slip pulse may last follows from the square
root of time by which friction heats a half-space (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd
ed., 2.9: rise = 2 q sqrt(t / pi) / sqrt(k rho c)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, Protocol

from sim.friction import KNOWN, FrictionModel
from sim.slip import cornering_factor, slip_velocity
from tester.recipe.body import Body
from tester.recipe.constants import CONSTANTS, NEAR_K, EstimateConstants
from tester.recipe.plan import (
    ConditionStep,
    Cool,
    Heat,
    Install,
    Plan,
    PreGrind,
    Prompt,
    Rest,
    Setpoint,
    Soak,
    Step,
    Window,
)

if TYPE_CHECKING:
    from tester.rig import RigConfig


class StepEstimate(NamedTuple):
    """What one step takes: rig time s, sliding m, loss of diameter mm, friction heat J, surface peak degC.

    ``bursts`` a repeat; ``held`` is False where not one revolution fits into the temperature band.
    """

    seconds: float
    sliding_m: float = 0.0
    loss_mm: float = 0.0
    friction_j: float = 0.0
    peak_c: float = -math.inf
    bursts: int = 0
    held: bool = True


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a plan takes; ``steps`` run parallel to the plan's. Units as in ``StepEstimate``.

    ``rig_seconds`` includes the way from the last step to standstill.
    """

    steps: tuple[StepEstimate, ...]
    rig_seconds: float
    sliding_m: float
    loss_mm: float
    """Loss of diameter, summed over all wheels."""
    friction_j: float
    peak_c: float
    wheels: int
    not_held: tuple[int, ...] = field(default=())
    """Numbers of the conditions whose temperature is not expected to hold within the band."""


def estimate(plan: Plan, rig: RigConfig, estimator: Estimator | None = None) -> Estimate:
    """Return what a plan takes on a rig; ``estimator``: the one that expanded it, or one with other constants."""
    estimator = estimator or Estimator(rig)
    steps = estimator.walk(plan)
    not_held = [
        step.condition
        for step, one in zip(plan.steps, steps, strict=True)
        if not one.held and isinstance(step, ConditionStep)
    ]
    return Estimate(
        steps=tuple(steps),
        rig_seconds=math.fsum(one.seconds for one in steps) + estimator.shut_down_s(plan),
        sliding_m=math.fsum(one.sliding_m for one in steps),
        loss_mm=math.fsum(one.loss_mm for one in steps),
        friction_j=math.fsum(one.friction_j for one in steps),
        peak_c=max((one.peak_c for one in steps), default=-math.inf),
        wheels=sum(isinstance(step, Install) for step in plan.steps),
        not_held=tuple(not_held),
    )


def predicted_loss_mm(step: ConditionStep, rig: RigConfig) -> float:
    """Return the loss of diameter, mm, that a condition is expected to cost."""
    return Estimator(rig).condition(step).loss_mm


class Procedure(Protocol):
    """How a condition is measured, as far as its cost goes: a ConditionStep, or a grid's Settings."""

    @property
    def repeats(self) -> int:
        """Repeats."""
        ...

    @property
    def window(self) -> Window:
        """What a repeat collects."""
        ...

    @property
    def temperature_band_k(self) -> float:
        """Half the width of the temperature gate, K."""
        ...

    @property
    def soak(self) -> Soak:
        """What comes before the first repeat."""
        ...

    @property
    def max_bursts(self) -> int:
        """Most pulses a repeat."""
        ...


class Estimator:
    """Estimates for one rig; conditions are remembered by what is held in them."""

    def __init__(self, rig: RigConfig, constants: EstimateConstants = CONSTANTS) -> None:
        """Work out what depends on the rig alone."""
        self.cool_c, self.cool_at_most_s = rig.interlocks.cooldown_hub_c, rig.interlocks.cooldown_at_most_s
        believed = rig.observer
        thermal = believed.thermal
        diameter_m = 1e-3 * rig.geometry.wheel_diameter_mm
        width_m = 1e-3 * rig.geometry.wheel_width_mm
        effusivity = math.sqrt(thermal.conductivity * thermal.density * thermal.heat_capacity)
        area_m2 = math.pi * diameter_m * width_m
        self.constants = constants
        self.ambient_c = rig.ambient_c
        self.turn_m = math.pi * diameter_m
        # K per W of friction and per sqrt(s): the heat spreads over the whole tread, which turns below it.
        self.rise_k = 2.0 * believed.friction_heat_fraction / (area_m2 * effusivity * math.sqrt(math.pi))
        # V = k F s; a ring of the tread's area, on both sides of the diameter.
        self.loss_mm_per_nm = 2.0 * rig.wear.rate_mm3_per_n_m / (area_m2 * 1e6)
        self.rubber_share = believed.friction_heat_fraction
        self.person_s = 0.0 if rig.simulated else constants.person_s
        self.offset_k = rig.loops.heat.rolling_offset_k
        self.body = Body(rig)
        self.models = {name: FrictionModel(name, rig.sim.friction_model) for name in KNOWN}
        self._procedure: tuple[object, ...] = ()
        self._costs: dict[Setpoint, StepEstimate] = {}
        self._remembered: dict[tuple[object, ...], dict[Setpoint, StepEstimate]] = {}
        self._slips: dict[tuple[float, float, float], float] = {}

    def walk(self, plan: Plan) -> list[StepEstimate]:
        """Return an estimate for every step; the wheel's temperature is carried from one to the next."""
        compound = ""
        body_c = self.ambient_c
        cold_rubber = False
        result: list[StepEstimate] = []
        for step in plan.steps:
            if isinstance(step, ConditionStep):
                one = self.condition(step)
                body_c = self.body.steady_c(step.setpoint.temperature_c)
            elif cold_rubber and isinstance(step, Rest):
                one = StepEstimate(step.at_least_s)  # new rubber is at ambient, whatever the hub below it
            else:
                if isinstance(step, Install):
                    compound = step.compound
                cold_rubber = isinstance(step, Install) or (cold_rubber and isinstance(step, Prompt))
                one, body_c = self._preparation(step, compound, body_c)
            result.append(one)
        return result

    def shut_down_s(self, plan: Plan) -> float:
        """Return the seconds from the last step to standstill: a hot jacket is cooled turning."""
        last = next((step for step in reversed(plan.steps) if isinstance(step, ConditionStep)), None)
        if last is None:
            return 0.0
        body_c = self.body.steady_c(last.setpoint.temperature_c)
        return min(self.body.cooling_s(body_c, self.cool_c, turning=True), self.cool_at_most_s)

    def mu(self, compound: str, temperature_c: float, load_n: float, slip_m_s: float, sideslip_deg: float) -> float:
        """Return the friction coefficient expected; a round figure for a compound without a model."""
        model = self.models.get(compound)
        if model is None:
            return self.constants.unknown_mu
        return model.mu(temperature_c, load_n, slip_m_s) * cornering_factor(compound, sideslip_deg)

    def condition(self, step: ConditionStep) -> StepEstimate:
        """Return what a condition takes, without the heating before it."""
        return self.cost(step.setpoint, step)

    def cost(self, setpoint: Setpoint, how: Procedure) -> StepEstimate:
        """Return what holding a setpoint takes when it is measured like this."""
        key = (how.repeats, how.window, how.temperature_band_k, how.soak, how.max_bursts)
        if key != self._procedure:
            # Whole grids are measured alike: their conditions are looked up by setpoint alone.
            self._procedure = key
            self._costs = self._remembered.setdefault(key, {})
        known = self._costs.get(setpoint)
        if known is None:
            known = self._costs[setpoint] = self._cost(setpoint, how)
        return known

    def pre_grind(self, step: PreGrind, compound: str) -> StepEstimate:
        """Return what grinding a new wheel takes."""
        slip = abs(step.wheel_speed_m_s - step.belt_speed_m_s)
        power = self.mu(compound, self.ambient_c, step.load_n, slip, 0.0) * step.load_n * slip
        sliding = slip * step.duration_s
        return StepEstimate(
            seconds=step.duration_s + self.constants.pre_grind_moves_s,
            sliding_m=sliding,
            loss_mm=self.ground_mm(step.load_n, sliding),
            friction_j=power * step.duration_s,
            peak_c=self.ambient_c + self.rise_k * power * math.sqrt(step.duration_s),
        )

    def ground_mm(self, load_n: float, sliding_m: float) -> float:
        """Return the loss of diameter, mm, of sliding a distance (m) under a load (N)."""
        return self.loss_mm_per_nm * load_n * sliding_m

    def _preparation(self, step: Step, compound: str, body_c: float) -> tuple[StepEstimate, float]:
        """Return what a step other than a condition takes, and the wheel's mean temperature after it."""
        c = self.constants
        match step:
            case Install():
                return StepEstimate(c.install_s + self.person_s), self.body.with_new_rubber(body_c)
            case PreGrind():
                one = self.pre_grind(step, compound)
                return one, body_c + self.body.warmed_k(self.rubber_share * one.friction_j)
            case Rest():
                cooled = math.inf if step.until_c is None else step.until_c + step.within_k
                wait = max(step.at_least_s, self.body.cooling_s(body_c, cooled, turning=False))
                wait = min(wait, step.at_most_s)
                return StepEstimate(wait), self.body.after_c(body_c, wait)
            case Heat():
                rise = step.temperature_c - self.offset_k - self.body.surface_c(body_c)
                seconds = c.heat_lag_s + c.heat_per_k_s * rise if rise > NEAR_K else 0.0
                return StepEstimate(seconds, peak_c=step.temperature_c), self.body.steady_c(step.temperature_c)
            case Cool():
                seconds = self.body.cooling_s(body_c, step.hub_below_c, turning=True)
                return StepEstimate(seconds), min(body_c, step.hub_below_c)
            case Prompt():
                return StepEstimate(self.person_s), body_c
            case ConditionStep():
                return self.condition(step), body_c

    def _cost(self, sp: Setpoint, step: Procedure) -> StepEstimate:
        c = self.constants
        slip = self._slip(sp)
        yawed = sp.sideslip_deg != 0.0 or sp.camber_deg != 0.0
        turn_s = self.turn_m / sp.wheel_speed_m_s
        window_s = c.extension * step.window.duration_s(1.0 / turn_s)
        soak_s = step.soak.for_s + c.next_condition_s
        if slip < 1e-9:
            seconds = soak_s + c.rolling_settle_s + step.repeats * (c.repeat_moves_s + window_s)
            return StepEstimate(seconds, peak_c=sp.temperature_c, bursts=1)
        power = self.mu(sp.compound, sp.temperature_c, sp.load_n, slip, sp.sideslip_deg) * sp.load_n * slip
        edge_s = c.yawed_slide_s if yawed else c.burst_edge_s
        edge_s += c.split_turns * turn_s
        bursts, counted_s, held = self._bursts(step, turn_s, window_s, edge_s, self.rise_k * power)
        repeats = step.repeats if held else 1
        slide_s = counted_s + bursts * edge_s
        moves_s = c.yawed_moves_s + 2.0 * abs(sp.sideslip_deg) / c.yaw_deg_s if yawed else 0.0
        cooling_s = self._cooling_s(sp.temperature_c, slide_s / bursts, power)
        sliding_m = repeats * slip * slide_s
        above_k = min(step.temperature_band_k, self.offset_k, self.rise_k * power * math.sqrt(slide_s / bursts))
        return StepEstimate(
            seconds=soak_s + repeats * (c.repeat_moves_s + slide_s + bursts * (moves_s + cooling_s)),
            sliding_m=sliding_m,
            loss_mm=self.ground_mm(sp.load_n, sliding_m),
            friction_j=repeats * power * slide_s,
            peak_c=sp.temperature_c + above_k,
            bursts=bursts,
            held=held,
        )

    def _cooling_s(self, temperature_c: float, slide_s: float, power_w: float) -> float:
        """Return the seconds between pulses in which the surface comes back below the setpoint."""
        c = self.constants
        above_k = max(temperature_c - self.offset_k - self.ambient_c, c.cooling_floor_k)
        leaves_s = self.rubber_share * power_w * slide_s / (self.body.rolling_w_k * above_k)
        return min(max(leaves_s, c.cooling_ratio * slide_s, c.cooling_least_s), c.cooling_most_s)

    def _slip(self, sp: Setpoint) -> float:
        """Return the resultant slip speed in m/s; a grid has few different ones."""
        key = (sp.wheel_speed_m_s, sp.slip_velocity_m_s, sp.sideslip_deg)
        slip = self._slips.get(key)
        if slip is None:
            slip = self._slips[key] = slip_velocity(sp.wheel_speed_m_s, sp.belt_speed_m_s, sp.sideslip_deg)[2]
        return slip

    def _bursts(
        self, step: Procedure, turn_s: float, window_s: float, edge_s: float, rise_k: float
    ) -> tuple[int, float, bool]:
        """Return bursts a repeat, seconds counted a repeat, and whether the temperature holds for a revolution.

        ``rise_k`` is the surface's rise in K per square root of a second.
        """
        c, band_k = self.constants, step.temperature_band_k
        if rise_k <= 0.0:
            return 1, window_s, True
        # From below the setpoint to as far above it, so that the samples centre on it ...
        each_s = ((self.offset_k + min(band_k, self.offset_k)) / rise_k) ** 2 - edge_s
        if each_s < c.few_turns * turn_s:
            # ... or, where that is over too soon, from below the band to its top.
            whole_s = ((2.0 * band_k + c.below_band_k) / rise_k) ** 2
            counted_s = whole_s - max(edge_s, (c.below_band_k / rise_k) ** 2)
            each_s = max(each_s, min(counted_s, c.few_turns * turn_s))
        if each_s < turn_s:
            return c.bursts_tried, 0.0, False
        bursts = min(math.ceil(window_s / each_s), step.max_bursts)
        return bursts, min(window_s, bursts * each_s), True
