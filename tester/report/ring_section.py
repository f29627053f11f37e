"""The slip ring that carries a device's line to a turning part: errors by angle and speed in a run, trend over runs."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, sqrt

from tester.analysis.ring_errors import RingRun, RingSector, ages_of, trend_of
from tester.base.words import NONE, counted, decimal
from tester.report.chart import Chart, ChartPanel, Mark, series_of
from tester.report.layout import Paragraph, Part, Picture, ReportRow, ReportSection, ReportTable, heads
from tester.report.page import inline_svg
from tester.report.record_section import RunRecord

SECTOR_DEG = 30.0
COVERAGE = 1.96
"""Coverage factor of a share of errors, binomial, 95 %."""
Rung = tuple[RunRecord, RingRun]


def ring_sections(record: RunRecord, key: str) -> list[ReportSection]:
    """Return the section of a run's ring; empty where its machine has no ring, or sent no request over it."""
    part, ring = record.machine.ring, record.ring
    if part is None or ring is None or not ring.requests:
        return []
    totals = (
        f"{ring.errors} of {ring.requests} {part.counted} had no good reply ({decimal(ring.per_thousand, 2)} of 1000),"
        f" in {decimal(ring.turns, 0)} turns of {part.turns}."
    )
    parts: list[Part] = [Paragraph(totals, "care" if ring.errors else "good")]
    sectors, worn = ring.sectors(), record.results.worn
    parts += [
        sector_paragraph(f"{worn} {place}", sector) for place, sector in enumerate(sectors, start=1) if sector.errors
    ]
    if any(sum(sector.sectors) for sector in sectors):
        parts.append(Picture(inline_svg(angle_chart(sectors, part.turns, worn), key)))
    rows = [
        ReportRow((words, str(requests), str(errors), decimal(1e3 * errors / requests, 2) if requests else NONE))
        for words, requests, errors in ring.by_speed()
    ]
    titles = heads(f"speed of {part.turns}", "requests", "errors", "of 1000")
    parts.append(ReportTable("Errors by speed", titles, rows))
    return [ReportSection(key, part.title, parts)]


def sector_paragraph(name: str, sector: RingSector) -> Paragraph:
    """Return the angle at which errors gathered while a part of some name was mounted."""
    if not sector.found:
        return Paragraph(f"{name}: {counted(sector.errors, 'error')}, at no angle more than chance has it.")
    near = f"{sector.centre_deg:.0f}°, half of them within {sector.half_deg:.0f}° of it"
    return Paragraph(
        f"{name}: errors gather at {near} (strength {sector.strength:.2f}): a worn place, or a brush.", "bad"
    )


def angle_chart(sectors: Sequence[RingSector], turns: str, worn: str) -> Chart:
    """Return the errors in twelve sectors, a series for each mounted part."""
    series = tuple(
        series_of(
            f"{worn} {place}" if len(sectors) > 1 else "",
            map(_sector_mark, range(12), sector.sectors),
            "measured",
            place - 1,
        )
        for place, sector in enumerate(sectors, start=1)
        if sum(sector.sectors)
    )
    note = "angle from where it stood when it was mounted; each mark: a sector of 30°"
    return Chart("ring-angle", f"errors over the angle of {turns}", f"angle of {turns} (°)", "errors",
                 (ChartPanel("", series),), note)  # fmt: skip


def _sector_mark(i: int, count: int) -> Mark:
    name = f"{30 * i} to {30 * i + 30}°: {counted(count, 'error')}"
    return Mark(SECTOR_DEG * (i + 0.5), float(count), width=0.5 * SECTOR_DEG, name=name)


def ring_trend_sections(records: Sequence[RunRecord], key: str) -> list[ReportSection]:
    """Return the trend of the ring over runs of one rig, in order of time; empty for fewer than two such runs."""
    first = next((record for record in records if _has(record)), None)
    if first is None or first.machine.ring is None:
        return []
    rig = first.results.run.info.rig_source
    rung = [
        (record, record.ring) for record in records if _has(record) and record.ring is not None
        and record.results.run.info.rig_source == rig
    ]  # fmt: skip
    if len(rung) < 2:
        return []
    rung.sort(key=lambda pair: pair[1].started)
    ages = ages_of([ring for _, ring in rung])
    trend = trend_of([(age, ring.requests, ring.errors) for age, (_, ring) in zip(ages, rung, strict=True)])
    trend_words = trend.words or "too few errors, or turns, to say whether they grow"
    rows = [
        ReportRow((record.name, decimal(age, 0), str(ring.requests), str(ring.errors), decimal(ring.per_thousand, 2)))
        for age, (record, ring) in zip(ages, rung, strict=True)
    ]
    titles = heads("run", "turns until its end", "requests", "errors", "of 1000")
    note = "turns are those of these runs alone; a straight line through the shares, beyond chance with z of 2 or more"
    parts: list[Part] = [
        Paragraph(f"{trend_words[:1].upper()}{trend_words[1:]}.", "bad" if trend.grows else ""),
        Picture(inline_svg(trend_chart(rung, ages), key)),
        ReportTable(f"{first.machine.ring.title} from run to run", titles, rows, note),
    ]
    return [ReportSection(key, f"{first.machine.ring.title}: trend", parts)]


def trend_chart(rung: Sequence[Rung], ages: Sequence[float]) -> Chart:
    """Return the share of failed requests over the turns of the ring, with bars for chance."""
    marks = [
        Mark(age, ring.per_thousand, _half(ring), name=f"{record.name}: {decimal(ring.per_thousand, 2)} of 1000")
        for age, (record, ring) in zip(ages, rung, strict=True)
    ]
    points = series_of("", marks, "measured", 0)
    return Chart("ring-trend", "errors over the age of the ring", "turns of the ring", "errors of 1000 requests",
                 (ChartPanel("", (points,)),), "bars: what chance makes of a share (95 %)")  # fmt: skip


def _half(ring: RingRun) -> float:
    """Return half the width of the confidence interval of a run's share of errors, in errors per 1000 requests."""
    share = ring.errors / ring.requests
    half = 1e3 * COVERAGE * sqrt(share * (1.0 - share) / ring.requests)
    return half if isfinite(half) else 0.0


def _has(record: RunRecord) -> bool:
    return record.machine.ring is not None and record.ring is not None and record.ring.requests > 0
