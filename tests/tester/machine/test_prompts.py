"""Answers to questions: --yes answers all, except where a person must approach a real machine."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.procedures.operator_access import AskAtRest
from tester.machine.prompts import Prompts
from tests.tester.kinds.wheel_on_belt.bench import make_bench


@pytest.mark.parametrize(
    ("automatic", "real", "near", "asked"),
    [
        (True, False, True, False),
        (True, True, True, True),
        (True, True, False, False),
        (False, False, True, True),
        (False, True, False, True),
    ],
)
def test_only_a_person_answers_questions_that_bring_a_person_near_a_real_rig(
    automatic: bool, real: bool, near: bool, asked: bool
) -> None:
    prompts = Prompts(automatic=automatic, real=real)
    prompt = prompts.ask(1.0, "install wheel 1", near=near)
    assert (prompt.answer is None) is asked
    assert (prompts.waiting is not None) is asked


def test_with_yes_a_wheel_at_a_real_rig_waits_for_a_person_with_the_guard_free_to_open() -> None:
    bench = make_bench()
    bench.ctx.prompts.real = True
    bench.until(AskAtRest("install wheel 1"), lambda: bench.ctx.prompts.waiting is not None)
    assert bench.ctx.demand.attended


@pytest.mark.parametrize(
    ("answer", "refused"),
    [("89.62 mm", False), ("89.62", False), ("0.08962 m", False), ("yes", False), ("no", True), ("3 N", True)],
)
def test_a_question_for_a_quantity_takes_one_in_its_unit_or_a_yes(answer: str, refused: bool) -> None:
    prompt = Prompts().ask(1.0, "measure the diameter", unit="mm")
    assert bool(prompt.reply(answer)) is refused and (prompt.answer is None) is refused


@pytest.mark.parametrize(
    ("answer", "found"), [("89.62 mm", 89.62), ("89", 89.0), ("0.08962 m", 89.62), ("yes", None)]
)
def test_the_quantity_in_an_answer(answer: str, found: float | None) -> None:
    prompt = Prompts().ask(1.0, "measure the diameter", unit="mm")
    assert prompt.quantity is None
    assert not prompt.reply(answer)
    assert prompt.quantity == (found if found is None else pytest.approx(found))


@pytest.mark.parametrize(("answer", "refused"), [("64.5", ""), ("100 Shore A", ""), ("645", "0 to"), ("-1", "0 to")])
def test_a_hardness_is_on_its_scale(answer: str, refused: str) -> None:
    refusal = Prompts().ask(1.0, "install wheel 1", unit="Shore A").reply(answer)
    assert refused in refusal and bool(refusal) is bool(refused)


def test_an_answer_without_a_person_may_be_a_quantity() -> None:
    prompts = Prompts(automatic=True, person="anna")
    prompt = prompts.ask(1.0, "install wheel 1", unit="Shore A", by_itself="64.2 Shore A")
    assert (prompt.answer, prompt.quantity, prompt.by) == ("64.2 Shore A (automatic)", 64.2, "")


def test_an_answer_is_the_person_s_at_the_terminal() -> None:
    assert Prompts(person="anna").ask(1.0, "install wheel 1").by == "anna"


def test_a_question_without_a_unit_takes_no_quantity() -> None:
    prompt = Prompts().ask(1.0, "install wheel 1")
    assert prompt.reply("89.62 mm") == "expected one of: yes" and prompt.answer is None
