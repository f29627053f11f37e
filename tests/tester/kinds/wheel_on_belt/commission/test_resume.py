"""A killed commissioning resumes where it stopped; a changed rig file undoes the steps that depend on it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.commission_step import sections_sha256
from tester.machine.commission.record import DONE
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Question
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named

STEPS = named("identify", "jog belt", "jog press")
SHORT = named("jog belt")


class Killed(BaseException):
    """The process is gone."""


class Mortal(TwinPerson):
    """Kills the process at a question."""

    def __init__(self, at: int) -> None:
        super().__init__()
        self.left = at

    def put(self, question: Question) -> None:
        super().put(question)
        self.left -= 1
        if self.left == 0:
            raise Killed


def results(bench: Bench) -> list[tuple[str, str, dict[str, object]]]:
    return [(one.step, one.text, dict(one.values)) for one in bench.record.entries if one.what == DONE]


def test_killed_at_every_question_it_ends_with_the_same_results(tmp_path: Path) -> None:
    whole = Bench(tmp_path / "whole.jsonl", steps=SHORT)
    assert whole.run().ended is Ended.DONE
    for at in range(2, len(whole.person.asked) + 1, 4):
        path = tmp_path / f"{at}.jsonl"
        with pytest.raises(Killed):
            Bench(path, steps=SHORT, person=Mortal(at)).run()
        again = Bench(path, steps=SHORT)
        assert again.run().ended is Ended.DONE
        assert results(again) == results(whole), at


def test_nothing_moves_after_a_restart_before_a_person_agrees(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    with pytest.raises(Killed):
        Bench(path, steps=STEPS, person=Mortal(8)).run()

    class Leaves(TwinPerson):
        def answer(self, question: Question) -> str:
            return "no"

    again = Bench(path, steps=STEPS, person=Leaves())
    assert again.run().ended is Ended.LEFT
    assert again.world is None  # not even connected
    assert any("was cut off" in said for said in again.said)


def test_a_change_of_the_rig_file_undoes_the_steps_that_depend_on_it_and_no_others(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    assert Bench(path, steps=STEPS).run().ended is Ended.DONE
    changed = believed("axes.belt.home_timeout=61 s")
    stands = {step.name: sections_sha256(changed, step.sections) for step in STEPS}
    record = Bench(path, steps=STEPS, rig=changed)
    record.run()
    done = [one.step for one in record.record.entries if one.what == DONE]
    assert done == ["identify", "jog belt", "jog press", "identify", "jog belt"]
    assert record.record.standing("jog press", stands["jog press"]) is not None


def test_stop_ends_a_step_and_begins_no_other(tmp_path: Path) -> None:
    class Stops(TwinPerson):
        def commands(self) -> list[str]:
            return ["stop"] if len(self.asked) > 5 else []

    bench = Bench(tmp_path / "r.jsonl", steps=STEPS, person=Stops())
    outcome = bench.run()
    assert outcome.ended is Ended.STOPPED
    assert bench.world is not None and not any(drive.energised for drive in bench.world.axes.values())
