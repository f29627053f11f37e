"""How long a plan takes, what it rubs off and how warm it gets: sums of what a kind's estimator says of each step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol

from tester.analysis.kelvin import UNKNOWN, Slope
from tester.inputs.recipe.plan import ConditionStep, Plan

if TYPE_CHECKING:
    from tester.analysis.uncertainty import Budget
    from tester.base.axes import Setpoint


class StepEstimate(NamedTuple):
    """What one step takes: rig time s, sliding m, rubber worn off mm, friction heat J, surface peak degC.

    ``bursts``: contacts a repeat; ``held`` is False where the temperature does not hold long enough to measure.
    ``waiting_s``: what of the time waits for a temperature, and spreads with it. ``heat_w``: friction heat in the
    rubber during a contact. ``repeats``: expected, with those made up for. A kind leaves out what it does not
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
    """What is expected of a condition's uncertainty beside its setpoint: what is worn off by then, mm; whether a check
    of the diameter is made before and after it; what is known of its sensitivity to temperature; and whether it is
    measured in both directions, None: as the step says."""

    loss_mm: float = 0.0
    checked: bool = False
    slope: Slope = UNKNOWN
    both_directions: bool | None = None


NEW: Final = Outlook()
"""A new piece, of which nothing is known."""


class Estimator(Protocol):
    """What a kind knows of the time that steps take on one rig."""

    def walk(self, plan: Plan) -> Sequence[StepEstimate]:
        """Return an estimate for every step of a plan."""
        ...

    def shut_down_s(self, plan: Plan) -> float:
        """Return the seconds from the last step to standstill."""
        ...

    def range_s(self, plan: Plan, steps: Sequence[StepEstimate], down_s: float) -> tuple[float, float]:
        """Return the range of the rig time, s, that is to hold 95 % of runs; ``down_s``: ``shut_down_s``."""
        ...

    def s_percent(self, compound: str) -> float:
        """Return the standard deviation between repeats that is expected, per cent of the coefficient."""
        ...

    def mu(self, setpoint: Setpoint) -> float | None:
        """Return the coefficient expected at a setpoint; None where there is none, such as where it does not slide."""
        ...

    def outlooks(self, plan: Plan, steps: Sequence[StepEstimate]) -> Iterable[Outlook]:
        """Return what is expected of each condition of a plan, in order, by the estimates of the plan's steps."""
        ...

    def reversible(self, step: ConditionStep) -> bool:
        """Return whether a condition could be measured in both directions of sliding."""
        ...

    def budget(self, step: ConditionStep, outlook: Outlook = NEW) -> tuple[float, Budget] | None:
        """Return the coefficient expected of a condition, and what the instruments add to its uncertainty.

        None for a condition without a coefficient, such as one that does not slide.
        """
        ...


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a plan takes; ``steps`` run parallel to the plan's. Units as in ``StepEstimate``.

    ``rig_seconds`` includes the way from the last step to standstill.
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
    not_held: tuple[int, ...] = field(default=())
    """Numbers of the conditions whose temperature is not expected to hold within the band."""


def estimate(plan: Plan, estimator: Estimator) -> Estimate:
    """Return what a plan takes, by its kind's estimator for the rig."""
    steps = estimator.walk(plan)
    not_held = [
        step.condition
        for step, one in zip(plan.steps, steps, strict=True)
        if not one.held and isinstance(step, ConditionStep)
    ]
    down_s = estimator.shut_down_s(plan)
    seconds = math.fsum(one.seconds for one in steps) + down_s
    low, high = estimator.range_s(plan, steps, down_s)
    return Estimate(
        steps=tuple(steps),
        rig_seconds=seconds,
        rig_seconds_low=low,
        rig_seconds_high=high,
        sliding_m=math.fsum(one.sliding_m for one in steps),
        loss_mm=math.fsum(one.loss_mm for one in steps),
        friction_j=math.fsum(one.friction_j for one in steps),
        peak_c=max((one.peak_c for one in steps), default=-math.inf),
        not_held=tuple(not_held),
    )
