"""Charts of a run, before anything is drawn."""

from __future__ import annotations

from dataclasses import replace
from math import isnan
from pathlib import Path

import pytest

from sim.physics.materials import Components
from tester.kinds.wheel_on_belt.fit.fits import FITS
from tester.report.chart import Chart, ChartSurface, Figure, SecondScale, Series
from tester.report.charts import ChartValue, Material, charts_of, overlay_charts, repeats_chart, values_of
from tester.report.law_charts import components_chart
from tester.report.overview import overview_chart
from tester.results.run_results import RunResults, results_of
from tester.store.run_reader import RunReader
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.results.test_conditions_table import with_area
from tests.tester.store.build import CONDITION

PUBLISHED = [ChartValue(held, mu) for held, mu in FITS.published_values()]


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> RunResults:
    with RunReader(made_run(tmp_path_factory.mktemp("runs") / "one", failed=[3])) as reader:
        return results_of(reader)


@pytest.fixture(scope="module")
def charts(results: RunResults) -> dict[str, Figure]:
    material = Material(values_of(results), PUBLISHED, FITS.law_at("v2"), "law v2")
    return {one.name: one for one in charts_of(material)}


def chart(charts: dict[str, Figure], name: str) -> Chart:
    found = charts[name]
    assert isinstance(found, Chart)
    return found


def labelled(found: Chart, label: str) -> Series:
    return next(one for panel in found.panels for one in panel.series if one.label == label)


def test_each_axis_that_was_varied_is_plotted_against_at_each_value_of_another(charts: dict[str, Figure]) -> None:
    assert list(charts) == [
        "load-by-temperature",
        "slip_velocity-by-temperature",
        "temperature-by-load",
        "temperature-by-slip_velocity",
        "surface",
    ]


def test_points_have_their_expanded_uncertainty_as_bars(results: RunResults, charts: dict[str, Figure]) -> None:
    found = chart(charts, "load-by-temperature")
    cold = labelled(found, "25 °C")
    assert cold.x == (100.0, 200.0, 400.0)  # at 300 N the run has no value
    row = next(row for row in results.rows if row.info.setpoint.number("load") == 100.0)
    assert (cold.y[0], cold.bars[0]) == (row.result.mu, row.result.budget.expanded)
    assert (found.x_label, found.panels[0].title) == ("load (N)", "1#, 300 mm/s")


def test_the_papers_points_stand_beside_in_the_same_style(charts: dict[str, Figure]) -> None:
    found = chart(charts, "load-by-temperature")
    cold = labelled(found, "25 °C")
    beside = [s for s in found.panels[0].series if s.look == "published" and s.style == cold.style]
    assert [(s.x, s.y) for s in beside] == [((100.0, 200.0, 300.0, 400.0), (0.88, 0.73, 0.63, 0.52))]
    assert "hollow: as published" in found.note


def test_a_law_is_a_curve_through_the_same_conditions(charts: dict[str, Figure]) -> None:
    found = chart(charts, "temperature-by-load")
    curve = next(s for s in found.panels[0].series if s.look == "law")
    assert (curve.x[0], curve.x[-1]) == (25.0, 85.0)
    held = CONDITION.setpoint.but("1#", load=100.0, temperature=25.0, slip_velocity=0.3)
    assert curve.y[0] == pytest.approx(FITS.law_at("v2")(held))
    assert "lines: law v2" in found.note


def test_a_speed_is_shown_and_asked_for_in_its_own_units(charts: dict[str, Figure]) -> None:
    found = chart(charts, "slip_velocity-by-temperature")
    curve = next(s for s in found.panels[0].series if s.look == "law")
    assert (found.x_label, curve.x[-1]) == ("slip velocity (mm/s)", 400.0)
    held = CONDITION.setpoint.but("1#", load=200.0, temperature=25.0, slip_velocity=0.4)
    assert curve.y[-1] == pytest.approx(FITS.law_at("v2")(held))


def test_the_surface_has_a_value_for_each_pair_that_was_measured(charts: dict[str, Figure]) -> None:
    surface = charts["surface"]
    assert isinstance(surface, ChartSurface)
    ((title, x, y, grid),) = surface.panels
    assert (x, y) == ((100.0, 200.0, 300.0, 400.0), (0.0, 100.0, 200.0, 300.0, 400.0))
    assert sum(not isnan(value) for row in grid for value in row) == 8 and title == "1#, 40 degC"


def test_an_axis_that_was_varied_alone_has_a_chart_of_its_own() -> None:
    values = [
        ChartValue(CONDITION.setpoint.but(sideslip=angle), 0.7 + 0.01 * angle, 0.02) for angle in (0.0, 10.0, 20.0)
    ]
    (found,) = charts_of(Material(values, PUBLISHED))
    assert isinstance(found, Chart) and found.name == "sideslip"
    assert labelled(found, "measured").x == (0.0, 10.0, 20.0)


def test_compounds_have_a_panel_each_and_share_styles() -> None:
    values = [
        ChartValue(CONDITION.setpoint.but(name, load=load, temperature=t), 0.7)
        for name, temperatures in (("1#", (25.0, 40.0)), ("2#", (40.0,)))
        for load in (100.0, 200.0)
        for t in temperatures
    ]
    found = chart({one.name: one for one in charts_of(Material(values))}, "load-by-temperature")
    assert [panel.title[:2] for panel in found.panels] == ["1#", "2#"]
    assert found.panels[0].series[1].style == found.panels[1].series[0].style


def pressed(kpa_per_n: float | None, run: str = "") -> list[ChartValue]:
    return [
        ChartValue(CONDITION.setpoint.but(load=load, temperature=t), 0.7, run=run, kpa_per_n=kpa_per_n)
        for load in (100.0, 200.0)
        for t in (25.0, 40.0)
    ]


def test_an_axis_of_loads_has_a_scale_of_pressures_where_the_area_is_known() -> None:
    found = {one.name: one for one in charts_of(Material(pressed(2.5)))}
    assert chart(found, "load-by-temperature").x_second == SecondScale("pressure (kPa)", 2.5)
    by_load, surface = chart(found, "temperature-by-load"), found["surface"]
    assert by_load.x_second is None
    assert [one.label for one in by_load.panels[0].series] == ["100 N (250 kPa)", "200 N (500 kPa)"]
    assert isinstance(surface, ChartSurface) and surface.x_label == "load (N)"
    assert surface.x_second == SecondScale("pressure (kPa)", 2.5) and surface.y_second is None
    unknown = {one.name: one for one in charts_of(Material(pressed(None)))}
    assert chart(unknown, "load-by-temperature").x_second is None
    assert [one.label for one in chart(unknown, "temperature-by-load").panels[0].series] == ["100 N", "200 N"]


def test_runs_of_different_areas_share_no_scale_of_pressures() -> None:
    alike = {one.name: one for one in overlay_charts([*pressed(2.5, "a"), *pressed(2.5, "b")])}
    other = {one.name: one for one in overlay_charts([*pressed(2.5, "a"), *pressed(5.0, "b")])}
    assert alike["load-of-runs"].x_second == SecondScale("pressure (kPa)", 2.5)
    assert other["load-of-runs"].x_second is None


def test_values_and_the_overview_of_a_run_know_its_area(results: RunResults) -> None:
    stated = with_area(results, "250")
    assert {value.kpa_per_n for value in values_of(stated)} == {4.0}
    overview = overview_chart([("", stated)])
    assert overview is not None
    of_load = next(panel for panel in overview.panels if panel.y_label == "load (N)")
    assert of_load.y_second == SecondScale("pressure (kPa)", 4.0)


def test_nothing_measured_gives_no_chart() -> None:
    assert not list(charts_of(Material([])))


def test_repeats_have_their_time_and_their_scatter(results: RunResults) -> None:
    measured = next(results.conditions())
    (panel,) = repeats_chart(measured).panels
    (series,) = panel.series
    first = measured.repeats[0].result
    assert series.x[0] == pytest.approx((first.started_s + first.ended_s) / 120.0)
    assert series.widths[0] == pytest.approx((first.ended_s - first.started_s) / 120.0)
    assert series.bars[0] == pytest.approx(0.01 * first.fluctuation_percent * first.mu_resultant)


def test_a_repeat_that_is_left_out_is_drawn_apart(tmp_path: Path) -> None:
    from tester.analysis.results import RepeatStatus
    from tests.tester.store.build import RUN, SPECIMENS, open_writer, record

    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    record(writer, 1, [0.9, 0.91, 0.92])
    writer.close()
    with RunReader(tmp_path) as reader:
        measured = next(results_of(reader).conditions())
    refused = replace(measured.repeats[1], result=replace(measured.repeats[1].result, status=RepeatStatus.REFUSED))
    repeats = (measured.repeats[0], refused, measured.repeats[2])
    from tester.analysis.repeats import combine_repeats

    again = replace(measured, repeats=repeats, result=combine_repeats([one.result for one in repeats], 3))
    (panel,) = repeats_chart(again).panels
    assert [(s.label, len(s.x)) for s in panel.series] == [("in the mean", 2), ("left out", 1)]


def test_a_law_gives_nothing_for_other_compounds_and_unknown_names() -> None:
    assert isnan(FITS.law_at("paper")(CONDITION.setpoint.but("NR 60")))
    with pytest.raises(KeyError):
        FITS.law_at("wlf_bell")


def test_published_values_have_the_rows_with_an_angle_but_no_suspect_or_inferred_ones() -> None:
    angles = [one for one in PUBLISHED if one.held.number("sideslip")]
    assert sorted({one.held.compound for one in angles}) == ["1#", "2#"] and len(angles) == 6
    assert len(PUBLISHED) == 34 + 79 + 6


def test_dry_and_wet_have_panels_and_surfaces_of_their_own(tmp_path: Path) -> None:
    run = made_track_run(tmp_path / "one", (0.0, 20.0), (1e-4, 1e-3), interfaces=("dry", "wet"))
    with RunReader(run) as reader:
        found = {one.name: one for one in charts_of(Material(values_of(results_of(reader))))}
    over_speed, surface = found["track_speed-by-temperature"], found["surface"]
    assert isinstance(over_speed, Chart) and isinstance(surface, ChartSurface)
    assert [panel.title for panel in over_speed.panels] == ["SBR, 20 N", "SBR, wet, 20 N"]
    assert all(len(panel.series) == 2 for panel in over_speed.panels)
    assert [title for title, *_ in surface.panels] == ["SBR, 20 N", "SBR, wet, 20 N"]


def test_the_parts_of_a_law_are_lines_with_their_sum() -> None:
    found = components_chart(lambda x: Components(x, 2.0 * x), (1.0, 10.0), "roughness (mm)", "a law", "at 25 degC")
    (panel,) = found.panels
    assert {one.label: one.y for one in panel.series} == {
        "adhesion": (1.0, 10.0), "hysteresis": (2.0, 20.0), "sum": (3.0, 30.0),
    }  # fmt: skip
    assert found.log_x and {one.look for one in panel.series} == {"law"}


def test_a_law_drawn_beyond_its_data_is_named_with_the_exceeded_bound(results: RunResults) -> None:
    held = values_of(results)
    far = [replace(one, held=one.held.but(load=2.0 * one.held.number("load"))) for one in held]
    for values, beyond in ((held, False), (far, True)):
        material = Material(values, (), FITS.law_at("v2"), "law v2", FITS.law_caveats)
        found = chart({one.name: one for one in charts_of(material)}, "load-by-temperature")
        assert ("load 800 N is outside the paper's data, 100 to 400 N: an extrapolation" in found.note) is beyond
