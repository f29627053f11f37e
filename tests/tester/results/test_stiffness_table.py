"""The table of deformation and stiffness, and its figure, from a record's samples."""

from __future__ import annotations

from collections.abc import Iterator
from csv import DictReader
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.results import ConditionStatus
from tester.base.quantities import KEY, TIME
from tester.report.stiffness_chart import stiffness_chart
from tester.results.formats import FORMATS
from tester.results.run_files import write_all
from tester.results.run_results import results_of
from tester.results.stiffness_table import stiffness_rows
from tester.store.run_reader import RunReader
from tests.tester.analysis.pressed_rubber import Pressed
from tests.tester.results.made import made
from tests.tester.store.build import BURSTS, CONDITION, PIECE, RUN, SPECIMENS, open_writer, result, row, small_run

LOADS_N = (100.0, 300.0)
CORES_C = (25.0, 45.0, 65.0)
TWICE = 2
CHANNEL = {"load": "force_z_n", "depth": "press_mm", "surface": "surface_c", "core": "hub_c", "slip": "slip_m_s"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run's folder: two loads at three temperatures, twice each, on rubber that softens and relaxes."""
    made_in = tmp_path_factory.mktemp("run")
    writer = open_writer(made_in)
    settings = [(core_c, load_n) for core_c in CORES_C for load_n in LOADS_N]
    conditions = [
        replace(CONDITION, condition=number, row=number, repeats=TWICE, min_valid=TWICE,
                setpoint=CONDITION.setpoint.but(load=load_n, temperature=core_c))
        for number, (core_c, load_n) in enumerate(settings, start=1)
    ]  # fmt: skip
    writer.begin_run(RUN, SPECIMENS, conditions)
    writer.piece_mounted(replace(PIECE, installed_s=0.0))
    rig, done = Pressed(4), 0
    for number, (core_c, load_n) in enumerate(settings, start=1):
        writer.begin_condition(number, rig.now_s)
        rig.core_c = core_c
        for repeat in range(1, TWICE + 1):
            key = writer.begin_repeat(number, repeat, 1, rig.now_s, piece=1)
            rig.press(load_n, 30.0)
            columns = rig.columns
            for place in range(done, len(columns[TIME])):
                values = {name: columns[channel][place] for channel, name in CHANNEL.items()}
                writer.sample(row(columns[TIME][place], float(key), **values))
                assert columns[KEY][place] == key
            done = len(columns[TIME])
            writer.commit_repeat(key, result(), BURSTS)
        writer.end_condition(number, ConditionStatus.OK, t_s=rig.now_s)
    writer.finish("done", rig_seconds=rig.now_s)
    writer.close()
    return made_in


@pytest.fixture
def reader(folder: Path) -> Iterator[RunReader]:
    with RunReader(folder) as opened:
        yield opened


def rows_of(reader: RunReader) -> list[dict[str, str]]:
    return list(DictReader(made("stiffness", reader).decode().splitlines()))


def test_each_condition_has_its_deformation_and_its_compounds_softening_and_relaxation(reader: RunReader) -> None:
    rows = rows_of(reader)
    assert [row["condition"] for row in rows] == ["1", "2", "3", "4", "5", "6"]
    assert {row["compound"] for row in rows} == {"1#"} and {row["contacts"] for row in rows} == {"2"}
    for row_ in rows:
        assert float(row_["measured_load_n"]) == pytest.approx(float(row_["load_n"]), rel=0.03)
        assert abs(float(row_["softening_percent_k"]) - 0.4) <= float(row_["softening_u_expanded_percent_k"])
        off_percent = float(row_["relaxation_percent_decade"]) - 3.0
        assert abs(off_percent) <= float(row_["relaxation_u_expanded_percent_decade"])


def test_warm_rubber_gives_way_more_under_the_same_load(reader: RunReader) -> None:
    depths = [float(row["deformation_mm"]) for row in rows_of(reader) if row["load_n"] == "300"]
    stiff = [float(row["stiffness_n_mm"]) for row in rows_of(reader) if row["load_n"] == "300"]
    assert depths == sorted(depths) and stiff == sorted(stiff, reverse=True)
    assert depths[-1] / depths[0] == pytest.approx(1.13, abs=0.05)


def test_a_run_with_enough_contacts_keeps_the_table(folder: Path, tmp_path: Path) -> None:
    write_all(folder)
    assert (folder / "stiffness.csv").is_file()
    write_all(small_run(tmp_path))
    assert not (tmp_path / "stiffness.csv").exists()


def test_a_run_with_too_few_contacts_has_an_empty_table(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as few:
        assert rows_of(few) == []
        assert FORMATS["stiffness"].kept is not None and not FORMATS["stiffness"].kept(results_of(few))


def test_the_figure_has_a_series_with_bars_for_each_load(reader: RunReader) -> None:
    chart = stiffness_chart(stiffness_rows(results_of(reader), reader))
    assert chart is not None
    (panel,) = chart.panels
    assert [series.label for series in panel.series] == ["100 N", "300 N"]
    assert all(len(series.x) == len(CORES_C) and min(series.bars) > 0.0 for series in panel.series)
    assert panel.title.startswith("1#: softening 0.") and "a decade" in panel.title


def test_no_rows_draw_nothing() -> None:
    assert stiffness_chart([]) is None
