"""A recipe planned by a separate process."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.run.endings import CannotStartError
from tester.run.preconditions import prepared
from tester.service.planning import Task, planned
from tests.tester.kinds.wheel_on_belt.bench import SHORT


def test_it_equals_the_plan_of_this_process(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    task = Task(str(tmp_path / "short.yaml"), "sim", ("sim.noise=0",))
    polls = list[int]()

    def meanwhile() -> str:
        polls.append(1)
        return ""

    found, here = planned(task, meanwhile), prepared(task.recipe, task.rig, task.overrides)
    assert (found.work, found.expected) == (here.work, here.expected)
    assert len(polls) > 3
    assert all(
        one is other for one, other in zip(found.work.parts[0].plan.steps, found.work.plan.steps, strict=True)
    ), "a part's steps are the plan's own"


def test_mistakes_in_a_recipe_are_reported(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text("recipe: [")
    with pytest.raises(CannotStartError, match=r"bad\.yaml:2:1: not YAML"):
        planned(Task(str(tmp_path / "bad.yaml"), "sim"), lambda: "")


def test_it_is_cancelled_on_request(tmp_path: Path) -> None:
    with pytest.raises(CannotStartError, match="stopped by me"):
        planned(Task("table2", "sim"), lambda: "stopped by me")
