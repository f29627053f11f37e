"""Reference conditions are exported in their own table, with a mark, a chart, a sentence and a term."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest

from tester.analysis.flags import OUT_OF_LIMITS, flags_in
from tester.cli.ending import ending_table
from tester.cli.main import invoke
from tester.results.run_files import write_all
from tester.results.run_results import RunResults, results_of
from tester.store.records import Travel
from tester.store.run_reader import RunReader
from tests.tester.results.made import made
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, record

WATCHED = replace(RUN, metadata={"reference_every": "1"})
SHARP, BLUNT = [0.70, 0.71, 0.69], [0.56, 0.57, 0.55]


def watched_run(
    folder: Path, references: Sequence[list[float]] = (SHARP, SHARP, BLUNT), *, marked: bool = True
) -> Path:
    """Record references with a condition between each two of them; each is 500 m of travel after the one before."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = open_writer(folder)
    conditions, values = [], []
    for number, repeats in enumerate(references):
        place = 2 * number + 1
        mark = replace(CONDITION, condition=place, row=100 + number, grid="reference")
        held = CONDITION.setpoint.but(load=150.0 + place)
        own = replace(CONDITION, condition=place + 1, row=number + 1, setpoint=held)
        conditions += [mark, own]
        values += [repeats, [0.80, 0.81, 0.79]]
    conditions, values = conditions[:-1], values[:-1]
    writer.begin_run(WATCHED if marked else RUN, SPECIMENS, conditions)
    writer.piece_mounted(PIECE)
    key = 0
    for condition, repeats in zip(conditions, values, strict=True):
        record(writer, condition.condition, repeats)
        for _ in repeats:
            key += 1
            writer.travelled(1, Travel(250.0 * (condition.condition - 1), 10.0 * condition.condition), key)
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    return folder


def results(folder: Path) -> RunResults:
    with RunReader(folder) as reader:
        return results_of(reader)


def lines(kind: str, folder: Path) -> list[list[str]]:
    with RunReader(folder) as reader:
        return list(csv.reader(made(kind, reader).decode("utf-8-sig").splitlines()))


def test_references_are_not_in_the_paper_s_table(tmp_path: Path) -> None:
    assert [row[2] for row in lines("appendix", watched_run(tmp_path))[1:]] == ["151", "153"]


def test_references_have_a_table_of_their_own(tmp_path: Path) -> None:
    header, *rows = lines("reference", watched_run(tmp_path))
    found = [dict(zip(header, row, strict=True)) for row in rows]
    assert [(one["reference"], one["condition"], one["wheel"], one["within"]) for one in found] == [
        ("1", "1", "1", "1"), ("2", "3", "1", "1"), ("3", "5", "1", "0")
    ]  # fmt: skip
    assert [float(one["counterface_travel_m"]) for one in found] == [0.0, 500.0, 1000.0]
    assert {one["told_apart"] for one in found} == {"0"} and float(found[0]["change_percent"]) < -15.0


def test_they_are_conditions_with_a_mark(tmp_path: Path) -> None:
    header, *rows = lines("conditions", watched_run(tmp_path))
    flags = {row[header.index("condition")]: row[header.index("flags")] for row in rows}
    assert ["reference" in flags[number].split("; ") for number in "12345"] == [True, False, True, False, True]
    assert len(lines("repeats", tmp_path)) == 1 + 15


def test_a_condition_before_a_reference_out_of_its_limits_is_to_be_taken_with_care(tmp_path: Path) -> None:
    first, second = results(watched_run(tmp_path)).rows
    assert OUT_OF_LIMITS not in flags_in(first.result.flags) and OUT_OF_LIMITS in second.result.doubts
    assert "change or clean the counterface" in second.advise()


def test_no_coefficient_is_changed_by_them(tmp_path: Path) -> None:
    with_marks = results(watched_run(tmp_path / "a")).rows
    without = [row for row in results(watched_run(tmp_path / "b", marked=False)).rows if row.info.grid != "reference"]
    assert [one.result.mu for one in with_marks] == [one.result.mu for one in without]
    assert [one.result.budget for one in with_marks] == [one.result.budget for one in without]


def test_the_counterface_is_a_term_of_the_compound_s_budget(tmp_path: Path) -> None:
    first, second = (row.result for row in results(watched_run(tmp_path)).rows)
    terms = [next(one for one in r.compound_budget.contributions if one.name == "counterface") for r in (first, second)]
    assert terms[1].standard / second.mu_resultant == pytest.approx(3.0 * terms[0].standard / first.mu_resultant)
    assert not [one for one in first.budget.contributions if one.name == "counterface"]
    header, *rows = lines("budget", tmp_path)
    assert "counterface" in {row[header.index("term")] for row in rows}


def test_a_grid_called_reference_in_a_run_without_references_is_a_grid(tmp_path: Path) -> None:
    found = results(watched_run(tmp_path, marked=False))
    assert len(found.rows) == 5 and not found.references and found.watch is None


def test_a_reference_without_a_value_is_missing_and_leaves_the_others(tmp_path: Path) -> None:
    found = results(watched_run(tmp_path, (SHARP, [nan, nan, nan], BLUNT)))
    assert [row.info.condition for row in found.missing()] == [3] and found.valued() == 2
    assert found.watch is not None
    drift = found.watch.drifts[""]
    assert drift is not None and drift.references == 2


def test_the_end_of_a_run_prints_a_sentence(tmp_path: Path) -> None:
    told = list(ending_table(results(watched_run(tmp_path)), tmp_path))
    assert any("counterface and wheel cannot be told apart" in line for line in told)
    assert any(line.endswith("outside: 3") for line in told)


def test_a_run_s_folder_keeps_the_table_where_there_are_references(tmp_path: Path) -> None:
    write_all(watched_run(tmp_path / "with"))
    write_all(watched_run(tmp_path / "without", marked=False))
    assert (tmp_path / "with" / "reference.csv").is_file()
    assert not (tmp_path / "without" / "reference.csv").exists()


def test_show_prints_them_and_has_the_charts_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_all(watched_run(tmp_path / "watched"))
    assert invoke(["show", str(tmp_path / "watched")]) == 0
    assert "limits 0." in capsys.readouterr().out
    assert invoke(["show", str(tmp_path / "watched"), "--json"]) == 0
    assert '"told_apart": false' in capsys.readouterr().out
