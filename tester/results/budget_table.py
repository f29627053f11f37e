"""The budget of every condition as a table: the parts of each uncertainty."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Final

from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.uncertainty import Budget, Contribution
from tester.results.columns import Column, Output, Table, axis_column
from tester.results.conditions_table import ConditionRow, conditions_table, recipe_rows
from tester.results.run_results import RunResults


@dataclass(frozen=True, slots=True)
class TermRow:
    """A term of a condition's budgets."""

    of: ConditionRow
    term: Contribution

    @property
    def percent(self) -> float:
        """Return its standard uncertainty in per cent of the coefficient."""
        mu = abs(self.of.result.mu)
        return 100.0 * self.term.standard / mu if mu else NAN

    def share(self, budget: Budget) -> float:
        """Return its share of a budget's variance, per cent; 0 for a term outside it."""
        return 100.0 * budget.share(self.term) if self.term in budget.contributions else 0.0


def budget_table(results: RunResults) -> Table[TermRow]:
    """Return a row for each term of each condition's budgets, including those of the mean over replicates."""
    conditions = conditions_table(results)
    which = tuple(_of_condition(conditions[key]) for key in _WHICH)
    axes: Iterator[Column[TermRow]] = (axis_column(axis, lambda row: row.of.info) for axis in results.axes)
    rows = (TermRow(row, term) for row in conditions.rows for term in terms_of(row.result))
    return Table((*which, *axes, *_columns(results.worn)), tuple(rows))


def terms_table(condition_row: ConditionRow, worn: str) -> Table[TermRow]:
    """Return a row for each term of a condition's budgets, the largest first; ``worn``: the kind's word for a piece."""
    return Table(_columns(worn), tuple(TermRow(condition_row, term) for term in terms_of(condition_row.result)))


def terms_of(r: ConditionResult) -> list[Contribution]:
    """Return the terms of both budgets of a result, each once, the largest first."""
    terms = dict.fromkeys((*r.budget.contributions, *r.compound_budget.contributions))
    return sorted(terms, key=lambda term: -term.standard)


def budgeted_rows(conditions: Table[ConditionRow]) -> list[ConditionRow]:
    """Return the recipe's rows that have a budget."""
    return [row for row in recipe_rows(conditions).rows if isfinite(row.result.budget.standard)]


def sums(conditions: Table[ConditionRow], condition_row: ConditionRow) -> tuple[str, str, str]:
    """Return the sums of a condition's budgets in words: the coefficient, then both expanded uncertainties."""
    first, this, compound = (_in_words([conditions[key] for key in keys], condition_row) for keys in _SUMS)
    return first, this, compound


def _in_words(columns: Sequence[Column[ConditionRow]], condition_row: ConditionRow) -> str:
    """Return headings with values; a heading that two neighbours share appears once."""
    before = ("", *(column.heading for column in columns))
    return ", ".join(
        f"{'' if column.heading == other else column.heading} {column.text(condition_row)} {column.unit}".strip()
        for column, other in zip(columns, before, strict=False)
    )


_SUMS: Final = (
    ("mu", "mu_as_measured"),
    ("u_expanded", "u_expanded_percent", "coverage_factor"),
    ("u_expanded_compound", "u_expanded_compound_percent", "coverage_factor_compound"),
)
_WHICH: Final = ("level", "condition", "specimen", "replicate", "grid", "compound", "note")
_BOTH: Final = frozenset({Output.SHOW, Output.REPORT})


def _of_condition(column: Column[ConditionRow]) -> Column[TermRow]:
    return Column(column.key, column.heading, lambda row: column.value(row.of))


def _columns(worn: str) -> tuple[Column[TermRow], ...]:
    """Return the columns of a term.

    ``standard_uncertainty`` is the input's, in ``unit``, ``sensitivity`` the change of the coefficient per unit,
    ``u_mu`` their product. Shares are of the variance of each measurand. Degrees of freedom are empty for a limit taken
    as known.
    """
    return (
        Column("term", "term", lambda row: row.term.name, views=_BOTH),
        Column("distribution", "distribution", lambda row: row.term.distribution),
        Column("standard_uncertainty", "u", lambda row: row.term.input_u, digits=2, views=_BOTH - {Output.SHOW}),
        Column("unit", "unit", lambda row: row.term.unit, views=_BOTH - {Output.SHOW}),
        Column("degrees_of_freedom", "df", lambda row: row.term.df, "", 0, _BOTH),
        Column("sensitivity", "c", lambda row: row.term.sensitivity, digits=2, views=_BOTH - {Output.SHOW}),
        Column("u_mu", "u(mu)", lambda row: row.term.standard),
        Column("percent", "u(mu)", lambda row: row.percent, "%", 2, _BOTH, stored=False),
        Column(f"share_this_{worn}", f"share this {worn}", lambda row: 0.01 * row.share(row.of.result.budget)),
        Column("share_compound", "share compound", lambda row: 0.01 * row.share(row.of.result.compound_budget)),
        Column("percent_this", f"this {worn}", lambda row: row.share(row.of.result.budget), "%", 0, _BOTH,
               stored=False),
        Column("percent_compound", "compound", lambda row: row.share(row.of.result.compound_budget), "%", 0, _BOTH,
               stored=False),
        Column("source", "source", lambda row: row.term.source, views=_BOTH - {Output.REPORT}),
    )  # fmt: skip
