"""The check of an item: its findings and later changes, in words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.queue.assess import AssessTask, assess
from tester.queue.decide import ALARMS, COOL, FREE, GUARD, NEEDED, RECIPE, RIG, STANDSTILL
from tester.queue.differences import differences
from tester.queue.items import Hashes
from tester.queue.places import run_recipe
from tests.tester.kinds.wheel_on_belt.bench import SHORT

OWNERS = {STANDSTILL, ALARMS, GUARD, COOL}
"""Evidence that only the owner of the rig has."""


@pytest.fixture
def task(tmp_path: Path) -> AssessTask:
    return AssessTask(str(tmp_path / "item"), str(tmp_path / "runs"), "sim", text=SHORT)


def test_a_valid_recipe_gives_needs_hashes_and_all_evidence_without_the_rig(task: AssessTask) -> None:
    found = assess(task)
    assert (found.problems, found.name, found.needs.conditions) == ((), "short", 1)
    assert found.needs.low_s < found.needs.seconds < found.needs.high_s
    assert {check.name for check in found.checks} == set(NEEDED) - OWNERS
    assert all(check.ok for check in found.checks)
    assert run_recipe(Path(task.folder)).read_text(encoding="utf-8") == SHORT


def test_questions_come_with_their_times_unless_they_are_answered(task: AssessTask) -> None:
    assert [ask.at_s for ask in assess(task).needs.asks] == [0.0]
    assert assess(replace(task, yes=True)).needs.asks == ()


def test_at_60_times_the_item_takes_a_sixtieth(task: AssessTask) -> None:
    assert assess(replace(task, speed=60.0)).needs.seconds == pytest.approx(assess(task).needs.seconds / 60.0)


def test_nothing_differs_on_the_same_rig(task: AssessTask) -> None:
    first = assess(task)
    again = assess(replace(task, text=first.text, then=first.hashes, known_rig=first.rig))
    assert (again.differs, again.hashes) == ((), first.hashes)


def test_a_changed_rig_is_named_with_its_keys(task: AssessTask) -> None:
    first = assess(task)
    again = assess(replace(task, then=first.hashes, known_rig=first.rig, overrides=("sim.noise=0.5",)))
    assert len(again.differs) == 1 and "sim.noise: 0.5, was 1" in again.differs[0]
    assert next(check for check in again.checks if check.name == RECIPE).ok is False


def test_another_rig_is_no_evidence(task: AssessTask) -> None:
    found = assess(replace(task, then=assess(task).hashes, known_rig="the other rig"))
    check = next(check for check in found.checks if check.name == RIG)
    assert check.ok is False and "the other rig" in check.text


def test_every_problem_comes_at_once(task: AssessTask) -> None:
    found = assess(replace(task, text=SHORT.replace("200 N", "9 kN").replace("14 rev", "14 apples")))
    assert len(found.problems) >= 2 and found.checks == ()


def test_a_recipe_that_is_not_there_is_a_problem(task: AssessTask) -> None:
    assert "no-such" in assess(replace(task, text="", origin="no-such")).problems[0]


def test_a_frozen_recipe_runs_although_its_file_is_gone(task: AssessTask, tmp_path: Path) -> None:
    file = tmp_path / "r.yaml"
    file.write_text(SHORT, encoding="utf-8")
    first = assess(replace(task, text="", origin=str(file)))
    file.unlink()
    again = assess(replace(task, text=first.text, origin=first.origin, then=first.hashes, known_rig=first.rig))
    assert (again.problems, again.differs) == ((), ())


def test_materials_that_change_come_and_go_are_named() -> None:
    then = Hashes("a", "b", (("compound 1#", "x"), ("compound 2#", "x"), ("surface belt", ""), ("surface old", "")))
    now = Hashes("a", "c", (("compound 1#", "y"), ("compound 2#", ""), ("surface belt", "z")))
    assert differences(then, now, "", "") == [
        "the calibration changed",
        "the file of compound 1# changed",
        "the file of compound 2# is gone",
        "a file now describes surface belt",
        "surface old is not used any more",
    ]


def test_a_disk_with_too_little_room_is_no_evidence(task: AssessTask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.store.disk.free_bytes", lambda _folder: 1000)
    failed = [check for check in assess(task).checks if not check.ok]
    assert [check.name for check in failed] == ["disk"] and "asked for" in failed[0].text


def test_a_rig_that_another_process_uses_is_no_evidence(task: AssessTask, monkeypatch: pytest.MonkeyPatch) -> None:
    from tester.run.endings import CannotStartError

    def held(*_: object) -> None:
        raise CannotStartError("can can0 is in use: process 7")

    monkeypatch.setattr("tester.queue.assess.hold_rig", held)
    failed = [check for check in assess(task).checks if not check.ok]
    assert [(check.name, check.text) for check in failed] == [(FREE, "can can0 is in use: process 7")]
