"""Predicts the uncertainty of a plan's conditions, its largest source, and the changes that would halve this source.

It uses the budget of the results: the machine's terms at the expected coefficient, the repeatability of the recipe's
repeats, and the plan's own knowledge of the sensitivity to temperature and of the diameter. Drift is left out, as it is
unknown beforehand.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, hypot, sqrt
from typing import Final

from tester.analysis.kelvin import CONDITION_SCATTER, UNKNOWN, KnownSlope, Slope, slope_of_pairs
from tester.analysis.measurand import REPEATABILITY
from tester.analysis.terms import Term
from tester.analysis.uncertainty import Budget, Contribution, budget, contribution
from tester.base.axes import Axes, AxisValue, condition_words
from tester.inputs.materials.material_schema import CompoundModel
from tester.inputs.recipe.plan import ConditionStep, Plan
from tester.inputs.recipe.time_estimate import Estimator, Outlook, StepEstimate

MOST: Final = 400
"""Most conditions of a plan that are evaluated, evenly chosen of a longer one [A]: each takes a tenth of a
millisecond."""
STEP_K: Final = 15.0
"""Proposed difference between the temperatures of a pair [A]: that of the paper's Table 2."""
MORE_REPEATS: Final = 4
"""Factor on the repeats that halves the uncertainty due to repeatability."""

_Held = tuple[str, tuple[AxisValue, ...]]


@dataclass(frozen=True, slots=True)
class Foreseen:
    """A condition's expected coefficient, and its budget: of the instruments alone, and with repeatability."""

    step: ConditionStep
    mu: float
    outlook: Outlook
    instruments: Budget
    whole: Budget

    @property
    def largest(self) -> Contribution:
        """Return the largest contribution."""
        return max(self.whole.contributions, key=lambda term: term.standard)

    @property
    def percent(self) -> float:
        """Return the expanded uncertainty (95 %) of this piece, per cent of the coefficient."""
        return 100.0 * self.whole.expanded / self.mu

    def percent_of(self, term: Contribution) -> float:
        """Return a contribution, expanded as the sum is, per cent of the coefficient."""
        return 100.0 * self.whole.coverage * term.standard / self.mu


@dataclass(frozen=True, slots=True)
class Halved:
    """A change of a recipe or a rig that at least halves a contribution, and the result, expanded, per cent of the
    coefficient."""

    words: str
    percent: float


def foreseen(
    plan: Plan, steps: Sequence[StepEstimate], estimator: Estimator, known: Iterable[KnownSlope] = ()
) -> list[Foreseen]:
    """Return the predictions for a plan's sliding conditions; ``steps``: their estimates, ``known``: slopes from files.

    A plan with more than ``MOST`` conditions is represented by that many, evenly chosen.
    """
    outlooks = [*zip(plan.conditions(), estimator.outlooks(plan, steps), strict=True)]
    chosen = outlooks[:: max(1, ceil(len(outlooks) / MOST))]
    slopes = _Slopes(plan, estimator, known, {_held(step, plan.axes) for step, _ in chosen})
    predicted = (_foreseen(step, replace(outlook, slope=slopes.of(step)), estimator) for step, outlook in chosen)
    return [outlook for outlook in predicted if outlook is not None]


def _foreseen(step: ConditionStep, outlook: Outlook, estimator: Estimator, more: int = 1) -> Foreseen | None:
    expected_budget = estimator.budget(step, outlook)
    if expected_budget is None:
        return None
    mu, instruments = expected_budget
    values = step.repeats * more
    each = 2 if (step.both_directions if outlook.both_directions is None else outlook.both_directions) else 1
    s = 0.01 * estimator.s_percent(step.setpoint.compound) / sqrt(each)
    repeating = contribution(REPEATABILITY, s, mu / sqrt(values), source=f"s expected, {values} repeats")
    return Foreseen(step, mu, outlook, instruments, budget([*instruments.contributions, repeating]))


def halved(prediction: Foreseen, estimator: Estimator, terms: Sequence[Term]) -> Halved | None:
    """Return the first change that makes the largest contribution half as large or less; None where none does.

    Each is tried with the budget itself. ``terms``: those of the rig.
    """
    name, limit = prediction.largest.name, 0.5 * prediction.largest.standard * (1.0 + 1e-9)
    for words, outlook, more in _changes(prediction, estimator):
        changed = _foreseen(prediction.step, outlook, estimator, more)
        smaller = changed and next((c for c in changed.whole.contributions if c.name == name), None)
        if changed and smaller and smaller.standard <= limit:
            return Halved(words, changed.percent_of(smaller))
    term = next((each for each in terms if each.name == name and each.setting), None)
    if term is None:
        return None
    known = f"{0.5 * term.bound:g} {term.unit}".removesuffix(" 1")
    words = f"knowing it to {known} (experiment: {{uncertainty.{term.setting}: {0.5 * term.bound:g}}})"
    return Halved(words, 0.5 * prediction.percent_of(prediction.largest))


def _changes(prediction: Foreseen, estimator: Estimator) -> Iterator[tuple[str, Outlook, int]]:
    """Yield each possible change of the recipe: its words, the resulting outlook, the factor on the repeats."""
    step, outlook = prediction.step, prediction.outlook
    if not outlook.checked and outlook.loss_mm > 0.0:
        yield "measure: {wear_check: each_condition}", replace(outlook, checked=True), 1
    if not outlook.slope.known:
        pair = Slope(0.0, sqrt(2.0) * CONDITION_SCATTER / STEP_K, "pair")
        yield f"the same condition at a second temperature, {STEP_K:g} K apart", replace(outlook, slope=pair), 1
    if estimator.reversible(step) and not step.both_directions:
        yield "measure: {both_directions: true}", replace(outlook, both_directions=True), 1
    yield f"measure: {{repeats: {MORE_REPEATS * step.repeats}}}", outlook, MORE_REPEATS


class _Slopes:
    """Sensitivity of each condition from the plan's own temperatures, else the known one of its compound."""

    def __init__(self, plan: Plan, estimator: Estimator, known: Iterable[KnownSlope], wanted: set[_Held]) -> None:
        self._axes, self._axis = plan.axes, _temperature(plan.axes)
        self._known: Mapping[tuple[str, float], KnownSlope] = {
            (known_slope.compound, known_slope.temperature_c): known_slope for known_slope in known
        }
        self._points: dict[_Held, dict[float, float]] = {}
        for step in plan.conditions() if self._axis else ():
            setting = _held(step, self._axes)
            if setting in wanted:
                mu = estimator.mu(step.setpoint)
                if mu is not None:
                    self._points.setdefault(setting, {})[step.setpoint.number(self._axis)] = mu

    def of(self, step: ConditionStep) -> Slope:
        """Return the sensitivity to temperature that the results will know for a condition."""
        if not self._axis:
            return UNKNOWN
        at_c = step.setpoint.number(self._axis)
        pairs = slope_of_pairs(at_c, [*self._points.get(_held(step, self._axes), {}).items()])
        known = self._known.get((step.setpoint.compound, at_c))
        return pairs or (known.slope if known is not None else UNKNOWN)


def _temperature(axes: Axes | None) -> str:
    return next((axis.name for axis in axes or () if axis.unit == "degC"), "")


def _held(step: ConditionStep, axes: Axes | None) -> _Held:
    name = _temperature(axes)
    setpoint = step.setpoint
    return setpoint.compound, tuple(axis.of(setpoint) for axis in setpoint.axes if axis.name != name)


def foreseen_lines(predictions: Sequence[Foreseen], estimator: Estimator, terms: Sequence[Term]) -> Iterator[str]:
    """Yield the predicted uncertainty, for people: the range, the condition with the most, its largest term, and the
    change that halves this term."""
    if not predictions:
        return
    worst, least = max(predictions, key=_percent), min(predictions, key=_percent)
    span = f"{least.percent:.2g} to {worst.percent:.2g}" if len(predictions) > 1 else f"{worst.percent:.2g}"
    yield f"uncertainty       {span} % of this piece (expanded, 95 %), without drift"
    largest = worst.largest
    where = condition_words(worst.step.setpoint)
    yield f"                  most at {where}; largest term {largest.name}, {worst.percent_of(largest):.2g} %"
    better = halved(worst, estimator, terms)
    if better is not None:
        yield f"                  halved by {better.words}: {better.percent:.2g} %"


def _percent(prediction: Foreseen) -> float:
    return prediction.percent


def foreseen_fields(predictions: Sequence[Foreseen], estimator: Estimator, terms: Sequence[Term]) -> dict[str, object]:
    """Return the same as plain data, per cent of the coefficient; empty where no condition slides."""
    if not predictions:
        return {}
    worst, least = max(predictions, key=_percent), min(predictions, key=_percent)
    better = halved(worst, estimator, terms)
    return {
        "least_percent": round(least.percent, 3),
        "most_percent": round(worst.percent, 3),
        "most_at": condition_words(worst.step.setpoint),
        "largest": worst.largest.name,
        "largest_percent": round(worst.percent_of(worst.largest), 3),
        "halved_by": better.words if better is not None else None,
        "halved_percent": round(better.percent, 3) if better is not None else None,
    }


SHARE: Final = 0.3
"""Standard uncertainty of a sensitivity from a file, as a share of it [A]: a law of another batch of rubber, fitted
with residuals of 3 to 6 % over 60 K."""
LEAST_PERCENT: Final = 0.2
"""Least uncertainty of a sensitivity from a file, %/K [A]."""


def known_slopes(plan: Plan, compounds: Mapping[str, CompoundModel]) -> Iterator[KnownSlope]:
    """Yield the slopes in the compounds' files at the plan's temperatures; none beyond their measured range.

    ``compounds``: content of each file, by the name in the recipe.
    """
    axis = next((candidate.name for candidate in plan.axes or () if candidate.unit == "degC"), "")
    if not axis:
        return
    wanted = ((step.setpoint.compound, step.setpoint.number(axis)) for step in plan.conditions())
    for compound, at_c in dict.fromkeys(wanted):
        slope = known_slope(compounds[compound], at_c) if compound in compounds else None
        if slope is not None:
            yield slope


def known_slope(compound: CompoundModel, at_c: float) -> KnownSlope | None:
    """Return the slope in a compound's file at a temperature in degC; None without one, or out of its range."""
    law = compound.over_temperature
    if law is None or not law.least <= at_c <= law.most:
        return None
    percent = 100.0 * law.per_kelvin(at_c)
    source = f"the compound's file: {law.source or compound.source or 'no source'}"
    return KnownSlope(compound.name, at_c, percent, hypot(SHARE * percent, LEAST_PERCENT), source)
