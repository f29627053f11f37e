"""`tester` alone: the commands that make sense in this folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.cli.main import invoke
from tester.cli.next_steps import next_steps
from tester.kinds import hardware_text
from tester.machine.commission.record import record_path
from tests.tester.cli.test_runs_command import open_run
from tests.tester.store.build import small_run

RECIPE = "recipe: mine\nspecimens: []\n"


def commands(here: Path) -> list[str]:
    return [step.command.removeprefix("tester ") for step in next_steps(here)]


def test_an_empty_folder_begins_with_the_quickstart(tmp_path: Path) -> None:
    assert commands(tmp_path) == ["run quickstart", "new", "rig init my-rig.yaml", "tui", "--help"]


def test_a_finished_run_is_shown_and_not_resumed(tmp_path: Path) -> None:
    small_run(tmp_path / "runs" / "one")
    assert commands(tmp_path)[:2] == ["show latest", "report latest"]
    assert not any(command.startswith("resume") for command in commands(tmp_path))


def test_an_interrupted_run_comes_first_with_its_kept_repeats(tmp_path: Path) -> None:
    small_run(tmp_path / "runs" / "one")
    open_run(tmp_path / "runs" / "two")
    step = next(next_steps(tmp_path))
    assert step == ("tester resume two", "resumes this run: interrupted, 2 repeats kept")


def test_a_run_that_is_under_way_is_left_alone(tmp_path: Path) -> None:
    folder = open_run(tmp_path / "runs" / "two")
    with ExclusiveUse() as use:
        use.lock_file("the run", folder / RUN_LOCK, "two", lasting=False)
        assert "resume two" not in commands(tmp_path)


def test_a_run_that_cannot_be_read_is_passed_over(tmp_path: Path) -> None:
    folder = tmp_path / "runs" / "broken"
    folder.mkdir(parents=True)
    (folder / "run.db").write_text("no database")
    assert commands(tmp_path)[0] == "show latest"


def test_a_recipe_of_this_folder_can_be_run(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(RECIPE)
    assert "run mine.yaml" in commands(tmp_path)


def test_a_rig_without_a_record_of_its_commissioning_is_commissioned(tmp_path: Path) -> None:
    (tmp_path / "my-rig.yaml").write_text(hardware_text(), encoding="utf-8")
    assert commands(tmp_path)[0] == "commission my-rig.yaml"
    assert "rig init my-rig.yaml" not in commands(tmp_path)


def test_a_rig_whose_commissioning_is_on_record_is_not(tmp_path: Path) -> None:
    text = "rig: Lab 3, wheel  # ours\nsimulated: false\n"
    (tmp_path / "my-rig.yaml").write_text(text, encoding="utf-8")
    path = record_path(tmp_path / "runs", "Lab 3, wheel")
    path.parent.mkdir(parents=True)
    path.write_text("")
    assert not any(command.startswith("commission") for command in commands(tmp_path))


def test_a_simulated_rig_needs_no_commissioning(tmp_path: Path) -> None:
    (tmp_path / "sim.yaml").write_text("rig: a\nsimulated: true   # as in the paper\n")
    assert not any(command.startswith("commission") for command in commands(tmp_path))


def test_every_step_is_a_line_with_the_command_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[0] for line in lines] == [f"tester {command}" for command in commands(tmp_path)]
