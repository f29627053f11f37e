"""Estimates of a plan's duration, wear and temperatures: closed formulas, no simulation.

Times are sums of the executor's moves; the times of conditions are in ``.cost``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from sim.physics.slip import slip_velocity
from tester.analysis.terms import Size
from tester.analysis.uncertainty import Budget
from tester.base.axes import Setpoint
from tester.inputs.recipe.plan import ConditionStep, Plan, PromptStep, Step
from tester.inputs.recipe.repeats_section import MADE_UP, POOLED_DF, SURE, expected
from tester.inputs.recipe.time_estimate import NEW, Estimator, Outlook, StepEstimate
from tester.kinds.wheel_on_belt.budget import ROLL_CHECK_TURNS, TOUCHES_U_MM, instruments_budget, roll_check_u_mm
from tester.kinds.wheel_on_belt.image.axes import POSITIONED, held_by
from tester.kinds.wheel_on_belt.recipe.constants import CONSTANTS, EstimateConstants
from tester.kinds.wheel_on_belt.recipe.cost import ROLLING_M_S, ConditionCosts
from tester.kinds.wheel_on_belt.recipe.order import Before, Body, OrderCosts
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    ChangeBelt,
    Cool,
    Heat,
    Install,
    PreGrind,
    Rest,
    ToolPrompt,
    WheelCondition,
    WheelPlan,
    starts_of,
)
from tester.kinds.wheel_on_belt.recipe.wheel_change import TOUCH

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig import RigConfig

LEAPT: Final = 0.85
"""Share of the time of rests and cool-downs that is leapt; from simulated runs [A]."""


def predicted_loss_mm(step: WheelCondition, rig: RigConfig) -> float:
    """Return the expected loss of diameter in a condition, mm."""
    return WheelEstimator(rig).condition(step).loss_mm


def _precision_range_s(plan: Plan, steps: Sequence[StepEstimate]) -> tuple[float, float]:
    """Return how much sooner and later, s, precisions that depend on a run's own deviation may be reached."""
    sooner_s = later_s = 0.0
    least, most = SURE
    for step, estimate in zip(plan.steps, steps, strict=True):
        if isinstance(step, WheelCondition) and step.until_percent is not None and estimate.repeats:
            moves_s = estimate.seconds - estimate.waiting_s
            values = estimate.repeats / step.scheme.repeats_each
            sooner_s += (1.0 - min(max(least * least, step.repeats / values), 1.0)) * moves_s
            later_s += (max(min(most * most, step.at_most / values), 1.0) - 1.0) * moves_s
    return sooner_s, later_s


class WheelEstimator(Estimator):
    """Estimates for one rig; the costs of conditions are cached."""

    def __init__(
        self,
        rig: RigConfig,
        constants: EstimateConstants = CONSTANTS,
        repeatability: Mapping[str, float] | None = None,
    ) -> None:
        """Compute all that depends on the rig alone. ``repeatability``: s between repeats, per cent, by compound."""
        self.constants = constants
        self.ambient_c = rig.ambient_c
        self.diameter_mm = rig.geometry.wheel_diameter_mm
        self.check_u_mm = math.sqrt(2.0) * roll_check_u_mm(rig)
        """Standard uncertainty of a loss between two roll checks."""
        self.cool_c, self.cool_at_most_s = rig.interlocks.cooldown_hub_c, rig.interlocks.cooldown_at_most_s
        self.tool_hub_c = rig.limits.tool_hub_c
        self.parts = rig.simulated
        """Whether each replicate of each specimen is a part of the run, on its own simulated rig."""
        self.person_s = 0.0 if rig.simulated else constants.person_s
        self.body = Body(rig)
        self.costs = ConditionCosts(rig, constants, repeatability)
        self.order = OrderCosts(rig, constants, self.body)

    def walk(self, plan: Plan) -> list[StepEstimate]:
        """Return an estimate for every step; the wheel's temperature is carried from one to the next."""
        compound = ""
        starts = self._part_starts(plan)
        body_c = self.ambient_c
        cold_rubber = False
        last: WheelCondition | None = None
        before = Before(self.ambient_c)
        prompted = False
        result: list[StepEstimate] = []
        for place, step in enumerate(plan.steps):
            if isinstance(step, WheelCondition):
                estimate = self.condition(step)
                looked_at = step.wear_check == "prompt"
                if looked_at or prompted:
                    if last is not None:
                        body_c = self.body.steady_c(last.setpoint.number("temperature"))
                    estimate = self._after_person(estimate, step, body_c, asked=looked_at)
                    prompted = False
                if step.until_percent is not None:
                    estimate = self._until(before, step, estimate)
                estimate = self.order.after(before, step.setpoint, estimate)
                last = step
                result.append(estimate._replace(seconds=estimate.seconds + self._checks_s(plan, place, step)))
                continue
            prompted = isinstance(step, PromptStep | ChangeBelt)
            if last is not None:
                body_c = self.body.steady_c(last.setpoint.number("temperature"))
                last = None
            if place in starts:
                body_c, before = self.ambient_c, Before(self.ambient_c)
            if cold_rubber and isinstance(step, Rest):
                estimate = StepEstimate(step.at_least_s)  # new rubber is at ambient, whatever the hub's temperature
            else:
                if isinstance(step, Install):
                    compound = step.compound
                cold_rubber = isinstance(step, Install) or (cold_rubber and prompted)
                if isinstance(step, Heat):
                    before.heat(self.body.surface_c(body_c))
                estimate, body_c = self._preparation(step, compound, body_c)
            result.append(estimate._replace(seconds=estimate.seconds + self._checks_s(plan, place, step)))
        return result

    def _checks_s(self, plan: Plan, place: int, step: Step) -> float:
        """Return the time of a step's roll checks, s.

        A new wheel is checked when it is mounted, then before each condition, and once more after its last condition
        (``WheelProcedures``).
        """
        behind = (plan.steps[at] for at in range(place + 1, len(plan.steps)))
        follower = next((later for later in behind if isinstance(later, WheelCondition | Install)), None)
        checked_next = isinstance(follower, WheelCondition) and follower.wear_check == "each_condition"
        if isinstance(step, Install) and step.worn is None and isinstance(follower, WheelCondition):
            return checked_next * self._roll_check_s(follower)
        if isinstance(step, WheelCondition) and step.wear_check == "each_condition":
            return (1 if checked_next else 2) * self._roll_check_s(step)
        return 0.0

    def _roll_check_s(self, step: WheelCondition) -> float:
        """Return the time of a check of the diameter by rolling, s: its moves, and whole turns at the wheel's speed."""
        turn_s = self.costs.turn_m / step.setpoint.number("wheel_speed")
        return self.constants.roll_check_s + ROLL_CHECK_TURNS * turn_s

    def _in_parts(self, plan: Plan) -> bool:
        return self.parts and not (isinstance(plan, WheelPlan) and plan.references)  # manual mode has a plain plan

    def _part_starts(self, plan: Plan) -> set[int]:
        """Return the positions of the first steps of further parts: each is on its own rig, at ambient."""
        if not self._in_parts(plan):
            return set()
        return set(starts_of(plan.steps, lambda install: (install.specimen, install.replicate))[1:])

    def _until(self, before: Before, step: WheelCondition, estimate: StepEstimate) -> StepEstimate:
        """Return an estimate with the repeats for a precision early in a run, when few repeats are pooled."""
        repeats, each = estimate.repeats, step.scheme.repeats_each
        if estimate.held and before.pooled < POOLED_DF:
            repeats = each * expected(step, self.costs.s_percent(step.setpoint.compound), before.pooled)
        before.pooled += int(repeats) // each - 1
        if repeats == estimate.repeats:
            return estimate
        share = repeats / estimate.repeats
        soak_s = step.soak.for_s + self.constants.next_condition_s
        return estimate._replace(
            seconds=soak_s + share * (estimate.seconds - soak_s),
            sliding_m=share * estimate.sliding_m,
            loss_mm=share * estimate.loss_mm,
            friction_j=share * estimate.friction_j,
            waiting_s=share * estimate.waiting_s,
            repeats=repeats,
        )

    def range_s(self, plan: Plan, steps: Sequence[StepEstimate], down_s: float) -> tuple[float, float]:
        """Return the expected range of rig time, s, for 95 % of runs.

        Waits for temperatures depend on the thermometer's bias, which is constant in a session, so their deviations add
        up. Replacement repeats are independent (Poisson). A precision's repeats depend on the run's own deviation.
        """
        seconds, waits_s, scattered = 0.0, down_s, 0.0
        lifted_s, heated = 0.0, False
        for step, estimate in zip(plan.steps, steps, strict=True):
            if heated and isinstance(step, WheelCondition):
                lifted_s += self.order.lift_later_s(step.setpoint, estimate)
            heated = isinstance(step, Heat)
            took_s = estimate.seconds
            seconds += took_s
            waits_s += estimate.waiting_s
            if estimate.repeats:
                scattered += MADE_UP * took_s * took_s / estimate.repeats
        sooner_s, later_s = _precision_range_s(plan, steps)
        seconds += down_s
        low = seconds - (1.0 - self.constants.waits_least) * waits_s - sooner_s
        later_s += (self.constants.waits_most - 1.0) * waits_s + lifted_s
        return low, seconds + later_s + 2.0 * math.sqrt(scattered)

    def s_percent(self, compound: str) -> float:
        """Return the expected standard deviation between repeats, per cent of the coefficient."""
        return self.costs.s_percent(compound)

    def mu(self, setpoint: Setpoint) -> float | None:
        """Return the expected coefficient at a setpoint; None without slip."""
        sp = held_by(setpoint)
        slip_m_s = slip_velocity(sp.wheel_speed_m_s, sp.belt_speed_m_s, sp.sideslip_deg)[2]
        if slip_m_s < ROLLING_M_S:
            return None
        return self.costs.mu(sp.compound, sp.temperature_c, sp.load_n, slip_m_s, sp.sideslip_deg)

    def outlooks(self, plan: Plan, steps: Sequence[StepEstimate]) -> Iterator[Outlook]:
        """Yield the wheel's expected wear in the middle of each condition, and whether a check is next to it."""
        worn: dict[int, float] = {}
        wheel = 0
        for step, estimate in zip(plan.steps, steps, strict=True):
            if isinstance(step, Install):
                wheel = step.wheel
            before_mm = worn.get(wheel, 0.0)
            worn[wheel] = before_mm + estimate.loss_mm
            if isinstance(step, WheelCondition):
                yield Outlook(before_mm + 0.5 * estimate.loss_mm, checked=step.wear_check != "never")

    def reversible(self, step: ConditionStep) -> bool:
        """Return whether a condition can be measured in both directions: it slides, without an angle."""
        slides = held_by(step.setpoint).slip_velocity_m_s != 0.0
        return slides and not any(step.setpoint.number(axis.name) for axis in POSITIONED)

    def budget(self, step: ConditionStep, outlook: Outlook = NEW) -> tuple[float, Budget] | None:
        """Return the expected coefficient, and the instruments' part of its uncertainty; None without slip."""
        sp, mu = held_by(step.setpoint), self.mu(step.setpoint)
        if mu is None:
            return None
        slip_m_s = slip_velocity(sp.wheel_speed_m_s, sp.belt_speed_m_s, sp.sideslip_deg)[2]
        both = step.both_directions if outlook.both_directions is None else outlook.both_directions
        u_mm = self.check_u_mm if outlook.checked else min(TOUCHES_U_MM, outlook.loss_mm)
        size = Size(self.diameter_mm - outlook.loss_mm, outlook.loss_mm, u_mm)
        return mu, instruments_budget(sp, mu, slip_m_s, size, outlook.slope, both_directions=both)

    def shut_down_s(self, plan: Plan) -> float:
        """Return the seconds from the last step to standstill: a hot jacket cools while turning."""
        last: dict[tuple[int, int], WheelCondition] = {}
        parts = self._in_parts(plan)
        for step in plan.steps:
            if isinstance(step, WheelCondition):
                last[(step.specimen, step.replicate) if parts else (0, 0)] = step
        cool_c = self.body.mean_at_hub_c(self.cool_c)
        return math.fsum(
            min(
                self.body.cooling_s(self.body.steady_c(step.setpoint.number("temperature")), cool_c, turning=True),
                self.cool_at_most_s,
            )
            for step in last.values()
        )

    def leapt_s(self, plan: Plan, steps: Sequence[StepEstimate]) -> float:
        """Return the seconds leapt while the wheel rests and cools."""
        pairs = zip(plan.steps, steps, strict=True)
        waits_s = math.fsum(estimate.seconds for step, estimate in pairs if isinstance(step, Rest | Cool))
        return LEAPT * (waits_s + self.shut_down_s(plan))

    def condition(self, step: WheelCondition) -> StepEstimate:
        """Return a condition's estimate, without the heating before it."""
        return self.costs.of(step.setpoint, step)

    def _after_person(
        self, estimate: StepEstimate, step: WheelCondition, body_c: float, *, asked: bool
    ) -> StepEstimate:
        """Return a condition's estimate with the cost of a person at the wheel: cooling, their time, warming again.

        ``asked``: cooling and person belong to the condition's own check, not to a prompt step before it.
        """
        seconds = estimate.seconds
        if asked:
            person, body_c = self._asking(body_c, TOUCH)
            seconds += person.seconds
        warmed, _ = self._preparation(Heat(step.index, step.setpoint.number("temperature")), "", body_c)
        return estimate._replace(seconds=seconds + warmed.seconds)

    def _asking(self, body_c: float, cool: Cool) -> tuple[StepEstimate, float]:
        """Return the estimate of a question at the wheel: cooling while it turns, and its first contact again."""
        cooled, body_c = self._preparation(cool, "", body_c)
        return StepEstimate(cooled.seconds + self.person_s + self.constants.install_s), body_c

    def pre_grind(self, step: PreGrind, compound: str) -> StepEstimate:
        """Return the estimate of grinding a new wheel."""
        slip = abs(step.wheel_speed_m_s - step.belt_speed_m_s)
        power = self.costs.mu(compound, self.ambient_c, step.load_n, slip, 0.0) * step.load_n * slip
        sliding = slip * step.duration_s
        return StepEstimate(
            seconds=step.duration_s + self.constants.pre_grind_moves_s,
            sliding_m=sliding,
            loss_mm=self.costs.ground_mm(step.load_n, sliding),
            friction_j=power * step.duration_s,
            peak_c=self.ambient_c + self.costs.rise_k * power * math.sqrt(step.duration_s),
        )

    def _preparation(self, step: Step, compound: str, body_c: float) -> tuple[StepEstimate, float]:
        """Return the estimate of a step other than a condition, and the wheel's mean temperature after it."""
        c = self.constants
        match step:
            case Install():
                return StepEstimate(c.install_s + self.person_s), self.body.with_new_rubber(body_c)
            case PreGrind():
                estimate = self.pre_grind(step, compound)
                return estimate, body_c + self.body.warmed_k(self.costs.rubber_share * estimate.friction_j)
            case Rest():
                cooled = math.inf if step.until_c is None else step.until_c + step.within_k
                wait = max(step.at_least_s, self.body.cooling_s(body_c, cooled, turning=False))
                wait = min(wait, step.at_most_s)
                return StepEstimate(wait), self.body.after_c(body_c, wait)
            case Heat():
                seconds = self.order.heat_s(self.body.surface_c(body_c), step.temperature_c)
                heated = StepEstimate(seconds, peak_c=step.temperature_c, waiting_s=seconds)
                return heated, self.body.steady_c(step.temperature_c)
            case Cool():
                seconds = self.body.cooling_s(body_c, step.hub_below_c, turning=True)
                return StepEstimate(seconds), min(body_c, step.hub_below_c)
            case ToolPrompt():
                return self._asking(body_c, Cool(step.index, self.tool_hub_c))
            case PromptStep() | ChangeBelt():
                return self._asking(body_c, TOUCH)
            case WheelCondition():
                return self.condition(step), body_c
            case _:
                raise TypeError(f"{step.kind}: no step of this machine")
