"""A simulated person who commissions a simulated rig: the plant's true values replace ruler, weight, thermometer.

A kind's subclass knows its rig. It serves ``--yes``, tests and campaigns. Each answer takes rig time, as a person's
does.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any, Final

from tester.machine.commission.person import Person
from tester.machine.commission.stages import ONCE_MORE
from tester.machine.prompts import GO, Asks, Prompt, Prompts, Question

THINKS_S: Final = 15.0
"""Rig time for an answer that needs a reading or a hung weight, s [A]."""
KEY_S: Final = 2.0
"""Rig time from a question to a key, s [A]."""


class ScriptedPerson(Person):
    """Answers every question of the steps correctly, as a careful person at the machine would."""

    time_stands = False
    scripted = True

    def __init__(self, say: Callable[[str], None] = lambda text: None) -> None:
        """``say`` receives the messages to the person."""
        self.hands: Any = None
        """The simulated rig."""
        self.asked: list[Question] = []
        self._say = say
        self._prompt: Prompt | None = None
        self._from: dict[str, float] = {}
        """Position of each axis when its instrument was set to zero."""

    def at(self, hands: Any) -> None:
        self.hands = hands
        self._from.clear()

    def message(self, text: str) -> None:
        self._say(text)

    def attend(self, prompts: Prompts) -> None:
        prompt = prompts.waiting
        if prompt is None:
            return
        question = prompt.question
        if prompt is not self._prompt:
            self._prompt = prompt
            self.put(question)
            self.prepare(question)
        takes_s = THINKS_S if question.asks is Asks.QUANTITY else KEY_S
        if prompt.at_s == inf or prompts.now_s - prompt.at_s >= takes_s:
            prompt.reply(self.answer(question))

    def put(self, question: Question) -> None:
        """Receive a new question."""
        self.asked.append(question)

    def prepare(self, question: Question) -> None:
        """Do the question's task, if any, before the answer."""
        words = words_of(question)
        if words[0] == "jog" and (words[2] == "first" or words[2] == "mark"):
            self._from.setdefault(words[1], self.hands.ruler(words[1]))

    def answer(self, question: Question) -> str:
        """Return the answer."""
        words = words_of(question)
        if question.asks is Asks.KEY:
            return GO
        if words[0] == "jog":
            return self._jogged(question, words[1])
        if words[0] == "retype":
            return words[2]
        if question.asks is Asks.CHOICE:
            return question.choices[0]
        if question.asks is Asks.TEXT:
            return "weights of class M1, certificate 4711" if "certificate" in question.key else "2027-11-23"
        raise LookupError(f"this person has no answer to: {question.key}")

    def others_move(self) -> bool:
        """Return whether an axis has moved that is not the jogged one, which stands."""
        raise NotImplementedError

    def _jogged(self, question: Question, axis: str) -> str:
        moved = self.hands.ruler(axis) - self._from.get(axis, 0.0)
        if question.asks is Asks.QUANTITY:
            return f"{moved:.2f}"
        if "direction" in question.key:
            if abs(moved) < 1e-6:
                return "other" if self.others_move() else "nothing"
            return "yes" if moved > 0.0 else "reversed"
        self._from[axis] = self.hands.ruler(axis)  # the instrument is set to zero
        return question.choices[0]


def words_of(question: Question) -> list[str]:
    """Return the words of a question's key, without the mark of a repeated question."""
    return question.key.removeprefix(ONCE_MORE).split()
