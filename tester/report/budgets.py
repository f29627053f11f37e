"""The budget of every condition: what its uncertainty is made of, in full and yet on few pages.

A term's source and distribution are the same in most conditions, so they stand once, in a table of numbered terms; the
budgets refer to them by number.
"""

from __future__ import annotations

from math import isfinite

from tester.analysis.repeats import ConditionResult
from tester.analysis.uncertainty import Contribution
from tester.axes import condition_words
from tester.report.layout import Columns, Paragraph, Part, ReportRow, ReportSection, ReportTable, heads
from tester.report.record import RunRecord
from tester.report.words import NONE, number, percent, relative, short
from tester.results.budget import share_of, terms_of
from tester.results.run_results import RunResults, TableRow

_Told = tuple[str, str, str, str]
"""What is told of a term once: name, source, distribution, what else has the same error."""
_COMMON = {"rig": "all conditions of the rig", "piece": "all on what is mounted", "": "each by itself"}


def budget_section(record: RunRecord, key: str) -> ReportSection:
    """Return the terms, then each condition's budget, the largest term first."""
    results = record.results
    valued = [row for row in results.rows if isfinite(row.result.budget.standard)]
    if not valued:
        return ReportSection(key, "Uncertainty budgets", [Paragraph("No condition has a budget.", "care")])
    numbers = _numbered(results)
    legend = [
        ReportRow((str(number), *told[:3], _COMMON.get(told[3], told[3])), key=f"{key}-{number}")
        for told, number in numbers.items()
    ]
    titles = heads("no.", "term", "source", "distribution", "the same in", text=(0, 1, 2, 3, 4))
    parts: list[Part] = [
        Paragraph(
            "u is the standard uncertainty of what may be off, c the change of the coefficient with it (its "
            "sensitivity), u(μ) their product in per cent of the coefficient, df its degrees of freedom (– where a "
            "limit is taken as known). Shares are of the variance of the coefficient: of "
            f"this {results.worn} in this condition, and of the compound. [A] marks an engineering assumption."
        ),
        ReportTable("Terms", titles, legend),
    ]
    parts.append(Columns([_budget(row, numbers, results) for row in valued]))
    return ReportSection(key, "Uncertainty budgets", parts)


def _numbered(results: RunResults) -> dict[_Told, int]:
    found: dict[_Told, int] = {}
    for row in results.rows:
        for one in terms_of(row.result):
            found.setdefault(_told(one), len(found) + 1)
    return found


def _told(one: Contribution) -> _Told:
    return one.name, one.source, one.distribution, one.common


def _budget(row: TableRow, numbers: dict[_Told, int], results: RunResults) -> ReportTable:
    r = row.result
    mu = r.mu_resultant
    terms = sorted(terms_of(r), key=lambda one: -one.standard)
    rows = [ReportRow(_cells(one, r, numbers[_told(one)])) for one in terms]
    caption = f"{condition_words(row.info.setpoint)}: μ {number(mu, 4)}, corrected {number(r.mu_corrected, 4)}"
    note = "; ".join(
        f"{name}: U {number(one.expanded, 4)} ({percent(relative(one.expanded, mu))}), k {number(one.coverage, 2)}, "
        f"df {short(one.df) if isfinite(one.df) else NONE}"
        for name, one in ((f"this {results.worn}", r.budget), ("compound", r.compound_budget))
    )
    titles = heads("no.", "term", "u", "df", "c", "u(μ)", "this", "compound", text=(0, 1))
    return ReportTable(caption, titles, rows, note)


def _cells(one: Contribution, r: ConditionResult, number_of: int) -> tuple[str, ...]:
    unit = f"\u00a0{one.unit}" if one.unit not in ("", "1") else ""
    return (
        str(number_of),
        one.name,
        f"{short(one.input_u, 2)}{unit}",
        short(one.df) if isfinite(one.df) else NONE,
        short(one.sensitivity, 2),
        percent(relative(one.standard, r.mu_resultant), 2),
        percent(share_of(one, r.budget), 0),
        percent(share_of(one, r.compound_budget), 0),
    )
