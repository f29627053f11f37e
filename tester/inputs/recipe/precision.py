"""Repeats needed for a precision, and the floor that repeats cannot lower.

``until`` is type A alone: the expanded repeatability of a mean. The instruments' contribution does not average out; a
total uncertainty below that floor is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, sqrt
from typing import TypeVar

from tester.analysis.uncertainty import Pool
from tester.base.axes import condition_words
from tester.base.trouble import MisuseError
from tester.inputs.recipe.foreseen import Foreseen
from tester.inputs.recipe.plan import ConditionStep, Plan
from tester.inputs.recipe.recipe_schema import MAX_REPEATS, Recipe, RepeatsModel
from tester.inputs.recipe.repeats_section import needed, reached_percent, s_of_values
from tester.inputs.recipe.time_estimate import HISTORIC_PERCENT, Estimate, Estimator

AnyRecipe = TypeVar("AnyRecipe", bound=Recipe)


class PrecisionError(MisuseError):
    """An unreachable total uncertainty; the message names the floor and its largest term."""


def floor_percent(foreseen: Foreseen) -> float:
    """Return the expanded uncertainty (95 %) that repeating does not lower, per cent of the coefficient."""
    return 100.0 * foreseen.instruments.expanded / foreseen.mu


def until_for_total(total_percent: float, predictions: Sequence[Foreseen]) -> float:
    """Return the repeatability (expanded, per cent) that gives every condition this total uncertainty.

    Raises PrecisionError where the instruments alone have more.
    """
    highest = max(predictions, key=floor_percent, default=None)
    if highest is None:
        return total_percent
    floor = floor_percent(highest)
    if total_percent <= floor:
        where = condition_words(highest.step.setpoint)
        largest = "{} {:.2f} %".format(*_largest(highest))
        raise PrecisionError(
            f"a total uncertainty of {total_percent:g} % cannot be reached: {where} has {floor:.2f} % from "
            f"the instruments alone (95 %), of which {largest}; repeating does not lower it"
        )
    return sqrt(total_percent**2 - floor**2)


def _largest(foreseen: Foreseen) -> tuple[str, float]:
    """Return the largest term of the instruments, and its expanded value, per cent."""
    worst = max(foreseen.instruments.contributions, key=lambda term: term.standard)
    return worst.name, 100.0 * foreseen.instruments.coverage * worst.standard / foreseen.mu


def with_precision(recipe: AnyRecipe, percent: float) -> AnyRecipe:
    """Return a recipe that repeats each condition until its expanded repeatability is reached, however often."""

    def unbounded(repeats: RepeatsModel) -> RepeatsModel:
        return repeats.model_copy(update={"at_most": MAX_REPEATS})

    if recipe.measure is None:
        return recipe
    measure = recipe.measure.model_copy(update={"until": percent, "repeats": unbounded(recipe.measure.repeats)})
    grids = [
        grid.model_copy(update={"until": None, "repeats": None if grid.repeats is None else unbounded(grid.repeats)})
        for grid in recipe.grids
    ]
    return recipe.model_copy(update={"measure": measure, "grids": grids})


def precision_lines(
    plan: Plan, estimate: Estimate, estimator: Estimator, pools: Mapping[str, Pool], predictions: Sequence[Foreseen]
) -> Iterator[str]:
    """Yield the cost of the requested precision: repeats, the origin of s, the instruments' part. Yields nothing
    without a request.

    ``predictions``: those for the plan's conditions.
    """
    asked = [step for step in plan.conditions() if step.until_percent is not None]
    if not asked:
        return
    made = [
        step_estimate.repeats
        for step, step_estimate in zip(plan.steps, estimate.steps, strict=True)
        if isinstance(step, ConditionStep) and step.until_percent is not None
    ]
    wanted = sorted({step.until_percent for step in asked if step.until_percent is not None})
    words = ", ".join(f"{percent:.3g} %" for percent in wanted)
    yield f"repeatability     {words} (type A, expanded, 95 %): {min(made):.0f} to {max(made):.0f} repeats a condition"
    for compound in dict.fromkeys(step.setpoint.compound for step in asked):
        pool = pools.get(compound)
        source = f"{pool.df} degrees of freedom in stored runs" if pool else "assumed: nothing is stored"
        yield f"                  {compound}: s = {estimator.s_percent(compound):.2g} % between repeats, {source}"
    short = [step for step in asked if _short(step, estimator)]
    if short:
        step = short[0]
        most = reached_percent(step, estimator.s_percent(step.setpoint.compound))
        yield f"                  at_most {step.at_most} repeats reach {most:.2g} % only, in {len(short)} conditions"
    highest = max(predictions, key=floor_percent, default=None)
    if highest is not None:
        least = min(map(floor_percent, predictions))
        part = "largest: {}, {:.2g} %".format(*_largest(highest))
        yield f"                  the instruments add {least:.2g} to {floor_percent(highest):.2g} % ({part})"


def _short(step: ConditionStep, estimator: Estimator) -> bool:
    s_percent = s_of_values(step, estimator.s_percent(step.setpoint.compound))
    return needed(step.until_percent or inf, s_percent) > step.at_most


def s_percents(pools: Mapping[str, Pool]) -> dict[str, float]:
    """Return the expected standard deviation between repeats of each compound, per cent."""
    return {compound: pool.s_percent if pool.df else HISTORIC_PERCENT for compound, pool in pools.items()}
