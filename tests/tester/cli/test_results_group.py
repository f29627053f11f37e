"""``tester results exclude`` and ``tester results include``: what is said, and what comes of it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.store.run_reader import RunReader
from tests.tester.store.build import small_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder whose runs/ holds one finished run, ``one``."""
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one", ([0.90, 0.91, 0.89], [0.70, 0.74, 0.72, 0.73]))
    return tmp_path


def said(*arguments: str) -> int:
    return invoke(["results", *arguments, "--operator", "ada [b]"])


def test_it_says_what_the_condition_has_become(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == 0
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("2/1 excluded: 1#, 300 mm/s, 200 N, 25 degC: ok")
    told, head = captured.err.splitlines()
    with RunReader(home / "runs" / "one") as reader:
        assert told.endswith("valid 3 of 3") and head == f"record head: {reader.record_head()}"


def test_show_lists_every_word_with_who_and_why(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == said("include", "one", "2/1", "--reason", "none") == 0
    assert invoke(["show", "one"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("2/1 ")]
    assert [line.split()[1] for line in lines] == ["excluded", "included"]
    assert lines[0].endswith("by ada [b]: debris") and lines[1].endswith("by ada [b]: none")


def test_show_as_json_has_the_words_and_the_repeats_exclusion(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said("exclude", "one", "2/1", "--reason", "debris") == 0
    assert invoke(["show", "one", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert [(word["condition"], word["repeat"], word["excluded"]) for word in shown["exclusions"]] == [(2, 1, True)]
    assert shown["conditions"][1]["repeats"][0]["exclusion"] == "excluded by hand: debris"


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("exclude", "one", "2/1"), 2, "--reason"),
        (("exclude", "one", "2-1", "--reason", "x"), 2, "CONDITION/REPEAT"),
        (("exclude", "none", "2/1", "--reason", "x"), 2, "no run none"),
        (("exclude", "one", "9/1", "--reason", "x"), 1, "not a committed repeat"),
        (("include", "one", "2/1", "--reason", "x"), 1, "has not been excluded"),
    ],
)
def test_what_is_wrong_is_said(
    arguments: tuple[str, ...], code: int, message: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["results", *arguments]) == code
    assert message in capsys.readouterr().err
