"""Builds a report from the record of one run or several: the first page, then a chapter for each run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite

from tester import __version__
from tester.base.words import counted
from tester.report.charts import Material, charts_of, repeats_chart
from tester.report.condition_tables import budget_section, conditions_section, drift_section, short_table, verdict
from tester.report.layout import Chapter, FactSheet, Paragraph, Part, Picture, Report, ReportSection, day
from tester.report.materials_section import materials_sections
from tester.report.overview import overview_chart
from tester.report.page import inline_svg
from tester.report.record_section import RunRecord
from tester.report.ring_section import ring_sections
from tester.report.run_sections import (
    assumption_section,
    calibration_section,
    control_section,
    provenance_section,
    ran_section,
    tare_section,
    trips_section,
)
from tester.report.several_runs import runs_chapter
from tester.results.table_rows import Measured

Showing = Callable[[RunRecord], Material]
"""Returns the content of a run's figures: its values, and published ones and a law beside them."""
REPEATS_AT_MOST = 6
"""Most conditions with a figure of their repeats: the first with a doubt or a repeat left out."""


def report_of(records: Sequence[RunRecord], showing: Showing) -> Report:
    """Return the report of at least one run; raises MissingExtraError."""
    first = records[0]
    names = list(dict.fromkeys(record.results.run.info.recipe_name for record in records))
    measurand = first.machine.measurand or "the friction coefficient"
    chapters = [runs_chapter(records)] if len(records) > 1 else []
    chapters += [_chapter(record, f"r{i}", showing) for i, record in enumerate(records, start=1)]
    cover: list[Part] = []
    for record in records:
        cover += _cover(record, several=len(records) > 1)
    return Report(
        title=", ".join(names),
        lead=f"Measured was {measurand}.",
        cover=cover,
        chapters=chapters,
        made=f"Made by friction-tester {__version__} from the records of {', '.join(r.name for r in records)}.",
    )


def _cover(record: RunRecord, *, several: bool) -> list[Part]:
    results = record.results
    run, info = results.run, results.run.info
    compounds = list(dict.fromkeys(row.info.compound for row in results.rows))
    simulated = (
        Paragraph(
            "Simulated: no rubber and no machine were involved. The values come from a computer model of the rig "
            f"(seed {info.seed}); they show what the method does, not what a compound does.",
            "care",
        )
        if info.simulated
        else Paragraph("Measured on a machine.")
    )
    facts = [
        *([("run", record.name)] if several else []),
        ("compounds" if len(compounds) > 1 else "compound", ", ".join(compounds) or "none"),
        ("conditions", str(len(results.rows))),
        ("rig", record.machine.title or info.kind),
        ("date", day(info.started_utc)),
        ("operator", info.operator or "not named"),
        ("status", f"{results.status.value}{f': {run.reason}' if run.reason else ''}"),
        ("record", f"head {record.verification.head[:16]}…" if record.verification.head else "without a chain"),
    ]
    problems = record.verification.problems
    checked = (
        Paragraph(f"The record is not as it was left: {counted(len(problems), 'finding')}, see below.", "bad")
        if problems
        else Paragraph("The record was verified: it is as it was left.", "good")
    )
    risk: list[Part] = [Paragraph(f"Risk accepted: {info.risk}", "bad")] if info.risk else []
    if record.trips:
        risk.append(Paragraph(f"{counted(len(record.trips), 'trip')} during the run, see Alarms and trips.", "care"))
    meaning = (
        f"± U is the expanded uncertainty: 95 of 100 such intervals hold the value. That of “this {results.worn}” is "
        f"for the {results.worn} that was mounted; that of the compound is for any {results.worn} of it."
    )
    table = short_table(results)
    return [FactSheet(facts), simulated, *risk, *verdict(results), checked, table, Paragraph(meaning, "small")]


def _chapter(record: RunRecord, key: str, showing: Showing) -> Chapter:
    sections = [
        conditions_section(record, f"{key}-conditions"),
        _figures(record, f"{key}-figures", showing),
    ]
    appendix = [
        ran_section(record, f"{key}-ran"),
        *materials_sections(record, f"{key}-materials"),
        budget_section(record, f"{key}-budgets"),
        drift_section(record, f"{key}-drift"),
        tare_section(record, f"{key}-tares"),
        calibration_section(record, f"{key}-calibration"),
        trips_section(record, f"{key}-trips"),
        control_section(record, f"{key}-control"),
        *ring_sections(record, f"{key}-ring"),
        assumption_section(record, f"{key}-assumptions"),
        provenance_section(record, f"{key}-provenance"),
    ]
    return Chapter(key, f"Run {record.name}", sections, appendix)


def _figures(record: RunRecord, key: str, showing: Showing) -> ReportSection:
    figures = [*charts_of(showing(record))]
    parts: list[Part] = [
        Picture(inline_svg(figure, f"{key}-{i}"), wide=len(figure.panels) > 1)
        for i, figure in enumerate(figures, start=1)
    ]
    drawn = overview_chart([(record.name, record.results)])
    if drawn is not None:
        parts.append(Picture(inline_svg(drawn, f"{key}-overview"), wide=True))
    doubted = [condition for condition in record.results.conditions() if _worth_drawing(condition)]
    for condition in doubted[:REPEATS_AT_MOST]:
        chart = repeats_chart(condition)
        parts.append(Picture(inline_svg(chart, f"{key}-{chart.name}")))
    if len(doubted) > REPEATS_AT_MOST:
        left = counted(len(doubted) - REPEATS_AT_MOST, "more condition")
        remainder = f"{left} with a doubt or a repeat left out: tester figure {record.name} draws each."
        parts.append(Paragraph(remainder, "small"))
    if not parts:
        parts.append(Paragraph("No condition has a value, and there is nothing to draw.", "care"))
    return ReportSection(key, "Figures", parts)


def _worth_drawing(measured: Measured) -> bool:
    left_out = any(measured.exclusion(repeat) for repeat in measured.repeats)
    drawable = any(isfinite(repeat.result.mu_resultant) for repeat in measured.repeats)
    return drawable and bool(measured.result.doubts or left_out)
