"""Questions to a person. In a run the drives are off while a question waits; commissioning also asks questions.

A terminal, a screen, the service and a test's person answer the same ``Prompt``. A question never blocks a scan.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from math import inf, isfinite
from typing import Final

from tester.base.units import SCALES, UnitError, parse, units_like

DONE, NOT_YET = "yes", "no"
"""The exact words that answer a run's question; after the second the question keeps waiting."""
AUTOMATIC: Final = " (automatic)"
"""Ends the answer that a question gave itself."""
GO: Final = "go"
"""The word that starts a motion."""
BACK: Final = "back"
"""The word that takes the previous answer back."""


class Asks(Enum):
    """The kind of answer that a question needs."""

    CHOICE = "choice"
    """One of ``Question.choices``."""
    QUANTITY = "quantity"
    """A number in ``Question.unit``, or with a unit of the same kind; or one of ``Question.choices``."""
    TEXT = "text"
    """A line of text."""
    KEY = "key"
    """The word GO, which starts a short motion."""


@dataclass(frozen=True, slots=True)
class Question:
    """One question. ``key``: its name, the same in every commissioning; ``text``: the words for the person."""

    key: str
    text: str
    asks: Asks
    choices: tuple[str, ...] = ()
    unit: str = ""
    back: bool = False
    """Whether BACK is a valid answer, too."""

    def refusal(self, answer: str) -> str:
        """Return why a text is not a valid answer; "" if it is valid."""
        text = answer.strip()
        if self.back and text == BACK:
            return ""
        if self.asks is Asks.CHOICE:
            return "" if text in self.choices else f"expected one of: {', '.join(self.choices)}"
        if self.asks is Asks.KEY:
            return "" if text in (GO, "no") else f'expected "{GO}", or "no" to leave this step'
        if self.asks is Asks.QUANTITY:
            if text in self.choices:
                return ""
            try:
                self.value(text)
            except UnitError as error:
                return str(error)
        return "" if text else "expected a text"

    def value(self, answer: str) -> float:
        """Return the quantity in ``unit``; a bare number counts as in that unit. Raises UnitError, also beyond a scale.
        """
        text = answer.strip()
        try:
            found = float(text)
        except ValueError:
            found = parse(text, self.unit)
        if not isfinite(found):
            raise UnitError(f"{text} is not a number (expected one in {self.unit})")
        least, most = SCALES.get(self.unit, (-inf, inf))
        if not least <= found <= most:
            raise UnitError(f"{text} is beyond the scale (expected {least:g} to {most:g} {self.unit})")
        return found

    @property
    def hint(self) -> str:
        """The valid answers, in words."""
        return f"{self._hint}; {BACK}: the answer before" if self.back else self._hint

    @property
    def _hint(self) -> str:
        if self.asks is Asks.CHOICE:
            return " / ".join(self.choices)
        if self.asks is Asks.KEY:
            return f"{GO} / no"
        if self.asks is Asks.QUANTITY:
            return f"a number in {self.unit}, or with a unit ({', '.join(units_like(self.unit))})"
        return "a line of text"


@dataclass(slots=True)
class Prompt:
    """One asked question; ``answer`` is None while it waits."""

    number: int
    at_s: float
    question: Question
    answer: str | None = None
    by: str = ""
    """Name of the person who answered; "" if unknown."""

    @property
    def text(self) -> str:
        """The question, for the person."""
        return self.question.text

    @property
    def by_itself(self) -> bool:
        """Whether no person has answered."""
        return (self.answer or "").endswith(AUTOMATIC)

    @property
    def quantity(self) -> float | None:
        """The quantity in the answer, in the question's unit; None for any other answer, or none."""
        answer = (self.answer or "").removesuffix(AUTOMATIC)
        if self.question.asks is not Asks.QUANTITY or not answer or answer in self.question.choices:
            return None
        return self.question.value(answer)

    def reply(self, text: str) -> str:
        """Accept an answer; return why it is refused, "" if it is valid."""
        refusal = self.question.refusal(text)
        if not refusal:
            self.answer = text.strip()
        return refusal


@dataclass(slots=True)
class Prompts:
    """The prompts of a run, oldest first. ``automatic``: answer "yes" at once (``--yes``).

    ``real``: whether the rig is real. There only a person can answer a prompt that asks to come near the machine.
    """

    automatic: bool = False
    real: bool = False
    asked: list[Prompt] = field(default_factory=list[Prompt])
    person: str = ""
    """Name of the person at the terminal, who gives every answer that comes from no other screen; "" if unknown."""
    now_s: float = inf
    """Rig time of a commissioning, s; infinity while no rig runs."""

    def answers_itself(self, *, near: bool) -> bool:
        """Return whether a prompt is answered automatically. ``near``: it asks a person to come near the machine."""
        return self.automatic and not (near and self.real)

    def ask(self, now: float, text: str, *, near: bool = True, unit: str = "", by_itself: str = DONE) -> Prompt:
        """Ask a run's question and return its prompt, which may already be answered.

        ``unit``: the answer is DONE, or a quantity in this unit; ``by_itself``: the answer without a person.
        """
        asks = Asks.QUANTITY if unit else Asks.CHOICE
        prompt = self._put(now, Question(f"prompt {len(self.asked) + 1}", text, asks, (DONE,), unit))
        if self.answers_itself(near=near):
            prompt.answer = f"{by_itself}{AUTOMATIC}"
        else:
            prompt.by = self.person
        return prompt

    def put(self, question: Question) -> Prompt:
        """Ask a question of a commissioning and return its prompt."""
        return self._put(self.now_s, question)

    def _put(self, at_s: float, question: Question) -> Prompt:
        prompt = Prompt(len(self.asked) + 1, at_s, question)
        self.asked.append(prompt)
        return prompt

    @property
    def waiting(self) -> Prompt | None:
        """The oldest unanswered prompt."""
        for prompt in self.asked:
            if prompt.answer is None:
                return prompt
        return None
