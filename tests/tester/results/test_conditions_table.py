"""The table of conditions: one column is in every output that shows it, under one heading and to the same digits."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.repeats import ConditionResult
from tester.base.quantities import FURTHER, Channel, Means
from tester.cli.main import invoke
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results import conditions_table as module
from tester.results.columns import Column, Output
from tester.results.conditions_table import ConditionRow, axis_keys, conditions_table
from tester.results.measured_tables import repeats_table
from tester.results.run_results import RunResults, results_of
from tester.store.run_reader import RunReader
from tester.tui.stored import read
from tests.tester.results.made import made
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, result, small_run


@pytest.fixture
def more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Add one column to the table, as one entry of its module."""
    outputs = frozenset(Output)
    column = Column[ConditionRow]("grip", "grip", lambda row: 2.0 * row.result.mu, "dB", 2, outputs)
    monkeypatch.setattr(module, "_FOUND", (*module._FOUND, column))


def test_a_column_is_in_the_files(more: None, tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        header, first, *_ = csv.reader(made("conditions", reader).decode().splitlines())
    assert first[header.index("grip")] == "1.8"


def test_a_column_is_in_show_and_its_json(more: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    small_run(tmp_path)
    assert invoke(["show", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any("grip" in line for line in lines) and any("1.80" in line for line in lines)
    assert invoke(["show", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["conditions"][0]["grip"] == pytest.approx(1.8)


def test_a_column_is_at_the_end_of_a_run(more: None, tmp_path: Path) -> None:
    from tester.cli.ending import ending_lines

    text = "\n".join(ending_lines(small_run(tmp_path)))
    assert "grip" in text and "1.80" in text


def test_a_column_is_on_the_screen(more: None, tmp_path: Path) -> None:
    stored = read(str(small_run(tmp_path / "one")), tmp_path)
    assert stored.rows[0].cells[stored.header.index("grip (dB)")] == "1.80"


def test_a_column_is_in_the_report(more: None, tmp_path: Path) -> None:
    from tester.report.condition_tables import conditions_section, drift_section, short_table
    from tester.report.layout import ReportTable
    from tester.report.record_section import MachineWords, read_record

    record = read_record(small_run(tmp_path), MachineWords("a rig", "a coefficient"))
    tables = [short_table(record.results)]
    for section in (conditions_section(record, "a"), drift_section(record, "b")):
        tables += [part for part in section.parts if isinstance(part, ReportTable)]
    assert len(tables) == 3
    for table in tables:
        place = [head.text for head in table.heads].index("grip (dB)")
        assert table.rows[0].cells[place] == "1.80"


def test_a_column_is_in_the_tables_of_a_sweep(more: None) -> None:
    from tester.kinds.wheel_on_belt.image.axes import AXES
    from tester.run.sweep.sweep_tables import condition_header

    assert "grip" in condition_header((), AXES)


def test_keys_stand_once(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        keys = [one.key for one in conditions_table(results_of(reader)).columns]
    assert len(keys) == len(set(keys))


def with_humidity(results: RunResults) -> RunResults:
    """Return results of a rig that has a further sensor, which showed 41.3 % throughout."""
    channel = Channel("humidity_percent", "%", "Humidity", f"{FURTHER}.0", mean=99, decimals=1)
    quantities = QUANTITIES.with_further((channel,))

    def measured(one: ConditionResult) -> ConditionResult:
        return replace(one, measured=Means(quantities, [*one.measured.values(), 41.3]))

    rows = tuple(
        replace(
            row,
            result=measured(row.result),
            replicates=tuple(replace(one, result=measured(one.result)) for one in row.replicates),
        )
        for row in results.rows
    )
    return replace(results, quantities=quantities, rows=rows)


@pytest.mark.parametrize("output", [Output.SHOW, Output.REPORT, Output.SCREEN])
def test_people_see_the_mean_of_a_further_sensor(output: Output, tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        table = conditions_table(with_humidity(results_of(reader))).view(output)
    texts = dict(zip([one.head for one in table.columns], next(table.texts()), strict=True))
    assert texts["humidity (%)"] == "41.3" and "surface temp (°C)" not in texts


def test_a_number_that_is_not_trusted_has_its_mark_everywhere(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    for repeat in (1, 2):
        writer.commit_repeat(writer.begin_repeat(1, repeat, 1), result(0.7))
    writer.close()
    with RunReader(tmp_path) as reader:
        table = conditions_table(results_of(reader))
    (row,) = table.rows
    assert table["mu"].text(row) == "0.700!" and table["mark"].text(row) == "!"
    assert table["remarks"].text(row).startswith("not measured")


def with_area(results: RunResults, area_mm2: str) -> RunResults:
    """Return the results of a run whose recipe states an area."""
    info = results.run.info
    stated = replace(info, metadata={**info.metadata, "contact_area_mm2": area_mm2})
    return replace(results, run=replace(results.run, info=stated))


def test_a_pressure_is_beside_the_load_only_where_an_area_is_known(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        results = results_of(reader)
        assert "pressure_kpa" not in [column.key for column in conditions_table(results).columns]
        table = conditions_table(with_area(results, "250"))
        assert [table["pressure_kpa"].cell(row) for row in table.rows] == [400.0, 800.0]
        shown = [column.key for column in table.view(Output.SHOW, ("load_n",)).columns]
        assert shown[:2] == ["load_n", "pressure_kpa"]
        first = [column.key for column in table.view(Output.END, axis_keys(results.axes)).columns]
        assert first[first.index("load_n") + 1] == "pressure_kpa"
        ordered = [column.key for column in repeats_table(with_area(results, "250")).columns]
        assert ordered[ordered.index("load_n") + 1] == "pressure_kpa"
