"""`tester new`: five questions, each answer checked at once, and a recipe that passes `tester check`."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from tester.cli.main import invoke, root
from tester.kinds import packaged_rigs

WHEEL = ["--compound", "1#", "--axis", "slip_velocity=300 mm/s", "--axis", "temperature=40 degC"]
TRACK = ["--compound", "SBR", "--axis", "temperature=23 degC", "--axis", "load=10 N", "--axis"]
RIGS = {
    "sim": [*WHEEL, "--axis", "load=100 N"],
    "grosch": [*TRACK, "track_speed=1 mm/s, 2 mm/s"],
    "pin-on-disc": [*TRACK, "track_speed=0.1 m/s"],
}


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def new(*arguments: str, answers: str | None = None) -> Result:
    return CliRunner().invoke(root, ["new", *arguments], input=answers, prog_name="tester")


def test_five_questions_make_a_recipe_that_passes_its_check() -> None:
    answers = ["sim", "1#, 2#", "300 mm/s", "100 N, 200 N", "", "", "40 degC", "4", "two loads"]
    result = new(answers="\n".join(answers) + "\n")
    assert result.stdout == "two-loads.yaml\n", result.stderr
    assert [line[:2] for line in result.stderr.splitlines() if line[:1].isdigit()] == ["1.", "2.", "3.", "4.", "5."]
    text = Path("two-loads.yaml").read_text(encoding="utf-8")
    assert "load: [100 N, 200 N]" in text and "repeats: 4," in text and "sideslip" not in text
    assert invoke(["check", "two-loads.yaml"]) == 0


@pytest.mark.parametrize("rig", packaged_rigs())
def test_options_make_a_recipe_for_every_packaged_rig(rig: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["new", "--yes", "--rig", rig, *RIGS[rig], "-o", "a.yaml"]) == 0, capsys.readouterr().err
    assert invoke(["check", "a.yaml", "--rig", rig]) == 0
    assert invoke(["plan", "a.yaml", "--rig", rig]) == 0


@pytest.mark.parametrize(
    ("before", "wrong", "words"),
    [
        ([], "nosuch", "no such file"),
        (["sim"], ",", "at least one value"),
        (["sim", "1#", "300 mm/s"], "2 kN", "2000 N is more than the rig allows (limit 440 N"),
        (["sim", "1#", "300 mm/s"], "200", "200 has no unit"),
        (["sim", "1#", "300 mm/s", "200 N", "", "", "40 degC"], "0", "repeats"),
        (["grosch", "SBR"], "oil", '"oil" is not accepted'),
    ],
)
def test_a_wrong_answer_is_refused_at_once_and_asked_again(before: list[str], wrong: str, words: str) -> None:
    result = new(answers="\n".join([*before, wrong, wrong]) + "\n")
    assert result.exit_code == 1  # the answers end
    assert result.stderr.count(words) == 2, result.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--axis", "load=200"], "--axis load=...: load: 200 has no unit"),
        (["--axis", "laod=200 N"], "expected NAME=VALUES with one of slip_velocity, load"),
        (["--axis", "load=200 N", "--repeats", "none"], "--repeats: "),
        ([], "--axis load=...: this has no default, so --yes needs it"),
    ],
)
def test_a_wrong_option_is_a_usage_error(options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["new", "--yes", *WHEEL, *options]) == 2
    assert words in capsys.readouterr().err


def test_a_recipe_that_would_wear_the_wheel_out_is_refused_and_not_written(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--axis", "load=400 N", "--repeats", "1000", "-o", "a.yaml"]
    assert invoke(["new", "--yes", *WHEEL, *options]) in (2, 3)
    assert "more than replace_after" in capsys.readouterr().err
    assert not Path("a.yaml").exists()


def test_an_existing_file_is_kept(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.yaml").write_text("mine")
    assert invoke(["new", "--yes", *WHEEL, "--axis", "load=100 N", "-o", "a.yaml"]) == 2
    assert "exists already" in capsys.readouterr().err and Path("a.yaml").read_text() == "mine"


def test_a_name_is_text_whatever_it_looks_like() -> None:
    assert invoke(["new", "--yes", *WHEEL, "--axis", "load=100 N", "--name", "true: #1", "-o", "a.yaml"]) == 0
    assert invoke(["check", "a.yaml"]) == 0
