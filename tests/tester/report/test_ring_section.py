"""The ring in a report: errors by angle and speed, trend over runs of one rig; no section without a ring."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.analysis.ring_errors import RingRun, RingSegment
from tester.report.charts import Material, values_of
from tester.report.layout import Paragraph, Picture, ReportSection, ReportTable
from tester.report.page import page_of
from tester.report.record_section import MachineWords, RunRecord, read_record
from tester.report.report_build import report_of
from tester.report.ring_section import angle_chart, ring_sections, ring_trend_sections, trend_chart
from tester.results.run_results import RingPart
from tests.tester.kinds.wheel_on_belt.fit.made import made_run

pytest.importorskip("matplotlib", reason="needs the extra `report`")
pytest.importorskip("jinja2", reason="needs the extra `report`")


def ring(errors: int, started: str = "2026-01-01", *, at_deg: float = 95.0) -> RingRun:
    """Return a run of 1000 turns, 10,000 requests, whose errors come at one angle."""
    at = [turn + at_deg / 360.0 for turn in range(0, 1000, 1000 // max(errors, 1))][:errors]
    segment = RingSegment(1000.0, [100, 0, 0, 9900, 0], [0, 0, 0, errors, 0], at)
    return RingRun("made", started, [segment])


def part_with(found: RingRun) -> RingPart:
    return RingPart("Slip ring", "requests over it", "the wheel", lambda _reader, name: replace(found, name=name))


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> RunRecord:
    folder = made_run(tmp_path_factory.mktemp("runs") / "one", [(25.0, 100.0, 0.1)])
    return read_record(folder, MachineWords("a rig", "a coefficient", ring=part_with(ring(60))))


def texts(section: ReportSection) -> list[str]:
    return [one.text for one in section.parts if isinstance(one, Paragraph)]


def with_ring(record: RunRecord, name: str, found: RingRun, rig: str = "mine.yaml") -> RunRecord:
    results = record.results
    info = replace(results.run.info, rig_source=rig)
    return replace(record, name=name, ring=found, results=replace(results, run=replace(results.run, info=info)))


def test_the_section_gives_share_angle_and_speed(plain: RunRecord) -> None:
    (section,) = ring_sections(plain, "r1-ring")
    assert section.title == "Slip ring"
    first, gathered = texts(section)
    assert first == "60 of 10000 requests over it had no good reply (6.00 of 1000), in 1000 turns of the wheel."
    assert gathered.startswith("wheel 1: errors gather at 95°")
    (table,) = [one for one in section.parts if isinstance(one, ReportTable)]
    assert ["2 to 4 rev/s", "9900", "60", "6.06"] in [list(row.cells) for row in table.rows]
    assert any(isinstance(one, Picture) for one in section.parts)


def test_the_chart_has_the_errors_of_each_sector() -> None:
    (panel,) = angle_chart(ring(60).sectors(), "the wheel", "wheel").panels
    (series,) = panel.series
    assert series.x[3] == 105.0 and series.y[3] == 60.0 and sum(series.y) == 60.0
    assert series.names[3] == "90 to 120°: 60 errors"


def test_without_errors_it_states_that_and_draws_nothing(plain: RunRecord) -> None:
    (section,) = ring_sections(replace(plain, ring=ring(0)), "r1-ring")
    assert texts(section)[0].startswith("0 of 10000") and not any(isinstance(one, Picture) for one in section.parts)


def test_a_kind_without_a_ring_and_a_run_without_requests_have_no_section(plain: RunRecord) -> None:
    assert ring_sections(replace(plain, machine=MachineWords("", "")), "k") == []
    assert ring_sections(replace(plain, ring=RingRun("one", "2026")), "k") == []


def test_the_trend_is_over_runs_of_one_rig_in_order_of_time(plain: RunRecord) -> None:
    early, late = ring(10, "2026-01-01"), ring(60, "2026-02-01")
    runs = [with_ring(plain, "late", late), with_ring(plain, "early", early)]
    (section,) = ring_trend_sections([*runs, with_ring(plain, "other", ring(500), "its.yaml")], "all-ring")
    assert texts(section) == ["+5.000 errors of 1000 for every 1000 turns (z 6.0): grows."]
    (table,) = [one for one in section.parts if isinstance(one, ReportTable)]
    assert [list(row.cells)[:2] for row in table.rows] == [["early", "1000"], ["late", "2000"]]
    assert ring_trend_sections(runs[:1], "all-ring") == []


def test_the_trend_is_drawn_with_its_range_of_chance(plain: RunRecord) -> None:
    (panel,) = trend_chart([(plain, ring(60))], [1000.0]).panels
    (series,) = panel.series
    assert series.y == (6.0,) and series.bars[0] == pytest.approx(1e3 * 1.96 * (0.006 * 0.994 / 10000) ** 0.5)


def test_the_page_holds_section_and_trend(plain: RunRecord) -> None:
    runs = [with_ring(plain, "one", ring(10)), with_ring(plain, "two", ring(60, "2026-02-01"))]
    page = page_of(report_of(runs, lambda record: Material(values_of(record.results))))
    assert "Slip ring: trend" in page and "errors over the angle of the wheel" in page
