"""`tester run`: options in, a folder and an exit code out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.run import session
from tester.run.session_options import SessionOptions
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT

SETS = [argument for override in QUIET for argument in ("--set", override)]


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder that holds a short recipe."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    return tmp_path


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[SessionOptions]:
    """Collect the options of every session instead of running it."""
    found: list[SessionOptions] = []

    class Taking:
        def __init__(self, options: SessionOptions, screen: object) -> None:
            found.append(options)

        def run(self) -> int:
            return 6

    monkeypatch.setattr(session, "Session", Taking)
    return found


def test_a_run_prints_its_folder_as_the_last_line(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml", "--yes", *SETS]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert Path(last).parent == Path("runs") and (home / last / "appendix.csv").is_file()


def test_with_json_records_come_first_and_the_bare_path_last(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml", "--yes", "--json", "--out", "there", "--bus-log", "bus", *SETS]) == 0
    *records, last = capsys.readouterr().out.splitlines()
    events = [json.loads(record)["event"] for record in records]
    assert events[0] == "begin" and events[-1] == "end"
    assert Path(last).parent == Path("there") and (home / "bus" / "can.log").is_file()


def test_an_invalid_recipe_is_reported_first(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "quikstart", "--yes"]) == 2
    assert "on rig" not in (said := capsys.readouterr().err) and 'no recipe "quikstart"' in said


def test_without_a_terminal_the_error_mentions_yes(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and "--yes" in captured.err


def test_a_recipe_that_does_not_exist_is_a_usage_error(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "nothing", "--yes"]) == 2
    assert "nothing" in capsys.readouterr().err


def test_an_invalid_recipe_exits_3_with_its_place(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (home / "bad.yaml").write_text(SHORT.replace("200 N", "200 kg"), encoding="utf-8")
    assert invoke(["run", "bad.yaml", "--yes"]) == 3
    assert "bad.yaml:13:11: " in capsys.readouterr().err and not (home / "runs").exists()


@pytest.mark.parametrize("speed", ["fast", "0", "-1", "nan", "inf", "1e9"])
def test_a_speed_that_is_none_is_a_usage_error(home: Path, speed: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml", "--yes", "--speed", speed]) == 2
    assert "--speed" in capsys.readouterr().err


@pytest.mark.parametrize("speed, lapse", [("max", None), ("1", 1.0), ("50", 50.0)])
def test_a_speed_is_a_time_lapse(home: Path, taken: list[SessionOptions], speed: str, lapse: float | None) -> None:
    invoke(["run", "short.yaml", "--yes", "--speed", speed])
    assert taken[0].lapse == lapse


def test_options_reach_the_session(home: Path, taken: list[SessionOptions]) -> None:
    code = invoke(
        ["run", "quickstart", "--yes", "--seed", "7", "--out", "x", "--operator", "ada", "--set", "sim.noise=0"]
    )
    (options,) = taken
    assert code == 6
    assert (options.recipe, options.seed, options.out, options.operator) == ("quickstart", 7, Path("x"), "ada")
    assert options.overrides == ("sim.noise=0",) and options.bus_log is None


def test_a_negative_seed_is_a_usage_error(home: Path) -> None:
    assert invoke(["run", "short.yaml", "--yes", "--seed", "-1"]) == 2


def test_an_operator_whose_name_could_steer_a_terminal_is_a_usage_error(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["run", "quickstart", "--yes", "--operator", "Ada\x1b[31m"]) == 2
    assert "operator: the character U+001B, number 4, is not accepted" in capsys.readouterr().err
