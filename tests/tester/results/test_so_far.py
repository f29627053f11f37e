"""A condition as it grows: the last value equals the table's, U needs a scatter, the open repeat is reduced."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from math import isfinite, isnan
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.results.conditions_table import ConditionRow, conditions_table
from tester.results.run_results import results_of
from tester.results.so_far import growth, open_repeat
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, result

VALUES = (0.70, 0.72, 0.71, 0.73)
SHORT = """\
recipe: short
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 5 rev, temperature_band: 2 degC}
grids:
  - {name: one, slip_velocity: [300 mm/s], load: [100 N], temperature: [25 degC]}
"""


def running(folder: Path, values: tuple[float, ...], *, before: bool = False) -> Path:
    """Write a run whose second condition has these repeats and has not ended; ``before``: the first has a value."""
    folder.mkdir()
    writer = open_writer(folder)
    conditions = [replace(CONDITION, condition=n, row=n, repeats=4) for n in (1, 2)]
    writer.begin_run(RUN, SPECIMENS, conditions)
    writer.piece_mounted(PIECE)
    for n, committed in ((1, VALUES if before else ()), (2, values)):
        writer.begin_condition(n, 5.0)
        for repeat, mu in enumerate(committed, start=1):
            writer.commit_repeat(writer.begin_repeat(n, repeat, 1, 9.0, piece=1), replace(result(mu), flags=""))
        if n == 1 and before:
            from tester.analysis.results import ConditionStatus

            writer.end_condition(1, ConditionStatus.OK, t_s=60.0)
    writer.close()
    return folder


def grown(folder: Path, number: int) -> tuple[ConditionRow, list[ConditionRow]]:
    with RunReader(folder) as reader:
        results = results_of(reader)
        row = next(row for row in conditions_table(results).rows if row.info.condition == number)
        return row, growth(reader, results, row)


def test_the_last_value_is_that_of_the_table_and_each_is_the_mean_of_its_repeats(tmp_path: Path) -> None:
    row, rows = grown(running(tmp_path / "a", VALUES), 2)
    assert rows[-1] is row and len(rows) == 4
    for count, one in enumerate(rows, start=1):
        assert one.result.mu_resultant == pytest.approx(sum(VALUES[:count]) / count, abs=1e-12)


def test_one_repeat_has_no_u_before_any_condition_has_ended(tmp_path: Path) -> None:
    _, rows = grown(running(tmp_path / "a", VALUES[:2]), 2)
    assert isnan(rows[0].result.budget.expanded) and rows[1].result.budget.expanded > 0.0


def test_one_repeat_has_the_u_of_the_scatter_of_conditions_that_have_ended(tmp_path: Path) -> None:
    _, rows = grown(running(tmp_path / "a", VALUES[:1], before=True), 2)
    assert rows[0].result.budget.expanded > 0.0


def test_u_of_a_condition_that_has_ended_is_the_same_as_before_its_end(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "one", [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)])
    row, rows = grown(folder, 2)
    assert rows[-1].result == row.result and all(isfinite(one.result.budget.expanded) for one in rows)


def test_a_condition_without_a_repeat_has_nothing_that_grows(tmp_path: Path) -> None:
    folder = running(tmp_path / "a", ())
    assert grown(folder, 2)[1] == []
    with RunReader(folder) as reader:
        assert open_repeat(reader) is None


def test_the_open_repeat_is_reduced_from_its_samples_as_at_its_end(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    invoke(["run", str(tmp_path / "short.yaml"), "--yes", "--seed", "1", "--out", str(tmp_path / "runs")])
    folder = next((tmp_path / "runs").glob("2*"))
    with RunReader(folder) as reader:
        assert open_repeat(reader) is None
        last = max(reader.repeats(), key=lambda repeat: repeat.key)
    with sqlite3.connect(folder / "run.db") as store:
        store.execute("UPDATE repeat SET status = 'open', mu_resultant = NULL WHERE id = ?", (last.key,))
    store.close()
    with RunReader(folder) as reader:
        found = open_repeat(reader)
    assert found is not None and (found.condition, found.repeat) == (last.condition, last.repeat)
    assert found.mu == pytest.approx(last.result.mu_resultant, rel=1e-9)
    assert found.revolutions == last.result.revolutions
