"""The last lines of a run on a terminal."""

from __future__ import annotations

import sys
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest
from rich.cells import cell_len

from tester.analysis.flags import CARRY_OVER
from tester.analysis.results import ConditionStatus
from tester.cli.console import Console
from tester.cli.ending import ROWS_AT_MOST, ending_lines
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, record, small_run


def test_every_condition_has_its_coefficient_and_its_uncertainty(tmp_path: Path) -> None:
    header, units, first, second = ending_lines(small_run(tmp_path))[1:5]
    assert header.split() == ["compound", "Slip", "Load", "Angle", "Temp", "mu", "U", "this", "valid"]
    assert units.split() == ["mm/s", "N", "°", "°C", "wheel"]
    assert first.split()[:6] == ["1#", "300", "100", "0", "25", "0.900"] and first.endswith("3 of 3  extended")
    assert second.split()[2] == "200" and float(second.split()[6]) > 0.0


def test_numbers_stand_below_each_other(tmp_path: Path) -> None:
    header, _, first, second = ending_lines(small_run(tmp_path))[1:5]
    for column in ("Slip", "Load", "Angle", "Temp", "mu", "U this"):
        end = header.index(f" {column} ") + len(column) + 1
        assert all(line[end - 1] != " " and line[end] == " " for line in (first, second))


def test_a_condition_without_a_value_has_a_dash_and_its_status(tmp_path: Path) -> None:
    row = ending_lines(small_run(tmp_path, ([nan] * 3, [0.73, 0.74, 0.72])))[3]
    assert row.split()[5:] == ["—", "—", "0", "of", "3", "insufficient"]


def test_camber_is_a_column_where_a_condition_has_it(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    tilted = replace(CONDITION, setpoint=CONDITION.setpoint.but(camber=-2.0))
    writer.begin_run(RUN, SPECIMENS, [tilted, replace(CONDITION, condition=2, row=2)])
    record(writer, 1, [0.9] * 3)
    record(writer, 2, [0.8] * 3)
    writer.close()
    header, _, first, second = ending_lines(tmp_path)[1:5]
    assert header.split()[4] == "Camber" and (first.split()[4], second.split()[4]) == ("-2", "0")


def test_a_value_to_be_taken_with_care_is_marked_and_the_digits_stay_in_line(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION, replace(CONDITION, condition=2, row=2)])
    record(writer, 1, [0.9] * 3)
    record(writer, 2, [0.8] * 3, flags=CARRY_OVER)
    writer.close()
    lines = ending_lines(tmp_path)
    (plain,) = (line for line in lines if "0.900 " in line)
    (doubtful,) = (line for line in lines if "0.800?" in line)
    assert plain.index("0.900") == doubtful.index("0.800")
    assert any("carry-over" in line for line in lines)


def test_a_condition_that_was_tried_without_a_repeat_is_a_row_of_its_own(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITION, condition=i, row=i) for i in (1, 2, 3)])
    writer.begin_condition(1, 5.0)
    writer.end_condition(1, ConditionStatus.NOT_REACHED, "the surface stays at 31 degC", t_s=60.0)
    writer.close()
    lines = ending_lines(tmp_path)
    assert any("not reached" in line for line in lines) and "2 of 3 conditions not measured" in lines


def test_no_line_is_wider_than_a_terminal(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    name = "a compound with 長い名前 that goes on"
    held = CONDITION.setpoint.but(name, slip_velocity=0.123456, camber=1.5, wheel_speed=0.25)
    condition = replace(CONDITION, setpoint=held)
    writer.begin_run(RUN, SPECIMENS, [condition, replace(CONDITION, condition=2, row=2)])
    record(writer, 1, [0.9, 0.7, 0.3])
    record(writer, 2, [0.9] * 3)
    writer.close()
    table = ending_lines(tmp_path)[1:-4]
    assert "…" in table[2] and "Wheel" in table[0] and all(cell_len(line) <= 80 for line in table)


def test_conditions_that_were_not_reached_are_one_line(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITION, condition=i, row=i) for i in range(1, 166)])
    record(writer, 1, [0.9] * 3)
    writer.close()
    lines = ending_lines(tmp_path)
    assert "164 of 165 conditions not measured" in lines and len(lines) < 15


def test_a_table_that_is_too_long_names_the_file_with_the_rest(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITION, condition=i, row=i) for i in range(1, ROWS_AT_MOST + 4)])
    for i in range(1, ROWS_AT_MOST + 4):
        record(writer, i, [0.9] * 3)
    writer.close()
    assert f"and 3 more conditions: {tmp_path / 'conditions.csv'}" in ending_lines(tmp_path)


def test_the_next_command_is_written_as_this_one_was_called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [".venv/bin/tester", "run"])
    folder = small_run(tmp_path / "a run")
    assert f"next: .venv/bin/tester show '{folder}'" in ending_lines(folder)


def test_a_run_that_lacks_values_and_did_not_finish_can_be_resumed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/pytest"])
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    writer.close()
    assert f"next: tester resume {tmp_path}" in ending_lines(tmp_path)


def test_the_table_is_for_people_and_the_folder_for_scripts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = small_run(tmp_path)
    Console(as_json=False, answer_yes=True).result(str(folder))
    out, err = capsys.readouterr()
    assert out == f"{folder}\n" and "0.900" in err and "tester show" in err


def test_with_json_there_is_no_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Console(as_json=True, answer_yes=True).result(str(small_run(tmp_path)))
    assert capsys.readouterr().err == ""


def test_the_table_states_the_measurand_of_its_uncertainty(tmp_path: Path) -> None:
    assert "U: expanded uncertainty (95 %) of this wheel; conditions.csv has the compound's" in ending_lines(
        small_run(tmp_path)
    )
