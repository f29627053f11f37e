"""The budget of every condition: the parts of its uncertainty, in full but on few pages.

A term's source and distribution are the same in most conditions, so a table of numbered terms lists them once; the
budgets refer to them by number.
"""

from __future__ import annotations

from collections.abc import Sequence

from tester.analysis.uncertainty import Contribution
from tester.base.axes import condition_words
from tester.report.layout import Columns, Paragraph, Part, ReportRow, ReportSection, ReportTable, heads, rendered
from tester.report.record_section import RunRecord
from tester.results.budget_table import TermRow, budgeted_rows, sums, terms_of, terms_table
from tester.results.columns import Column, Output, Table
from tester.results.conditions_table import ConditionRow, conditions_table

_Details = tuple[str, str, str, str]
"""Details of a term listed once: name, source, distribution, scope of a common error."""
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
        ReportRow((str(number), *details[:3], _COMMON.get(details[3], details[3])), key=f"{key}-{number}")
        for details, number in numbers.items()
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
    parts.append(Columns([_budget(row, conditions, numbers, results.worn) for row in budgeted]))
    return ReportSection(key, "Uncertainty budgets", parts)


def _numbered(budgeted: Sequence[ConditionRow]) -> dict[_Details, int]:
    numbers: dict[_Details, int] = {}
    for row in budgeted:
        for term in terms_of(row.result):
            numbers.setdefault(_details(term), len(numbers) + 1)
    return numbers


def _details(contribution: Contribution) -> _Details:
    return contribution.name, contribution.source, contribution.distribution, contribution.common


def _budget(
    condition_row: ConditionRow, conditions: Table[ConditionRow], numbers: dict[_Details, int], worn: str
) -> ReportTable:
    number = Column[TermRow]("number", "no.", lambda row: str(numbers[_details(row.term)]))
    terms = terms_table(condition_row, worn).view(Output.REPORT)
    first, *others = sums(conditions, condition_row)
    caption = f"{condition_words(condition_row.info.setpoint)}: {first}"
    return rendered(Table((number, *terms.columns), terms.rows), caption, "; ".join(others))
