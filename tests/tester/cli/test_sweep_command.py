"""`tester sweep`: options in, a folder and an exit code out."""

from __future__ import annotations

import json
import sys
from collections.abc import Generator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.run.sweep import sweep
from tester.run.sweep.case import CaseResult, SweepTask
from tester.run.sweep.sweep import Submit
from tests.tester.run.sweep.results import result, row


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def jobs(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Do every run at once, and keep the requested number of processes."""
    asked: list[int] = []

    @contextmanager
    def at_once(jobs: int) -> Generator[Submit]:
        def submit(work: object, task: SweepTask, /) -> Future[CaseResult]:
            future: Future[CaseResult] = Future()
            missing = row(2, status="insufficient")
            future.set_result(result(task.case, row(), *([missing] if task.seed == 9 else []), point=task.point))
            return future

        asked.append(jobs)
        yield submit

    monkeypatch.setattr(sweep, "local", at_once)
    return asked


def test_the_folder_is_the_last_line(home: Path, jobs: list[int], capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sweep", "quickstart", "--seeds", "3", "--jobs", "2"]) == 0
    captured = capsys.readouterr()
    folder = Path(captured.out.splitlines()[-1])
    assert folder.parent == Path("sweeps") and (home / folder / "summary.csv").is_file()
    assert jobs == [2] and captured.err.splitlines()[0] == f"3 runs into {folder}"


def test_with_json_every_run_is_a_line_and_the_bare_path_the_last(
    home: Path, jobs: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    invoke(["sweep", "quickstart", "--seed", "8", "--seeds", "2", "--set", "sim.noise=0,1", "--json", "--out", "there"])
    *lines, last = capsys.readouterr().out.splitlines()
    begin, *runs = [json.loads(line) for line in lines]
    assert begin == {"event": "begin", "folder": last, "runs": 4} and Path(last).parent == Path("there")
    assert sorted((run["set"]["sim.noise"], run["case"]) for run in runs) == [("0", 1), ("0", 2), ("1", 3), ("1", 4)]
    assert all(run["rows"][0]["mu"] == 0.73 for run in runs)


def test_there_are_no_more_processes_than_runs(home: Path, jobs: list[int]) -> None:
    assert invoke(["sweep", "quickstart", "--seeds", "2", "--jobs", "8"]) == 0 and jobs == [2]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "sim.noise"], "expected key=value"),
        (["--seeds", "0"], "--seeds"),
        (["--jobs", "2", "--dask", "tcp://127.0.0.1:1"], "one of them"),
    ],
)
def test_a_wrong_call_is_a_usage_error(
    home: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["sweep", "quickstart", *arguments]) == 2
    assert message in capsys.readouterr().err and not (home / "sweeps").exists()


def test_a_recipe_that_does_not_exist_is_a_usage_error(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sweep", "nothing"]) == 2
    assert "nothing" in capsys.readouterr().err


def test_a_value_that_is_none_exits_3(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sweep", "quickstart", "--set", "sim.noise=loud"]) == 3
    assert "sim.noise=loud" in capsys.readouterr().err


def test_a_cluster_without_its_library_names_the_extra(
    home: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert invoke(["sweep", "quickstart", "--dask", "tcp://127.0.0.1:8786"]) == 2
    assert "friction-tester[cluster]" in capsys.readouterr().err and not (home / "sweeps").exists()
