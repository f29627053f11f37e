"""Stages of a step: answers can be withdrawn, refusals repeat a part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pytest

from tester.machine.commission.commission_step import Dialogue, Notes, StepLeft, StepRefused, measure, press
from tester.machine.commission.stages import in_stages, judged, measured_twice
from tester.machine.prompts import BACK, Question


def nothing(text: str, values: Mapping[str, Any]) -> None:
    """Record nothing."""


def notes() -> Notes:
    return Notes(lambda text: None, nothing, {})


def answered(dialogue: Dialogue, answers: Sequence[str]) -> list[str]:
    """Answer the questions of a dialogue; return their keys."""
    keys: list[str] = []
    given = iter(answers)
    try:
        awaited = next(dialogue)
        while True:
            assert isinstance(awaited, Question)
            keys.append(awaited.key)
            answer = next(given)
            assert awaited.refusal(answer) == ""
            awaited = dialogue.send(answer)
    except StopIteration:
        return keys


class Two:
    """A step of two questions."""

    def __init__(self) -> None:
        self.found: dict[str, float] = {}

    def first(self) -> Dialogue:
        self.found["first"] = yield from measure("first", "how far?", "mm")

    def second(self) -> Dialogue:
        self.found["second"] = yield from measure("second", "how far?", "mm")

    def judge(self) -> None:
        if self.found["first"] > 5.0:
            raise StepRefused("too far")


def test_every_answer_can_be_taken_back_also_the_last() -> None:
    step = Two()
    keys = answered(in_stages(notes(), step.first, step.second), ["1", BACK, "2", "3", BACK, "4", "yes"])
    assert keys == ["first", "second", "first", "second", "keep", "second", "keep"]
    assert step.found == {"first": 2.0, "second": 4.0}


def test_the_first_question_has_nothing_to_take_back() -> None:
    asked = next(in_stages(notes(), Two().first))
    assert isinstance(asked, Question) and asked.refusal(BACK) != ""


def test_a_refusal_repeats_its_part_and_not_the_step() -> None:
    step = Two()
    stages = (step.second, step.first, judged(step.first, step.judge))
    assert answered(in_stages(notes(), *stages), ["1", "9", "again", "2", "yes"]) == [
        "second", "first", "again", "first", "keep",
    ]  # fmt: skip


def test_a_person_who_leaves_keeps_the_refusal() -> None:
    step = Two()
    with pytest.raises(StepRefused, match="too far"):
        answered(in_stages(notes(), step.first, judged(step.first, step.judge)), ["9", "leave"])


def test_a_key_that_is_answered_with_no_leaves_the_step_at_once() -> None:
    step = Two()
    with pytest.raises(StepLeft):
        answered(in_stages(notes(), step.first, lambda: press("go", "it moves")), ["1", "no"])


def test_an_implausible_value_is_asked_for_once_more_before_anything_follows() -> None:
    dialogue = measured_twice("way", "how far?", "mm", lambda value: "too far" if value > 5.0 else "")
    keys: list[str] = []
    awaited = next(dialogue)
    with pytest.raises(StopIteration) as ended:
        for answer in ("50", "5"):
            assert isinstance(awaited, Question)
            keys.append(awaited.key)
            awaited = dialogue.send(answer)
    assert keys == ["way", "once more way"] and ended.value.value == 5.0
