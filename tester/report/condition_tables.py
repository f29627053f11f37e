"""Sections on the measurements: conditions, drift and repeats, exclusions with the reason, budgets of the uncertainty.

A term's source and distribution are the same in most conditions, so a table of numbered terms lists them once; the
budgets refer to them by number.
"""

from __future__ import annotations

from collections.abc import Sequence

from tester.analysis.results import NOT_TRUSTED, WITH_CARE, mark_of
from tester.analysis.uncertainty import Contribution
from tester.base.axes import condition_words
from tester.base.words import NONE, decimal
from tester.report.layout import (
    Columns,
    Listing,
    Paragraph,
    Part,
    ReportRow,
    ReportSection,
    ReportTable,
    Tone,
    heads,
    listed,
    rendered,
)
from tester.report.record_section import RunRecord
from tester.results.budget_table import TermRow, budgeted_rows, sums, terms_of, terms_table
from tester.results.columns import Column, Output, Table
from tester.results.conditions_table import ConditionRow, axis_keys, conditions_table, recipe_rows
from tester.results.run_results import RunResults
from tester.results.table_rows import remedy
from tester.results.tally import flag_lines, tally_of

SHORT_ROWS = 20
"""Longest table of conditions on the first page; longer ones are summarised by compound."""
_TONES: dict[str, Tone] = {NOT_TRUSTED: "bad", WITH_CARE: "care"}


def tone_of(condition_row: ConditionRow) -> Tone:
    """Return the tone of a condition's row: without a value, with a doubt, or plain."""
    return _TONES.get(mark_of(condition_row.result.status, condition_row.result.flags), "")


def conditions_section(record: RunRecord, key: str) -> ReportSection:
    """Return the table of conditions with both uncertainties, and below it the wear of checked pieces."""
    results = record.results
    conditions = recipe_rows(conditions_table(results))
    axes = results.axes.columns(row.info.setpoint for row in conditions.rows)
    shown = conditions.view(Output.REPORT, axis_keys(axes))
    parts: list[Part] = [
        Paragraph(
            f"Each coefficient mu comes with two expanded uncertainties U (95 %): that of this {results.worn} in this "
            f"condition, and that of the compound, which any other {results.worn} of it comes with. mu is at the "
            "temperature that was asked for, as both uncertainties are; beside it is the coefficient as measured, at "
            f"the mean temperature that was measured. {WITH_CARE} marks a value to be taken with care, "
            f"{NOT_TRUSTED} a number that is not to be trusted."
        ),
        rendered(shown, f"Conditions of {record.name}", COUNTS_NOTE, tone=tone_of, cards=True),
    ]
    advised = [row.advise() for row in results.rows if not row.result.ok or row.result.doubts]
    parts += [Listing(advised, "care")] if advised else []
    parts += listed("Flags:", flag_lines(results))
    again = [line for setting in results.settings for line in setting.lines(results.worn)]
    tone = "care" if any(setting.disagrees for setting in results.settings) else ""
    parts += listed("Settings that were measured several times:", again, tone)
    parts += listed("Diameters that were checked, with the wear rate:", results.wear_lines())
    return ReportSection(key, "Conditions", parts)


COUNTS_NOTE = "valid: in the mean, of those asked for; s: standard deviation between them"


def short_table(results: RunResults) -> ReportTable:
    """Return the main table in short, for a first page: every condition, or every compound where conditions are
    many."""
    conditions = recipe_rows(conditions_table(results))
    if len(conditions.rows) <= SHORT_ROWS:
        axes = results.axes.differing(row.info.setpoint for row in conditions.rows)
        return rendered(conditions.view(Output.COVER, axis_keys(axes)), "What was found", tone=tone_of, cards=True)
    return _by_compound(conditions)


def _by_compound(conditions: Table[ConditionRow]) -> ReportTable:
    mu, this, whole = (conditions[key] for key in ("mu", "u_expanded_percent", "u_expanded_compound_percent"))
    rows: list[ReportRow] = []
    for compound in dict.fromkeys(row.info.compound for row in conditions.rows):
        of_compound = [row for row in conditions.rows if row.info.compound == compound]
        valued = sorted((row for row in of_compound if row.result.ok), key=lambda row_: row_.result.mu)
        cells = [compound, f"{len(valued)} of {len(of_compound)}"]
        for row_ in (valued[0], valued[-1]) if valued else ():
            cells.append(f"{mu.text(row_)} at {condition_words(row_.info.setpoint, compound=False)}")
        cells += [_median(column, valued) for column in (this, whole) if valued]
        cells += [NONE] * (6 - len(cells))
        cells.append(str(sum(bool(row.result.doubts) for row in valued)))
        rows.append(ReportRow(cells))
    titles = heads(
        "compound", "conditions with a value", "lowest mu", "highest mu", f"typical {this.head}",
        f"typical {whole.head}", "with a doubt", text=(0, 2, 3),
    )  # fmt: skip
    note = "typical: the median over the conditions; the table of conditions lists every condition"
    return ReportTable("What was found, by compound", titles, rows, note, cards=True)


def _median(column: Column[ConditionRow], valued: Sequence[ConditionRow]) -> str:
    """Return the middle value of a column."""
    middle = sorted(valued, key=lambda row: float(str(column.value(row))))
    return column.text(middle[len(middle) // 2])


def drift_section(record: RunRecord, key: str) -> ReportSection:
    """Return the drift of each condition's repeats, the repeats left out, and the make-ups."""
    parts: list[Part] = [
        Paragraph(
            "Drift is the change of the coefficient over a window, with its bound; the trend is the change from the "
            "first repeat to the last. A make-up is a repeat, or a pair of repeats where both directions are measured, "
            "in place of one that was refused."
        ),
        _drift_table(record),
    ]
    out = record.left_out()
    if out:
        rows = [
            ReportRow((f"{repeat.condition}/{repeat.repeat}", condition_words(condition.info.setpoint),
                       decimal(repeat.result.mu_resultant, 3), reason))
            for condition, repeat, reason in out
        ]  # fmt: skip
        titles = heads("repeat", "condition", "mu as measured", "why it is in no mean", text=(0, 1, 3))
        parts.append(ReportTable("Repeats that are left out", titles, rows))
    else:
        parts.append(Paragraph("No repeat is left out: every one that was made is in its mean.", "good"))
    lines = (
        f"{word.condition}/{word.repeat} {'left out' if word.excluded else 'taken in again'} by "
        f"{word.operator or 'an unnamed person'}, {word.utc}: {word.reason}"
        for word in record.exclusions
    )
    parts += listed("Decisions of people on single repeats:", lines)
    return ReportSection(key, "Drift, repeats, exclusions", parts)


def _drift_table(record: RunRecord) -> ReportTable:
    table = conditions_table(record.results)
    shown = table.of(row for row in table.rows if row.measured is not None).view(Output.REPEATS)
    condition = Column[ConditionRow]("words", "condition", lambda row: condition_words(row.info.setpoint))
    void = Column[ConditionRow](
        "interrupted", "interrupted", lambda row: len(record.void.get(row.info.condition, ())), "", 0
    )
    number, *columns, flags = shown.columns
    return rendered(
        Table((number, condition, *columns, void, flags), shown.rows), "Drift and repeats of each condition",
        "made = valid + left out; make-ups are among those made; interrupted attempts are in no count", tone=tone_of,
    )  # fmt: skip


def verdict(results: RunResults) -> list[Part]:
    """Return in words how many conditions have a value, their flags, and the remedies."""
    tally = tally_of(results)
    tone: Tone = "bad" if tally.missing else "care" if tally.doubted else "good"
    reasons = sorted({text for row in results.rows if (text := remedy(row.result))})
    helps = [Listing([f"What helps: {text}." for text in reasons])] if reasons else []
    return [Paragraph(tally.sentence, tone), *helps]


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
