"""Tables over many runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import sqrt

import pytest

from tester.kinds.wheel_on_belt.image.axes import AXES as HELD
from tester.results.table_cells import Cell
from tester.run.sweep import sweep_tables
from tester.run.sweep.grid import SweepAxis
from tests.tester.run.sweep.results import result, row

AXES = (SweepAxis("sim.noise", ("0", "1")),)


def named(header: Sequence[Cell], rows: Iterable[Sequence[Cell]]) -> list[dict[Cell, Cell]]:
    return [dict(zip(header, cells, strict=True)) for cells in rows]


def test_a_summary_is_over_the_seeds_of_a_condition() -> None:
    results = [result(i, row(1, mu), row(2, 0.5)) for i, mu in enumerate((0.70, 0.72, 0.74), start=1)]
    first, second = named(sweep_tables.summary_header((), HELD), sweep_tables.summary_rows(results))
    assert (first["row"], first["runs"], first["n"], second["row"]) == (1, 3, 3, 2)
    assert first["mu_mean"] == pytest.approx(0.72) and first["mu_sd"] == pytest.approx(0.02)
    assert (first["mu_min"], first["mu_max"]) == (0.70, 0.74)


def test_the_spread_is_held_against_the_stated_uncertainty() -> None:
    results = [result(1, row(1, 0.70, u=0.03)), result(2, row(1, 0.74, u=0.01))]
    (found,) = named(sweep_tables.summary_header((), HELD), sweep_tables.summary_rows(results))
    stated = sqrt((0.03**2 + 0.01**2) / 2)
    assert found["u_standard"] == pytest.approx(stated)
    assert found["sd_over_u"] == pytest.approx(0.04 / sqrt(2) / stated)


def test_a_condition_without_a_value_counts_as_a_run_and_not_as_a_value() -> None:
    results = [result(1, row()), result(2, row(status="insufficient"))]
    (found,) = named(sweep_tables.summary_header((), HELD), sweep_tables.summary_rows(results))
    assert (found["runs"], found["n"], found["mu_mean"], found["mu_sd"], found["sd_over_u"]) == (2, 1, 0.73, None, None)


def test_values_to_be_taken_with_care_are_counted() -> None:
    doubtful = row(1, care="?")
    results = [result(1, row(1)), result(2, doubtful), result(3, row(1, status="insufficient"))]
    (found,) = named(sweep_tables.summary_header((), HELD), sweep_tables.summary_rows(results))
    assert (found["n"], found["with_care"]) == (2, 1)
    assert [one.with_care for one in results] == [0, 1, 0]


def test_points_are_summed_up_by_themselves_in_their_order() -> None:
    results = [
        result(3, row(mu=0.6), point=("1",)),
        result(1, row(mu=0.7), point=("0",)),
        result(2, row(mu=0.8), point=("0",)),
    ]
    found = named(sweep_tables.summary_header(AXES, HELD), sweep_tables.summary_rows(results))
    assert [(r["sim.noise"], r["runs"], r["mu_mean"]) for r in found] == [("0", 2, pytest.approx(0.75)), ("1", 1, 0.6)]


def test_totals_count_outcomes_rows_and_missing_values() -> None:
    results = [
        result(1, row(1), row(2)),
        result(2, row(1), row(2, status="insufficient")),
        result(3, row(1, status="pending"), outcome="tripped"),
    ]
    (found,) = named(sweep_tables.totals_header((), "wheel"), sweep_tables.totals_rows(results))
    assert (found["runs"], found["done"], found["other_outcomes"]) == (3, 2, "1 tripped")
    assert (found["rows"], found["missing_rows"]) == (5, 2)


def test_durations_are_those_of_runs_that_came_to_their_end() -> None:
    results = [result(1, row()), result(3, row()), result(100, row(), outcome="tripped")]
    (found,) = named(sweep_tables.totals_header((), "wheel"), sweep_tables.totals_rows(results))
    assert (found["rig_seconds_mean"], found["rig_seconds_min"], found["rig_seconds_max"]) == (1002.0, 1001.0, 1003.0)
    assert (found["wheels_mean"], found["wheels_sd"]) == (1.0, 0.0)


def test_every_row_of_every_table_is_as_long_as_its_header() -> None:
    one = result(1, row(), point=("0",))
    assert len(sweep_tables.run_row(one)) == len(sweep_tables.run_header(AXES, "wheel"))
    for header, rows in (
        (sweep_tables.condition_header(AXES, HELD), sweep_tables.condition_rows(one)),
        (sweep_tables.summary_header(AXES, HELD), sweep_tables.summary_rows([one])),
        (sweep_tables.totals_header(AXES, "wheel"), sweep_tables.totals_rows([one])),
    ):
        assert [len(cells) for cells in rows] == [len(header)]
