"""A run's results: reduced from committed repeats, in recipe order."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.flags import SHORT, THERMOMETER
from tester.analysis.results import ConditionStatus, RepeatStatus, SoakCheck
from tester.results.conditions_table import conditions_table
from tester.results.run_results import RunResults, results_of
from tester.store.record_schema import StoreError
from tester.store.run_reader import RunReader
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, record, result, small_run


def results(folder: Path) -> RunResults:
    with RunReader(folder) as reader:
        return results_of(reader)


def test_every_condition_has_a_row_with_its_mean(tmp_path: Path) -> None:
    found = results(small_run(tmp_path))
    assert [row.result.mu_resultant for row in found.rows] == pytest.approx([0.90, 0.73])
    assert found.missing() == []


def test_a_condition_without_a_valid_repeat_is_missing_with_a_reason(tmp_path: Path) -> None:
    (row,) = results(small_run(tmp_path, ([], [0.73, 0.74, 0.72]))).missing()
    assert row.describe() == "1#, 300 mm/s, 100 N, 25 degC: insufficient: none of 0 repeats is valid"


def test_a_condition_of_too_few_repeats_has_a_value_and_a_flag(tmp_path: Path) -> None:
    found = results(small_run(tmp_path, ([0.9, 0.91], [0.73, 0.74, 0.72])))
    assert found.missing() == [] and found.rows[0].result.doubts == (SHORT,)


def test_a_temperature_that_cannot_be_held_is_named_with_rate_and_band(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    writer.end_condition(1, ConditionStatus.CANNOT_HOLD, "", 9.0, warming_k_s=3.14, holdable_band_k=5.5)
    writer.close()
    (row,) = results(tmp_path).missing()
    assert row.describe().endswith("temperature cannot be held: warming 3.1 K/s; 5.5 K of band would do")


def test_a_condition_that_was_not_reached_is_not_measured(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    writer.close()
    (row,) = results(tmp_path).missing()
    assert row.result.status is ConditionStatus.PENDING


def test_replicates_make_one_row_with_a_combined_value(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    conditions = [replace(CONDITION, condition=i, replicate=i) for i in (1, 2, 3)]
    writer.begin_run(RUN, SPECIMENS, conditions)
    for condition, mu in zip(conditions, (0.70, 0.72, 0.74), strict=True):
        record(writer, condition.condition, [mu] * 3)
    writer.close()
    found = results(tmp_path)
    (row,) = found.rows
    assert row.result.mu_resultant == pytest.approx(0.72)
    assert (row.result.n_valid, len(row.replicates), len(list(found.conditions()))) == (3, 3, 3)


def test_a_left_out_repeat_has_a_reason(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITION, repeats=4)])
    record(writer, 1, [0.70, 0.71, 0.72])
    writer.commit_repeat(writer.begin_repeat(1, 4, 1), result(0.9, RepeatStatus.REFUSED, "drift +4 %"))
    writer.close()
    (measured,) = results(tmp_path).conditions()
    assert [measured.exclusion(repeat) for repeat in measured.repeats] == ["", "", "", "refused: drift +4 %"]


def test_a_setting_of_the_budget_that_is_no_number_is_refused(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(replace(RUN, metadata={"uncertainty.misalignment_deg": "much"}), SPECIMENS, [CONDITION])
    writer.close()
    with pytest.raises(StoreError, match=r"run\.db"):
        results(tmp_path)


def test_a_run_has_the_mean_of_the_closest_two_where_its_recipe_asks_for_it(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(replace(RUN, metadata={"combine": "paper"}), SPECIMENS, [CONDITION])
    record(writer, 1, [0.80, 0.70, 0.72])
    writer.close()
    (row,) = results(tmp_path).rows
    assert row.result.mu_resultant == 0.71
    assert "closest two of three" in row.result.flags


def soaked(folder: Path, *off_k: float) -> RunResults:
    """Return the results of a condition that soaked so often, with the thermometer so far off, K; 2 K are allowed."""
    writer = open_writer(folder)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    for off in off_k:
        writer.soaked(SoakCheck(1, 60.0, 25.0 + off, 25.0, 27.0, 2.0))
    record(writer, 1, [0.70, 0.71, 0.72])
    writer.close()
    return results(folder)


def test_a_thermometer_that_parts_from_the_hub_is_a_doubt(tmp_path: Path) -> None:
    found = soaked(tmp_path, 3.0)
    assert found.rows[0].result.doubts == (THERMOMETER,)
    table = conditions_table(found)
    header, row = table.csv()
    assert row[header.index("thermometer_off_k")] == 3.0 and row[header.index("thermometer_allowed_k")] == 2.0


def test_the_last_soak_of_a_condition_counts(tmp_path: Path) -> None:
    assert soaked(tmp_path, 3.0, 0.5).rows[0].result.doubts == ()
