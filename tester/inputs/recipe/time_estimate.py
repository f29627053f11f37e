"""Duration, wear and temperature of a plan: sums of the estimates of its kind's estimator for each step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Final, NamedTuple

from tester.analysis.kelvin import UNKNOWN, Slope
from tester.analysis.left_out import REPEATABILITY
from tester.inputs.recipe.plan import ConditionStep, Plan

if TYPE_CHECKING:
    from tester.analysis.uncertainty import Budget
    from tester.base.axes import Setpoint


HISTORIC_PERCENT: Final = 100.0 * REPEATABILITY
"""Standard deviation between repeats without stored runs, per cent of the coefficient [A]."""


class StepEstimate(NamedTuple):
    """Estimate of one step: rig time s, sliding m, rubber worn off mm, friction heat J, surface peak degC.

    ``bursts``: contacts a repeat; ``held`` is False where the temperature does not hold long enough to measure.
    ``waiting_s``: the part of the time that waits for a temperature, and scatters with it. ``heat_w``: friction heat in
    the rubber during a contact. ``repeats``: expected number, with make-ups. A kind leaves out values that it does not
    know.
    """

    seconds: float
    sliding_m: float = 0.0
    loss_mm: float = 0.0
    friction_j: float = 0.0
    peak_c: float = -math.inf
    bursts: int = 0
    held: bool = True
    waiting_s: float = 0.0
    heat_w: float = 0.0
    repeats: float = 0.0


@dataclass(frozen=True, slots=True)
class Outlook:
    """Expectations for a condition's uncertainty beside its setpoint: wear by then, mm; whether a check of the diameter
    is made before and after it; the known sensitivity to temperature; and whether it is measured in both directions,
    None: as in the step."""

    loss_mm: float = 0.0
    checked: bool = False
    slope: Slope = UNKNOWN
    both_directions: bool | None = None


NEW: Final = Outlook()
"""For a new piece without prior knowledge."""


class Estimator:
    """A kind's estimates of the time that steps take on one rig. Subclasses implement ``walk`` and ``shut_down_s``.

    The defaults of the other methods suit a kind that expects no coefficient and wears nothing off.
    """

    spread: ClassVar[float] = 0.2
    """Half the range of the rig time of 95 % of runs, as its share [A]."""

    def __init__(self, repeatability: Mapping[str, float] | None = None) -> None:
        """``repeatability``: standard deviation between repeats, per cent of the coefficient, by compound."""
        self.repeatability = repeatability or {}

    def walk(self, plan: Plan) -> Sequence[StepEstimate]:
        """Return an estimate for every step of a plan."""
        raise NotImplementedError

    def shut_down_s(self, plan: Plan) -> float:
        """Return the seconds from the last step to standstill."""
        raise NotImplementedError

    def range_s(self, plan: Plan, steps: Sequence[StepEstimate], down_s: float) -> tuple[float, float]:
        """Return the range of rig time, s, in which 95 % of runs end; ``down_s``: the value of ``shut_down_s``."""
        seconds = sum(step.seconds for step in steps) + down_s
        return (1.0 - self.spread) * seconds, (1.0 + self.spread) * seconds

    def leapt_s(self, plan: Plan, steps: Sequence[StepEstimate]) -> float:
        """Return the seconds that a simulated rig in virtual time leaps (``tester.machine.leaps``)."""
        return 0.0

    def s_percent(self, compound: str) -> float:
        """Return the expected standard deviation between repeats, per cent of the coefficient."""
        return self.repeatability.get(compound, HISTORIC_PERCENT)

    def mu(self, setpoint: Setpoint) -> float | None:
        """Return the expected coefficient at a setpoint; None where there is none, such as without sliding."""
        return None

    def outlooks(self, plan: Plan, steps: Sequence[StepEstimate]) -> Iterable[Outlook]:
        """Return the expectations for each condition of a plan, in order, from the estimates of the plan's steps."""
        return (NEW for _ in plan.conditions())

    def reversible(self, step: ConditionStep) -> bool:
        """Return whether a condition could be measured in both directions of sliding."""
        return False

    def budget(self, step: ConditionStep, outlook: Outlook = NEW) -> tuple[float, Budget] | None:
        """Return the expected coefficient of a condition, and the instruments' budget for it.

        None for a condition without a coefficient, such as one without sliding, and where the budget is unknown.
        """
        return None


@dataclass(frozen=True, slots=True)
class Estimate:
    """Totals of a plan; ``steps`` run parallel to the plan's. Units as in ``StepEstimate``.

    ``rig_seconds`` includes the time from the last step to standstill.
    """

    steps: tuple[StepEstimate, ...]
    rig_seconds: float
    rig_seconds_low: float
    rig_seconds_high: float
    """Range of the rig time, 95 % of runs."""
    sliding_m: float
    loss_mm: float
    """Rubber worn off, summed over all specimens."""
    friction_j: float
    peak_c: float
    leapt_s: float = 0.0
    """Part of the rig time that a simulated rig in virtual time leaps."""
    not_held: tuple[int, ...] = field(default=())
    """Numbers of the conditions whose temperature is not expected to hold within the band."""


def estimate(plan: Plan, estimator: Estimator) -> Estimate:
    """Return the totals of a plan, from its kind's estimator for the rig."""
    steps = estimator.walk(plan)
    not_held = [
        step.condition
        for step, step_estimate in zip(plan.steps, steps, strict=True)
        if not step_estimate.held and isinstance(step, ConditionStep)
    ]
    down_s = estimator.shut_down_s(plan)
    seconds = math.fsum(step.seconds for step in steps) + down_s
    low, high = estimator.range_s(plan, steps, down_s)
    return Estimate(
        steps=tuple(steps),
        rig_seconds=seconds,
        rig_seconds_low=low,
        rig_seconds_high=high,
        sliding_m=math.fsum(step.sliding_m for step in steps),
        loss_mm=math.fsum(step.loss_mm for step in steps),
        friction_j=math.fsum(step.friction_j for step in steps),
        peak_c=max((step.peak_c for step in steps), default=-math.inf),
        leapt_s=estimator.leapt_s(plan, steps),
        not_held=tuple(not_held),
    )
