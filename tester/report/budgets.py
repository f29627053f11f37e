"""The budget of every condition: what its uncertainty is made of, in full and yet on few pages.

A term's source and distribution are the same in most conditions, so they stand once, in a table of numbered terms; the
budgets refer to them by number.
"""

from __future__ import annotations

from collections.abc import Sequence

from tester.analysis.uncertainty import Contribution
from tester.base.axes import condition_words
from tester.report.layout import Columns, Paragraph, Part, ReportRow, ReportSection, ReportTable, heads, rendered
from tester.report.record import RunRecord
from tester.results.budget import TermRow, budgeted_rows, sums, terms_of, terms_table
from tester.results.columns import Column, Output, Table
from tester.results.conditions_table import ConditionRow, conditions_table

_Told = tuple[str, str, str, str]
"""What is told of a term once: name, source, distribution, what else has the same error."""
_COMMON = {"rig": "all conditions of the rig", "piece": "all on what is mounted", "": "each by itself"}


def budget_section(record: RunRecord, key: str) -> ReportSection:
    """Return the terms, then each condition's budget, the largest term first."""
    results = record.results
    conditions = conditions_table(results)
    budgeted = budgeted_rows(conditions)
    if not budgeted:
        return ReportSection(key, "Uncertainty budgets", [Paragraph("No condition has a budget.", "care")])
    numbers = _numbered(budgeted)
    legend = [
        ReportRow((str(number), *told[:3], _COMMON.get(told[3], told[3])), key=f"{key}-{number}")
        for told, number in numbers.items()
    ]
    titles = heads("no.", "term", "source", "distribution", "the same in", text=(0, 1, 2, 3, 4))
    parts: list[Part] = [
        Paragraph(
            "u is the standard uncertainty of what may be off, c the change of the coefficient with it (its "
            "sensitivity), u(mu) their product in per cent of the coefficient, df its degrees of freedom (none where a "
            "limit is taken as known). Shares are of the variance of the coefficient: of "
            f"this {results.worn} in this condition, and of the compound. [A] marks an engineering assumption."
        ),
        ReportTable("Terms", titles, legend),
    ]
    parts.append(Columns([_budget(one, conditions, numbers, results.worn) for one in budgeted]))
    return ReportSection(key, "Uncertainty budgets", parts)


def _numbered(budgeted: Sequence[ConditionRow]) -> dict[_Told, int]:
    found: dict[_Told, int] = {}
    for row in budgeted:
        for one in terms_of(row.result):
            found.setdefault(_told(one), len(found) + 1)
    return found


def _told(one: Contribution) -> _Told:
    return one.name, one.source, one.distribution, one.common


def _budget(one: ConditionRow, conditions: Table[ConditionRow], numbers: dict[_Told, int], worn: str) -> ReportTable:
    number = Column[TermRow]("number", "no.", lambda row: str(numbers[_told(row.term)]))
    terms = terms_table(one, worn).view(Output.REPORT)
    first, *others = sums(conditions, one)
    caption = f"{condition_words(one.info.setpoint)}: {first}"
    return rendered(Table((number, *terms.columns), terms.rows), caption, "; ".join(others))
