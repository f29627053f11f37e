"""Sections of what was measured: the table of conditions, drift and repeats, and what is left out with the reason."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

from tester.analysis.trust import NOT_TRUSTED, WITH_CARE, mark_of
from tester.axes import Axis, condition_words, plain
from tester.report.layout import (
    Listing,
    Paragraph,
    Part,
    ReportHead,
    ReportRow,
    ReportSection,
    ReportTable,
    Tone,
    heads,
)
from tester.report.overview import made_up_of
from tester.report.record import RunRecord
from tester.report.words import NONE, counted, labelled, number, percent, relative, short
from tester.results.run_results import RunResults, TableRow, remedy

SHORT_ROWS = 20
"""A table of more conditions than these is told by its compounds on the first page."""


def tone_of(row: TableRow) -> Tone:
    """Return how a condition's row is set: without a value, to be taken with care, or plainly."""
    mark = mark_of(row.result.status, row.result.flags)
    return "bad" if mark == NOT_TRUSTED else "care" if mark == WITH_CARE else ""


def conditions_section(record: RunRecord, key: str) -> ReportSection:
    """Return the table of conditions with both uncertainties, and below it the wear of what was checked."""
    results = record.results
    parts: list[Part] = [
        Paragraph(
            f"Each coefficient comes with two expanded uncertainties (95 %): that of this {results.worn} in this "
            f"condition, and that of the compound, which any other {results.worn} of it comes with. “Corrected” is the "
            "coefficient at the temperature that was asked for; both uncertainties are its. "
            f"{WITH_CARE} stands behind a value to be taken with care, {NOT_TRUSTED} where there is none to be trusted."
        ),
        conditions_table(results, f"Conditions of {record.name}"),
    ]
    advised = [*_advice(results)]
    parts += [Listing(advised, "care")] if advised else []
    worn = [*results.wear_lines()]
    parts += [Paragraph("Diameters that were checked, with the wear rate:"), Listing(worn)] if worn else []
    return ReportSection(key, "Conditions", parts)


def conditions_table(results: RunResults, caption: str) -> ReportTable:
    """Return the table of all conditions of a run."""
    axes = results.axes.columns(row.info.setpoint for row in results.rows)
    titles = (
        *axis_heads(axes),
        *heads(
            "μ raw",
            "μ corrected",
            f"U this {results.worn}",
            "U compound",
            "U compound (%)",
            "s (%)",
            "repeats",
            "flags",
            text=(7,),
        ),
    )
    rows = [ReportRow(_cells(row, axes), tone_of(row)) for row in results.rows]
    return ReportTable(caption, titles, rows, "repeats: in the mean, of those asked for; s: between them, of μ")


def axis_heads(axes: Sequence[Axis]) -> tuple[ReportHead, ...]:
    """Return the heads of the columns that say which condition a row is of."""
    return (ReportHead("compound", number=False), *(ReportHead(labelled(axis)) for axis in axes))


def axis_cells(row: TableRow, axes: Sequence[Axis]) -> tuple[str, ...]:
    """Return their cells."""
    held = row.info.setpoint
    return (held.compound, *(plain(axis.of(held)) for axis in axes))


def _cells(row: TableRow, axes: Sequence[Axis]) -> tuple[str, ...]:
    r = row.result
    mu, u = r.mu_resultant, r.compound_budget.expanded
    told = ", ".join(part for part in ("" if r.ok else r.status.value, r.flags) if part)
    return (
        *axis_cells(row, axes),
        f"{number(mu)}{mark_of(r.status, r.flags) if isfinite(mu) else ''}",
        number(r.mu_corrected),
        number(r.expanded),
        number(u),
        percent(relative(u, mu)),
        percent(relative(r.s, mu)) if r.n_valid > 1 else NONE,
        f"{r.n_valid} of {r.n}",
        told or NONE,
    )


def _advice(results: RunResults) -> Iterator[str]:
    for row in results.rows:
        if not row.result.ok or row.result.doubts:
            yield row.advise()


def short_table(results: RunResults) -> ReportTable:
    """Return the main table in short, for a first page: every condition, or where they are many every compound."""
    if len(results.rows) <= SHORT_ROWS:
        axes = results.axes.differing(row.info.setpoint for row in results.rows)
        titles = (
            *axis_heads(axes),
            *heads("μ", f"± U this {results.worn}", "± U compound", "flags", text=(3,)),
        )
        rows = [ReportRow(_short_cells(row, axes), tone_of(row)) for row in results.rows]
        return ReportTable("What was found", titles, rows)
    return _by_compound(results)


def _short_cells(row: TableRow, axes: Sequence[Axis]) -> tuple[str, ...]:
    r = row.result
    told = ", ".join([*([] if r.ok else [r.status.value]), *r.doubts])
    mu = f"{number(r.mu_corrected if isfinite(r.mu_corrected) else r.mu_resultant)}{mark_of(r.status, r.flags)}"
    mu = mu if isfinite(r.mu_resultant) else NONE
    return (*axis_cells(row, axes), mu, number(r.expanded), number(r.compound_budget.expanded), told or NONE)


def _by_compound(results: RunResults) -> ReportTable:
    rows: list[ReportRow] = []
    for compound in dict.fromkeys(row.info.compound for row in results.rows):
        own = [row for row in results.rows if row.info.compound == compound]
        valued = sorted((row for row in own if row.result.ok), key=lambda row: row.result.mu_resultant)
        cells = [compound, f"{len(valued)} of {len(own)}"]
        for one in (valued[0], valued[-1]) if valued else ():
            cells.append(f"{one.result.mu_resultant:.3f} at {condition_words(one.info.setpoint, compound=False)}")
        for which in ("budget", "compound_budget") if valued else ():
            shares = sorted(relative(getattr(one.result, which).expanded, one.result.mu_resultant) for one in valued)
            cells.append(percent(shares[len(shares) // 2]))
        cells += [NONE] * (6 - len(cells))
        cells.append(str(sum(bool(row.result.doubts) for row in valued)))
        rows.append(ReportRow(cells))
    titles = heads(
        "compound", "conditions with a value", "lowest μ", "highest μ", f"typical U this {results.worn}",
        "typical U compound", "with care", text=(0, 2, 3),
    )  # fmt: skip
    note = "typical: the median over the conditions, of μ; every condition stands in the table of conditions"
    return ReportTable("What was found, by compound", titles, rows, note, cards=True)


def drift_section(record: RunRecord, key: str) -> ReportSection:
    """Return what each condition's repeats say of its drift, which of them are left out, which were made up."""
    parts: list[Part] = [
        Paragraph(
            "Drift is the change of the coefficient over a window, with its bound; the trend is the change from the "
            "first repeat to the last. A make-up is a repeat in place of one that was refused."
        ),
        _drift_table(record),
    ]
    out = record.left_out()
    if out:
        rows = [
            ReportRow(
                (
                    f"{repeat.condition}/{repeat.repeat}",
                    condition_words(one.info.setpoint),
                    number(repeat.result.mu_resultant),
                    reason,
                )
            )
            for one, repeat, reason in out
        ]
        titles = heads("repeat", "condition", "μ", "why it is in no mean", text=(0, 1, 3))
        parts.append(ReportTable("Repeats that are left out", titles, rows))
    else:
        parts.append(Paragraph("No repeat is left out: every one that was made is in its mean.", "good"))
    if record.said:
        lines = [
            f"{one.condition}/{one.repeat} {'left out' if one.excluded else 'taken in again'} by "
            f"{one.operator or 'somebody unnamed'}, {one.utc}: {one.reason}"
            for one in record.said
        ]
        parts += [Paragraph("What people have said of single repeats:"), Listing(lines)]
    return ReportSection(key, "Drift, repeats, exclusions", parts)


def _drift_table(record: RunRecord) -> ReportTable:
    rows: list[ReportRow] = []
    for row in record.results.rows:
        for one in row.replicates:
            r, void = one.result, len(record.void.get(one.info.condition, ()))
            out = sum(bool(one.exclusion(repeat)) for repeat in one.repeats)
            cells = (
                str(one.info.condition),
                condition_words(one.info.setpoint),
                short(r.drift_percent, 2),
                short(r.drift_bound_percent, 2),
                short(r.trend_percent, 2),
                str(len(one.repeats)),
                str(out),
                str(len(made_up_of(one))),
                str(void),
                ", ".join(r.doubts) or NONE,
            )
            rows.append(ReportRow(cells, tone_of(row) if len(row.replicates) == 1 else ""))
    titles = heads(
        "no.", "condition", "drift (%)", "bound (%)", "trend (%)", "made", "left out", "make-ups", "interrupted",
        "doubts", text=(0, 1, 9),
    )  # fmt: skip
    return ReportTable("Drift and repeats of each condition", titles, rows)


def verdict(results: RunResults) -> list[Part]:
    """Return in words how many conditions have a value, and what is to be said of the others."""
    total, missing, doubtful = len(results.rows), len(results.missing()), results.doubtful()
    parts: list[Part] = []
    if not missing:
        values = f"All {total} conditions have a value." if total != 1 else "The condition has a value."
    else:
        values = f"{total - missing} of {counted(total, 'condition')} have a value; {missing} have none."
    tone: Tone = "bad" if missing else "care" if doubtful else "good"
    care = f" {counted(len(doubtful), 'value')} to be taken with care." if doubtful else " None carries a doubt."
    parts.append(Paragraph(values + (care if total > missing else ""), tone))
    reasons = sorted({text for row in results.rows if (text := remedy(row.result))})
    parts += [Listing([f"What helps: {text}." for text in reasons])] if reasons else []
    return parts
