"""A commissioning killed in any step, at a question or in motion, resumes with the same results.

The kill is a crash: a process of its own ends without another instruction, wires, record and locks as they are. Then
the same command is given again. Each step begins from the record of the steps before it, done without a kill;
the killed step must end with the same result as without a kill.

All kills, some minutes of CPU: ``pytest -m campaign tests/tester/kinds/wheel_on_belt/commission/test_kills.py``.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from pathlib import Path
from typing import Any

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.record import BEGUN, DONE, CommissionRecord, record_path
from tester.machine.commission.step_engine import CommissionOutcome, Ended
from tester.machine.prompts import Question
from tester.run.commissioning import CommissionOptions, commission
from tester.run.kind_lookup import load_rig

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a process that is forked is POSIX")

NAMES = [step.name for step in STEPS]
QUICK = NAMES[: NAMES.index("directions")]
KILLED = 41
"""Exit code of a process that was killed."""
SHARES = (0.05, 0.3, 0.6, 0.95)
"""Share of a step's rig time at which it is killed in motion."""


@dataclass(frozen=True, slots=True)
class Kill:
    """When a process ends: at the ``question``th question of a step, or ``at_s`` of its rig time."""

    step: str
    question: int = 0
    at_s: float = inf


class Mortal(TwinPerson):
    """Does steps up to one, and then leaves; counts the questions of each step."""

    def __init__(self, until: str, kill: Kill | None = None) -> None:
        super().__init__()
        self.until = NAMES.index(until)
        self.kill = kill
        self.step = ""
        self.questions: dict[str, int] = {}

    def put(self, question: Question) -> None:
        super().put(question)
        if question.key.startswith("begin "):
            self.step = question.key.removeprefix("begin ")
        else:
            self.questions[self.step] = self.questions.get(self.step, 0) + 1
        kill = self.kill
        if kill is not None and kill.step == self.step and self.questions.get(self.step, 0) == kill.question > 0:
            os._exit(KILLED)

    def answer(self, question: Question) -> str:
        if question.key.startswith("begin ") and NAMES.index(question.key.removeprefix("begin ")) > self.until:
            return "no"
        return super().answer(question)


def done(out: Path, person: Mortal) -> CommissionOutcome:
    """Give the command."""
    return commission(load_rig("sim", ()), CommissionOptions(out=out, operator="a test"), person)


def record_of(out: Path) -> CommissionRecord:
    """Read the record; raises where it is inconsistent."""
    return CommissionRecord(record_path(out, load_rig("sim", ()).name), str, "")


def killed(out: Path, kill: Kill) -> bool:
    """Give the command in a process that is killed; return whether the kill came before its end."""
    child = os.fork()
    if child == 0:
        try:
            person = Mortal(kill.step, kill)
            advance = WheelRig.advance

            def mortal(world: WheelRig, now: float) -> None:
                advance(world, now)
                if person.step == kill.step and now >= kill.at_s:
                    os._exit(KILLED)

            WheelRig.advance = mortal  # type: ignore[method-assign]
            done(out, person)
        finally:
            os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == KILLED


@dataclass(frozen=True, slots=True)
class Whole:
    """A commissioning without a kill."""

    lines: list[bytes]
    questions: dict[str, int]

    def before(self, step: str, out: Path) -> None:
        """Leave the record as it was when a step began."""
        path = record_path(out, load_rig("sim", ()).name)
        path.parent.mkdir(parents=True)
        entries = [json.loads(line) for line in self.lines]
        begun = next(place for place, one in enumerate(entries) if one["step"] == step and one["what"] == BEGUN)
        path.write_bytes(b"".join(line + b"\n" for line in self.lines[:begun]))

    def values(self, step: str) -> dict[str, Any]:
        """Return the result of a step."""
        entries = [json.loads(line) for line in self.lines]
        return next(one["values"] for one in entries if one["step"] == step and one["what"] == DONE)

    def moments(self, step: str) -> list[Kill]:
        """Return all kills of a step."""
        rig_s = self.values(step)["rig_s"]
        questions = [Kill(step, question=number + 1) for number in range(self.questions.get(step, 0))]
        return [*questions, *(Kill(step, at_s=share * rig_s) for share in SHARES)]


def whole(out: Path, until: str) -> Whole:
    """Commission without a kill."""
    person = Mortal(until)
    outcome = done(out, person)
    assert outcome.ended in (Ended.DONE, Ended.LEFT), outcome
    lines = record_path(out, load_rig("sim", ()).name).read_bytes().splitlines()
    return Whole(lines, person.questions)


@pytest.fixture(scope="module")
def unkilled(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """The steps before the first recipe: recipes take longer than all of them."""
    return whole(tmp_path_factory.mktemp("whole"), QUICK[-1])


def same(found: Any, wanted: Any) -> bool:
    """Return whether two results are equal, apart from a run's name and time."""
    return {**found, "run": ""} == {**wanted, "run": ""}


def goes_on(out: Path, kill: Kill, one: Whole) -> None:
    """Kill, give the command again, and compare."""
    one.before(kill.step, out)
    before = len(record_of(out).entries)
    assert killed(out, kill), f"{kill}: came to its end"
    torn = record_of(out)
    assert torn.entries[before].what == BEGUN and torn.entries[before].step == kill.step
    assert not any(entry.what == DONE for entry in torn.entries[before:])
    outcome = done(out, Mortal(kill.step))
    assert outcome.ended in (Ended.DONE, Ended.LEFT), outcome
    record = record_of(out)
    last = record.last(kill.step)
    assert last is not None and last.what == DONE
    assert same(last.values, one.values(kill.step)), kill
    assert all(later.previous == earlier.sha256 for earlier, later in pairwise(record.entries))


@pytest.mark.parametrize("number", range(len(QUICK)), ids=QUICK)
def test_killed_in_a_step_it_resumes_with_the_same_result(tmp_path: Path, unkilled: Whole, number: int) -> None:
    kills = unkilled.moments(NAMES[number])
    goes_on(tmp_path, kills[-1 - number % 3] if number % 2 else kills[number % len(kills)], unkilled)


def test_after_a_kill_nothing_is_even_connected_before_a_person_agrees(tmp_path: Path, unkilled: Whole) -> None:
    unkilled.before("rolling", tmp_path)
    assert killed(tmp_path, Kill("rolling", at_s=20.0))
    person = Mortal("touch")
    said: list[str] = []
    person._say = said.append
    assert done(tmp_path, person).ended is Ended.LEFT
    assert person.hands is None
    assert any("was cut off" in text for text in said)


@pytest.mark.campaign
@pytest.mark.parametrize("number", range(len(NAMES)), ids=NAMES)
def test_killed_at_every_question_and_in_motion_it_resumes(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, number: int
) -> None:
    one = _entire(tmp_path_factory)
    for place, kill in enumerate(one.moments(NAMES[number])):
        goes_on(tmp_path / str(place), kill, one)


@pytest.mark.campaign
def test_killed_once_in_every_step_it_ends_with_the_same_coefficient(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    one = _entire(tmp_path_factory)
    for name in NAMES:
        assert killed(tmp_path, Kill(name, at_s=0.5 * one.values(name)["rig_s"])), name
    assert done(tmp_path, Mortal(NAMES[-1])).ended is Ended.DONE
    last = record_of(tmp_path).last("first")
    assert last is not None
    wanted, found = one.values("first")["conditions"][0], last.values["conditions"][0]
    assert abs(found["mu"] - wanted["mu"]) <= wanted["expanded"]
    assert sum(entry.what == BEGUN for entry in record_of(tmp_path).entries) == 2 * len(NAMES)


_ENTIRE: list[Whole] = []


def _entire(factory: pytest.TempPathFactory) -> Whole:
    """Return the complete commissioning, done once for all tests of this process."""
    if not _ENTIRE:
        _ENTIRE.append(whole(factory.mktemp("entire"), NAMES[-1]))
    return _ENTIRE[0]
