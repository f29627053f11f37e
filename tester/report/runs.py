"""Several runs held against each other: their coefficients over each axis, and whether their compounds differ."""

from __future__ import annotations

from collections.abc import Sequence

from tester.base.words import counted
from tester.report.charts import ChartValue, overlay_charts, values_of
from tester.report.inline import inline_svg
from tester.report.layout import (
    Chapter,
    Paragraph,
    Part,
    Picture,
    ReportSection,
    rendered,
)
from tester.report.overview import overview_chart
from tester.report.record import RunRecord
from tester.report.ring import ring_trend_sections
from tester.results.columns import Output
from tester.results.compared import comparison, same_rig
from tester.results.conditions_table import axis_keys


def runs_chapter(records: Sequence[RunRecord]) -> Chapter:
    """Return what is told of several runs together; those of another kind than the first are compared with none."""
    first = records[0]
    alike = [one for one in records[1:] if one.results.axes == first.results.axes]
    sections = [ReportSection("all-figures", "Runs in one picture", _pictures([first, *alike]))] if alike else []
    sections += [_compared(first, one, f"all-compared-{i}") for i, one in enumerate(alike, start=2)]
    sections += ring_trend_sections(records, "all-ring")
    strange = [one.name for one in records[1:] if one not in alike]
    if strange:
        told = f"Of another kind of rig than {first.name}, and not compared: {', '.join(strange)}."
        sections.append(ReportSection("all-strange", "Not compared", [Paragraph(told, "care")]))
    return Chapter("all", "Runs held against each other", sections)


def _pictures(records: Sequence[RunRecord]) -> list[Part]:
    values: list[ChartValue] = []
    for one in records:
        values += values_of(one.results, one.name)
    drawn = overview_chart([(one.name, one.results) for one in records])
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
    both = [one for one in compared.rows if one.first is not None and one.second is not None]
    differing = sum(one.found.told_apart for one in both)
    shared = (
        "The runs have one rig and one calibration: errors in common drop out of the difference."
        if same_rig(first.results.run, other.results.run)
        else "The runs have different rigs or calibrations: nothing drops out of the difference."
    )
    told = (
        f"{counted(len(both), 'condition')} in both runs; in {differing} the compounds differ by more than chance "
        f"explains (95 %). {shared} Coefficients are at the temperatures asked for; u is the standard uncertainty of "
        "the difference of the compounds, z the difference over u, k what chance explains."
    )
    axes = first.results.axes.columns(one.either.info.setpoint for one in compared.rows)
    note = f"1: {first.name}, 2: {other.name}"
    shown = compared.view(Output.COMPARE, axis_keys(axes))
    table = rendered(shown, f"{first.name} and {other.name}", note)
    return ReportSection(key, f"{first.name} and {other.name}", [Paragraph(told), table])
