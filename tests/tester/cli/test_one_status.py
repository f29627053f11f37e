"""One run, one status: every command, the catalogue and the screens show the same word."""

from __future__ import annotations

import json
import sqlite3
from contextlib import nullcontext
from pathlib import Path

import pytest

from tester.analysis.results import RepeatStatus
from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.cli.main import invoke
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.results.catalogue.entries import fingerprint, read_entries
from tester.service.preflight import past_of
from tester.tui.stored import read
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, open_writer, record

MISSING = RepeatStatus.TOO_FEW


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TESTER_CATALOGUE", raising=False)
    return tmp_path


def stored(home: Path, recorded: str, status: RepeatStatus = RepeatStatus.VALID) -> Path:
    """Write a run of two conditions whose record ends with a status, "" for none; ``status``: of every repeat."""
    folder = home / "runs" / "one"
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    for condition in CONDITIONS:
        record(writer, condition.condition, [0.9, 0.91, 0.92], status=status)
    if recorded:
        writer.finish(recorded, rig_seconds=60.0)
    writer.close()
    return folder


@pytest.mark.parametrize(
    ("recorded", "repeats", "held", "word"),
    [
        ("", RepeatStatus.VALID, False, "interrupted"),
        ("", RepeatStatus.VALID, True, "running"),
        ("interrupted", RepeatStatus.VALID, False, "interrupted"),
        ("done", RepeatStatus.VALID, False, "done"),
        ("done", MISSING, False, "incomplete"),
        ("done", MISSING, True, "incomplete"),
        ("tripped", MISSING, False, "tripped"),
        ("stopped", RepeatStatus.VALID, True, "running"),
        ("rig unreachable", MISSING, False, "rig unreachable"),
    ],
)
def test_every_output_shows_the_same_status(
    home: Path, capsys: pytest.CaptureFixture[str], recorded: str, repeats: RepeatStatus, held: bool, word: str
) -> None:
    folder = stored(home, recorded, repeats)

    def said(*arguments: str) -> str:
        invoke([*arguments])
        return capsys.readouterr().out

    with ExclusiveUse() if held else nullcontext() as use:
        if isinstance(use, ExclusiveUse):
            use.lock_file("one", folder / RUN_LOCK, "one", lasting=False)
        past = past_of(home / "runs", SERVED)
        words = {
            "runs --json": json.loads(said("runs", "--json"))[0]["status"],
            "show --json": json.loads(said("show", "one", "--json"))["status"],
            "verify --json": json.loads(said("verify", "one", "--json"))["status"],
            "catalogue": read_entries(folder, "", fingerprint(folder))[0].status,
            "results screen": read("one", home / "runs").status,
            "pre-flight list": past.status if past is not None else "",
        }
        assert words == dict.fromkeys(words, word)
        assert said("runs").startswith(f"one  {word}")
        assert said("show", "one").splitlines()[1].startswith(f"status   {word}")


def test_a_kill_is_seen_although_no_file_changes(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = stored(home, "")
    with ExclusiveUse() as use:
        use.lock_file("one", folder / RUN_LOCK, "one", lasting=False)
        invoke(["runs"])
        assert capsys.readouterr().out.startswith("one  running, process ")
    invoke(["runs"])
    assert capsys.readouterr().out.startswith("one  interrupted, 6 of 6 repeats committed")


def test_compare_marks_a_number_that_is_not_to_be_trusted(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = stored(home, "")
    with sqlite3.connect(folder / "run.db") as database:
        database.execute("DELETE FROM repeat WHERE condition = 1 AND repeat > 1")
        database.execute("UPDATE condition SET status = 'not measured', ended_s = NULL WHERE condition = 1")
    invoke(["compare", "one", "one", "--json"])
    marks = [(row["mark_1"], row["mark_2"]) for row in json.loads(capsys.readouterr().out)]
    assert marks[0] == ("!", "!") and set(marks[1:]) == {("", "")}
