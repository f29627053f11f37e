"""A setting that a run measures several times: lines, flags and JSON of the findings."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.flags import DISAGREES, flags_in
from tester.cli.ending import ending_table
from tester.cli.main import invoke
from tester.results.repeated_tables import settings_table
from tester.results.run_files import write_all
from tester.results.run_results import RunResults, results_of
from tester.store.run_reader import RunReader
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, record

ALIKE = ([0.70, 0.71, 0.69], [0.71, 0.70, 0.72], [0.69, 0.70, 0.71])
OTHER = (0.80, 0.81, 0.79)
CHANGED = ([0.70, 0.71, 0.69], [0.90, 0.91, 0.89], [0.69, 0.70, 0.71])


def repeated_run(
    folder: Path, measurements: Sequence[list[float]], *, replicates: bool = False, other: Sequence[float] = OTHER
) -> Path:
    """Record a setting measured several times on one wheel, as conditions or as replicates, and one other setting."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = open_writer(folder)
    conditions = [
        replace(CONDITION, condition=n, row=1 if replicates else n, replicate=n if replicates else 1)
        for n in range(1, len(measurements) + 1)
    ]
    last = len(measurements) + 1
    conditions.append(replace(CONDITION, condition=last, row=last, setpoint=CONDITION.setpoint.but(load=150.0)))
    writer.begin_run(RUN, SPECIMENS, conditions)
    writer.piece_mounted(PIECE)
    for condition, values in zip(conditions, [*measurements, list(other)], strict=True):
        record(writer, condition.condition, values)
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    return folder


def results(folder: Path) -> RunResults:
    with RunReader(folder) as reader:
        return results_of(reader)


def test_a_setting_measured_once_is_not_listed(tmp_path: Path) -> None:
    assert results(repeated_run(tmp_path, ALIKE[:1])).settings == ()


def test_measurements_that_agree_carry_no_doubt(tmp_path: Path) -> None:
    found = results(repeated_run(tmp_path, ALIKE))
    (setting,) = found.settings
    assert [one.condition for one in setting.measurements] == [1, 2, 3] and not setting.disagrees
    assert found.doubtful() == []


def test_every_measurement_of_a_setting_that_disagrees_is_in_doubt_and_no_other(tmp_path: Path) -> None:
    found = results(repeated_run(tmp_path, CHANGED))
    assert [DISAGREES in row.result.doubts for row in found.rows] == [True, True, True, False]
    assert "look for what changed in between" in found.rows[0].advise()


def test_the_outlier_is_named(tmp_path: Path) -> None:
    (setting,) = results(repeated_run(tmp_path, CHANGED)).settings
    verdict, differences = setting.lines("wheel")
    assert verdict.startswith("1#, 300 mm/s, 100 N, 25 degC: 3 measurements do not agree (chi-squared ")
    assert "condition 2 stands out most, mu 0.900, +28.6 ±" in verdict
    assert differences.startswith("condition 2 less 1, on one wheel: +0.200 ± 0.")
    assert "; condition 3 less 1, on one wheel: +0.000 ± 0." in differences


def test_replicates_are_measurements_of_one_setting(tmp_path: Path) -> None:
    found = results(repeated_run(tmp_path, CHANGED, replicates=True))
    assert [one.condition for one in found.settings[0].measurements] == [1, 2, 3]
    row = found.rows[0]
    assert DISAGREES in row.result.doubts and all(DISAGREES in one.result.doubts for one in row.replicates)


def test_without_a_known_repeatability_nothing_is_held_against_each_other(tmp_path: Path) -> None:
    found = results(repeated_run(tmp_path, [[0.70], [0.90]], other=[0.80]))
    (setting,) = found.settings
    assert setting.found is None and DISAGREES not in flags_in(found.rows[0].result.flags)
    assert "not held against each other" in next(setting.lines("wheel"))


def test_more_differences_than_a_line_holds_are_counted(tmp_path: Path) -> None:
    (setting,) = results(repeated_run(tmp_path, [*ALIKE, *ALIKE])).settings
    _, differences = setting.lines("wheel")
    assert differences.count(" less 1") == 3 and differences.endswith("; 2 more")


@pytest.mark.parametrize("measurements", [ALIKE, CHANGED])
def test_end_of_run_show_report_and_json_agree(
    measurements: Sequence[list[float]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = repeated_run(tmp_path, measurements)
    found = results(folder)
    lines = [*found.settings[0].lines("wheel")]
    assert set(lines) <= set(ending_table(found, folder))
    assert invoke(["show", str(folder)]) == 0
    assert set(lines) <= set(capsys.readouterr().out.splitlines())
    assert invoke(["show", str(folder), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["settings"]
    assert rows == [*settings_table(found).records()]


def test_the_table_has_a_row_for_each_measurement(tmp_path: Path) -> None:
    rows = [*settings_table(results(repeated_run(tmp_path, CHANGED))).records()]
    assert [(one["condition"], one["mu"], one["stands_out"], one["agrees"]) for one in rows] == [
        (1, pytest.approx(0.70), False, False), (2, pytest.approx(0.90), True, False),
        (3, pytest.approx(0.70), False, False),
    ]  # fmt: skip
    assert rows[0]["difference"] is None and rows[1]["difference"] == pytest.approx(0.2)
    assert all(one["one_piece"] for one in rows) and rows[1]["u_difference"] == pytest.approx(0.04, abs=0.02)


def test_a_run_s_folder_gets_the_table_where_a_setting_was_measured_several_times(tmp_path: Path) -> None:
    for name, measurements in (("several", ALIKE), ("once", ALIKE[:1])):
        write_all(repeated_run(tmp_path / name, measurements))
    assert (tmp_path / "several" / "settings.csv").is_file()
    assert not (tmp_path / "once" / "settings.csv").exists()
