"""A step in stages: every answer can be taken back, and a mistake repeats a stage, not the step."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace
from typing import Final

from tester.machine.commission.commission_step import (
    Dialogue,
    Measured,
    Notes,
    StepLeft,
    StepRefused,
    Waits,
    choose,
    measure,
)
from tester.machine.prompts import BACK, Question

Stage = Callable[[], Dialogue]
"""A part of a step, which can be repeated: it sets what it measures anew each time."""
ONCE_MORE: Final = "once more "
"""Begin of the key of a question that is asked for the second time."""
KEEP, LEAVE, AGAIN = "yes", "leave", "again"


def in_stages(notes: Notes, *stages: Stage) -> Dialogue:
    """Carry out the stages in order; at the end ask whether to keep what was found.

    The answer BACK repeats the stage of the question before. What is refused can be measured again: from the stage that
    the refusal names, else from the last one that asked something. Raises StepRefused if the person leaves.
    """
    every = (*stages, lambda: _keep(notes))
    asked: list[int] = []
    number, returning = 0, False
    while number < len(stages) or (asked and number == len(stages)):
        before = max((one for one in asked if one < number), default=-1)
        try:
            questions, back = yield from _carried_out(every[number], number, asked, can_go_back=before >= 0)
        except StepLeft:
            raise
        except StepRefused as refused:
            if not asked:
                raise
            yield from _again(notes, refused)
            first = stages.index(refused.again) if refused.again in stages else number if number in asked else before
            number, returning = first, False
            continue
        if back or (returning and not questions and before >= 0):
            returning = True
            number = number if questions > 1 else before
        else:
            returning = False
            number += 1


def judged(first: Stage, judge: Callable[[], None]) -> Stage:
    """Return a stage that judges what the stages from ``first`` on have measured; a refusal repeats these."""

    def stage() -> Dialogue:
        try:
            judge()
        except StepRefused as refused:
            refused.again = first
            raise
        yield from ()

    return stage


def _carried_out(
    stage: Stage, number: int, asked: list[int], *, can_go_back: bool
) -> Generator[Waits, str, tuple[int, bool]]:
    """Carry out a stage; return how many questions it asked, and whether the last answer was BACK."""
    dialogue, answer, questions = stage(), "", 0
    try:
        awaited = next(dialogue)
        while True:
            if not isinstance(awaited, Question):
                answer = yield awaited
            else:
                questions += 1
                if number not in asked:
                    asked.append(number)
                answer = yield replace(awaited, back=can_go_back or questions > 1)
                if answer == BACK:
                    dialogue.close()
                    return questions, True
            awaited = dialogue.send(answer)
    except StopIteration:
        return questions, False


def _again(notes: Notes, refused: StepRefused) -> Dialogue:
    """Ask whether what was refused is to be measured again; raises the refusal otherwise."""
    notes.tell(f"not passed: {refused}")
    text = f"leave the step, or measure this part again? Not passed: {refused}"
    if (yield from choose("again", text, LEAVE, AGAIN)) != AGAIN:
        raise refused


def _keep(notes: Notes) -> Dialogue:
    found = f": {notes.text}" if notes.text else ""
    yield from choose("keep", f"record this step{found}?", KEEP)


def measured_twice(key: str, text: str, unit: str, refused: Callable[[float], str]) -> Measured:
    """Ask for a quantity; one that is refused is asked for once more, with the reason, before anything follows from it.

    Return the answer that counts; ``refused`` returns why it is not plausible, "" if it is.
    """
    value = yield from measure(key, text, unit)
    why = refused(value)
    if why:
        value = yield from measure(f"{ONCE_MORE}{key}", f"{value:g} {unit} was typed: {why}. Once more: {text}", unit)
    return value
