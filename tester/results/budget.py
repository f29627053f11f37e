"""The budget of every condition as a table: what each uncertainty is made of."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from tester.analysis.repeats import ConditionResult
from tester.analysis.uncertainty import Budget, Contribution
from tester.results.cells import Cell
from tester.results.run_results import RunResults
from tester.results.tables import setpoint_header, setpoints

_BUDGET = (
    "level",
    "condition",
    "term",
    "source",
    "distribution",
    "standard_uncertainty",
    "unit",
    "degrees_of_freedom",
    "sensitivity",
    "u_mu",
)


def budget_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each term of each condition's budget, and of the value that stands for replicates.

    ``standard_uncertainty`` is the input's, in ``unit``, ``sensitivity`` the change of the coefficient per unit,
    ``u_mu`` their product. The shares are of the variance of each measurand. Degrees of freedom are empty where a
    limit is taken as known.
    """
    held = setpoint_header(results)
    yield (*_BUDGET[:2], *held, *_BUDGET[2:], f"share_this_{results.worn}", "share_compound")
    for row in results.all_rows():
        for measured in row.replicates:
            own = ("condition", measured.info.condition, *setpoints(measured.info, measured.info.replicate))
            yield from _budget(own, measured.result)
        if len(row.replicates) > 1:
            yield from _budget(("combined", None, *setpoints(row.info, None)), row.result)


def terms_of(r: ConditionResult) -> list[Contribution]:
    """Return the terms of both budgets of a result, each once."""
    return list(dict.fromkeys((*r.budget.contributions, *r.compound_budget.contributions)))


def share_of(one: Contribution, budget: Budget) -> float:
    """Return a term's share of a budget's variance; 0 for one that is none of it."""
    return budget.share(one) if one in budget.contributions else 0.0


def _budget(own: tuple[Cell, ...], r: ConditionResult) -> Iterator[tuple[Cell, ...]]:
    for one in terms_of(r):
        df = one.df if isfinite(one.df) else None
        told = (one.name, one.source, one.distribution, one.input_u, one.unit, df, one.sensitivity, one.standard)
        yield (*own, *told, share_of(one, r.budget), share_of(one, r.compound_budget))
