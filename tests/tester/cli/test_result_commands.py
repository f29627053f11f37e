"""``tester show`` and ``tester export``."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from tester.analysis.flags import CARRY_OVER
from tester.cli.result_commands import export, show
from tester.cli.runs_command import runs
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, open_writer, record, small_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose runs/ holds one finished run, ``one``."""
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one")
    return tmp_path


def invoke(command: object, *arguments: str) -> Result:
    return CliRunner().invoke(command, list(arguments), prog_name="tester")  # type: ignore[arg-type]


def test_show_prints_status_rig_time_and_values(home: Path) -> None:
    lines = invoke(show, "one").stdout.splitlines()
    assert lines[0] == "one: Small, two loads"
    assert lines[1] == "status   done"
    assert lines[2].startswith("rig time 0:45:00")
    heads = "compound  Slip  Load  Angle  Temp     mu     mu as  U this         U       s   valid"
    assert lines[3] == heads
    assert lines[4].split() == ["mm/s", "N", "°", "°C", "measured", "wheel", "compound"]
    assert lines[5].split()[:7] == ["1#", "300", "100", "0", "25", "0.900", "0.900"]
    assert lines[5].endswith("3 of 3  extended")
    assert lines[7] == "All 2 conditions have a value; none carries a doubt, 2 carry a note (extended)."
    assert lines[8].startswith("extended (note): A repeat collected more revolutions")


def test_show_prints_the_extensions_that_a_run_had_loaded(home: Path) -> None:
    (home / "runs" / "two").mkdir()
    writer = open_writer(home / "runs" / "two")
    extension = {"extension laws/acme": "acme 1.2, acme.law:LAW, sha256 00ff"}
    writer.begin_run(replace(RUN, versions={**RUN.versions, **extension}), SPECIMENS, CONDITIONS)
    writer.close()
    assert "loaded   laws/acme: acme 1.2, acme.law:LAW, sha256 00ff" in invoke(show, "two").stdout.splitlines()
    assert json.loads(invoke(show, "two", "--json").stdout)["versions"] == {"numpy": "1.26.0", **extension}


def test_show_as_json(home: Path) -> None:
    shown = json.loads(invoke(show, "one", "--json").stdout)
    assert (shown["rig_seconds"], shown["status"], shown["seed"]) == (2700.5, "done", 1)
    assert [condition["mu"] for condition in shown["conditions"]] == pytest.approx([0.9, 0.73])
    assert len(shown["conditions"][0]["repeats"]) == 3
    assert shown["missing"] == []


def test_show_prints_a_trip_with_its_value_and_its_acknowledger(home: Path) -> None:
    (home / "runs" / "two").mkdir()
    writer = open_writer(home / "runs" / "two")
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    number = writer.trip(20.0, "overload", "too firm", 460.0, 450.0, "N")
    writer.trip_acknowledged(number, 30.0, "ada, user id 1000")
    writer.trip(40.0, "drive fault", "lost")
    writer.close()
    lines = invoke(show, "two").stdout.splitlines()
    assert lines[-4].startswith("trip at 0:00:20 of rig time") and lines[-4].endswith("overload (460 N, limit 450 N)")
    assert lines[-3].startswith("  acknowledged 2024-") and lines[-3].endswith("by ada, user id 1000")
    assert lines[-2].endswith("drive fault") and lines[-1] == "  not acknowledged"
    first, second = json.loads(invoke(show, "two", "--json").stdout)["trips"]
    assert (first["value"], first["limit"], first["unit"], first["acknowledged_s"]) == (460.0, 450.0, "N", 30.0)
    assert (second["value"], second["acknowledged_utc"]) == (None, None)


def test_show_names_conditions_without_a_value(home: Path) -> None:
    small_run(home / "runs" / "two", ([nan] * 3, [0.73, 0.74, 0.72]))
    shown = invoke(show, "two").stdout
    assert "1 of 2 conditions has a value; none carries a doubt, 1 carries a note (extended)." in shown
    assert "1#, 300 mm/s, 100 N, 25 degC: insufficient: none of 3 repeats is valid" in shown
    assert json.loads(invoke(show, "two", "--json").stdout)["conditions"][0]["s"] is None


@pytest.fixture
def stopped(home: Path) -> str:
    """A run of five conditions; one was measured, with a doubt."""
    folder = home / "runs" / "stopped"
    folder.mkdir()
    writer = open_writer(folder)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITIONS[0], condition=i, row=i) for i in range(1, 6)])
    record(writer, 1, [0.9] * 3, flags=CARRY_OVER)
    writer.finish("stopped", rig_seconds=60.0)
    writer.close()
    return "stopped"


def test_conditions_that_a_run_did_not_come_to_are_one_line(stopped: str) -> None:
    lines = invoke(show, stopped).stdout.splitlines()
    assert lines[-1] == "4 of 5 conditions not measured"


def test_a_doubt_is_in_json(stopped: str) -> None:
    first, second, *_ = json.loads(invoke(show, stopped, "--json").stdout)["conditions"]
    assert (first["mark"], second["mark"]) == ("?", "") and "carry-over" in first["flags"]


def test_a_doubt_about_a_value_of_the_appendix_is_reported(stopped: str) -> None:
    told = invoke(export, stopped, "--format", "appendix").stderr.splitlines()
    assert told[-1].startswith("to be taken with care: 1#, 300 mm/s") and "pre_grind" in told[-1]


def test_export_writes_the_file_of_the_run_folder_to_stdout(home: Path) -> None:
    from tester.results.run_files import write_all

    write_all(home / "runs" / "one")
    for kind in ("appendix", "conditions", "repeats"):
        assert (
            invoke(export, "one", "--format", kind).stdout_bytes == (home / "runs" / "one" / f"{kind}.csv").read_bytes()
        )


def test_export_takes_a_folder_and_decimals(home: Path) -> None:
    out = invoke(export, str(home / "runs" / "one"), "--format", "appendix", "--decimals", "3").stdout_bytes
    assert out.endswith(b"1#,300,200,0,25,0.730\n")


def test_export_to_a_file_leaves_stdout_empty(home: Path) -> None:
    result = invoke(export, "one", "--format", "samples", "--out", "s.csv")
    assert (result.exit_code, result.stdout) == (0, "")
    assert len((home / "s.csv").read_text("utf-8").splitlines()) == 31


def test_export_names_missing_conditions_on_stderr(home: Path) -> None:
    small_run(home / "runs" / "two", ([nan] * 3, [0.73, 0.74, 0.72]))
    result = invoke(export, "two", "--format", "appendix")
    assert result.exit_code == 0
    assert result.stderr.startswith("not in the appendix: 1#, 300 mm/s, 100 N, 25 degC: insufficient")
    assert len(result.stdout.splitlines()) == 2


def test_parquet_needs_a_file(home: Path) -> None:
    result = invoke(export, "one", "--format", "parquet")
    assert result.exit_code == 2
    assert "--out" in result.stderr


def test_parquet_goes_to_its_file(home: Path) -> None:
    assert invoke(export, "one", "--format", "parquet", "--out", "s.parquet").exit_code == 0
    assert (home / "s.parquet").read_bytes()[:4] == b"PAR1"


def test_parquet_without_pyarrow_names_the_command_that_installs_it(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = invoke(export, "one", "--format", "parquet", "--out", "s.parquet")
    assert result.exit_code == 2
    assert 'the format parquet needs pyarrow: pip install "friction-tester[parquet]"' in result.stderr
    assert [path.name for path in home.iterdir()] == ["runs"]


@pytest.mark.parametrize("command", [[show, "nothing"], [export, "nothing", "--format", "appendix"]])
def test_a_run_that_is_not_there_is_a_usage_error(home: Path, command: list[object]) -> None:
    result = invoke(command[0], *[str(argument) for argument in command[1:]])
    assert result.exit_code == 2
    assert "no run nothing" in result.stderr


@pytest.mark.parametrize(
    "arguments", [["one"], ["one", "--format", "xlsx"], ["one", "--format", "appendix", "--decimals", "-1"]]
)
def test_wrong_options_are_usage_errors(home: Path, arguments: list[str]) -> None:
    assert invoke(export, *arguments).exit_code == 2


def test_a_run_that_cannot_be_read_fails(home: Path) -> None:
    (home / "runs" / "one" / "run.db").write_bytes(b"x" * 4096)
    assert invoke(show, "one").exit_code == 1
    assert invoke(export, "one", "--format", "appendix").exit_code == 1


def test_a_file_that_cannot_be_written_fails(home: Path) -> None:
    assert invoke(export, "one", "--format", "appendix", "--out", "missing/a.csv").exit_code == 1


def test_text_of_a_recipe_cannot_drive_the_terminal(home: Path) -> None:
    from dataclasses import replace

    (home / "runs" / "two").mkdir()
    writer = open_writer(home / "runs" / "two")
    writer.begin_run(replace(RUN, recipe_name="\x1b[2Jgone"), SPECIMENS, CONDITIONS)
    writer.close()
    assert "\x1b" not in invoke(runs).stdout + invoke(show, "two").stdout


def test_show_prints_both_uncertainties_with_their_measurands(home: Path) -> None:
    (measured,) = (line for line in invoke(show, "one").stdout.splitlines() if line.startswith("1#         300   100"))
    first, _ = json.loads(invoke(show, "one", "--json").stdout)["conditions"]
    assert measured.split()[7:9] == [f"{first[key]:.3f}" for key in ("u_expanded", "u_expanded_compound")]


def test_show_prints_the_budget_with_the_largest_term_first(home: Path) -> None:
    lines = invoke(show, "one", "--budget").stdout.splitlines()
    assert lines[1].startswith("  U this wheel 0.0") and lines[2].startswith("  U compound 0.0")
    assert lines[3].split()[:3] == ["term", "df", "u(mu)"] and lines[4].split()[:3] == ["wheel", "to", "wheel"]
    end = lines[3].index("u(mu) (%)") + len("u(mu) (%)")
    percents = [float(line[:end].split()[-1]) for line in lines[4:10]]
    assert percents == sorted(percents, reverse=True)
