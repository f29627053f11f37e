"""Several runs compared: their coefficients over each axis, and whether their compounds differ."""

from __future__ import annotations

from collections.abc import Sequence

from tester.base.words import counted
from tester.report.charts import ChartValue, overlay_charts, values_of
from tester.report.layout import (
    Chapter,
    Paragraph,
    Part,
    Picture,
    ReportSection,
    rendered,
)
from tester.report.overview import overview_chart
from tester.report.page import inline_svg
from tester.report.record_section import RunRecord
from tester.report.ring_section import ring_trend_sections
from tester.results.columns import Output
from tester.results.compared import comparison, same_rig
from tester.results.conditions_table import axis_keys


def runs_chapter(records: Sequence[RunRecord]) -> Chapter:
    """Return the chapter on several runs together; runs of another kind than the first are not compared."""
    first = records[0]
    alike = [record for record in records[1:] if record.results.axes == first.results.axes]
    sections = [ReportSection("all-figures", "Runs in one picture", _pictures([first, *alike]))] if alike else []
    sections += [_compared(first, record, f"all-compared-{i}") for i, record in enumerate(alike, start=2)]
    sections += ring_trend_sections(records, "all-ring")
    strange = [record.name for record in records[1:] if record not in alike]
    if strange:
        sentence = f"Of another kind of rig than {first.name}, and not compared: {', '.join(strange)}."
        sections.append(ReportSection("all-strange", "Not compared", [Paragraph(sentence, "care")]))
    return Chapter("all", "Runs compared", sections)


def _pictures(records: Sequence[RunRecord]) -> list[Part]:
    values: list[ChartValue] = []
    for record_ in records:
        values += values_of(record_.results, record_.name)
    drawn = overview_chart([(record.name, record.results) for record in records])
    parts: list[Part] = [
        Picture(inline_svg(chart, f"all-{chart.name}"), wide=True) for chart in overlay_charts(values)
    ]
    if not parts:
        parts.append(Paragraph("No two runs have values over one axis with all else alike."))
    if drawn is not None:
        parts.append(Picture(inline_svg(drawn, "all-overview"), wide=True))
    return parts


def _compared(first: RunRecord, other: RunRecord, key: str) -> ReportSection:
    compared = comparison(first.results, other.results)
    both = [row for row in compared.rows if row.first is not None and row.second is not None]
    differing = sum(row.found.told_apart for row in both)
    shared = (
        "The runs have one rig and one calibration: errors in common drop out of the difference."
        if same_rig(first.results.run, other.results.run)
        else "The runs have different rigs or calibrations: nothing drops out of the difference."
    )
    summary = (
        f"{counted(len(both), 'condition')} in both runs; in {differing} the compounds differ by more than chance "
        f"explains (95 %). {shared} Coefficients are at the temperatures asked for; u is the standard uncertainty of "
        "the difference of the compounds, z the difference over u, k what chance explains."
    )
    axes = first.results.axes.columns(row.either.info.setpoint for row in compared.rows)
    note = f"1: {first.name}, 2: {other.name}"
    shown = compared.view(Output.COMPARE, axis_keys(axes))
    table = rendered(shown, f"{first.name} and {other.name}", note)
    return ReportSection(key, f"{first.name} and {other.name}", [Paragraph(summary), table])
