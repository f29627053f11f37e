"""Questions to the person who commissions a rig, and the interface that represents the person.

A terminal, a screen and a test's person are the same to the engine: it asks a question, and checks for an answer
between ticks. A question never blocks a scan.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Protocol

from tester.base.units import UnitError, parse, units_like


class Asks(Enum):
    """The kind of answer that a question needs."""

    CHOICE = "choice"
    """One of ``Question.choices``."""
    QUANTITY = "quantity"
    """A number in ``Question.unit``, or with a unit of the same kind."""
    TEXT = "text"
    """A line of text."""
    KEY = "key"
    """The word GO: it starts a short motion."""


GO = "go"
"""The word that starts a motion."""


@dataclass(frozen=True, slots=True)
class Question:
    """One question. ``key``: its name, the same in every commissioning; ``text``: for the person."""

    key: str
    text: str
    asks: Asks
    choices: tuple[str, ...] = ()
    unit: str = ""

    def refusal(self, answer: str) -> str:
        """Return why a text is not a valid answer, "" if it is."""
        text = answer.strip()
        if self.asks is Asks.CHOICE:
            return "" if text in self.choices else f"expected one of: {', '.join(self.choices)}"
        if self.asks is Asks.KEY:
            return "" if text in (GO, "no") else f'expected "{GO}", or "no" to leave this step'
        if self.asks is Asks.QUANTITY:
            try:
                self.value(text)
            except UnitError as error:
                return str(error)
        return "" if text else "expected a text"

    def value(self, answer: str) -> float:
        """Return a quantity in ``unit``; a bare number counts as in that unit. Raises UnitError."""
        text = answer.strip()
        try:
            bare = float(text)
        except ValueError:
            return parse(text, self.unit)
        if not isfinite(bare):
            raise UnitError(f"{text} is not a number (expected one in {self.unit})")
        return bare

    @property
    def hint(self) -> str:
        """The valid answers, in words."""
        if self.asks is Asks.CHOICE:
            return " / ".join(self.choices)
        if self.asks is Asks.KEY:
            return f"{GO} / no"
        if self.asks is Asks.QUANTITY:
            return f"a number in {self.unit}, or with a unit ({', '.join(units_like(self.unit))})"
        return "a line of text"


class Person(Protocol):
    """The person who commissions: a front of the engine."""

    @property
    def time_stands(self) -> bool:
        """Whether a simulated rig's time stops while this person thinks; a scripted person takes rig time."""
        ...

    def tell(self, text: str) -> None:
        """Show a message."""
        ...

    def put(self, question: Question) -> None:
        """Ask a question; the one before is answered or withdrawn."""
        ...

    def taken(self, now_s: float) -> str | None:
        """Return the answer, None without one; ``now_s``: rig time, s, infinity if no rig runs."""
        ...

    def poll(self) -> list[str]:
        """Return the commands typed since the last call (tester.base.keys): "stop", "fast stop"."""
        ...


class StepRefused(Exception):  # noqa: N818 - a finding for a person
    """A step does not pass: the finding and the remedy, for people and for the record."""


@dataclass(frozen=True, slots=True)
class AskPerson:
    """Wait for a valid answer."""

    question: Question


Until = Callable[[float], bool]
"""Wait for a condition: called once a tick with rig time, s."""
Waits = AskPerson | Until
Dialogue = Generator[Waits, str, None]
Measured = Generator[Waits, str, float]


def choose(key: str, text: str, *choices: str) -> Generator[Waits, str, str]:
    """Ask for one of several words."""
    return (yield AskPerson(Question(key, text, Asks.CHOICE, choices))).strip()


def measure(key: str, text: str, unit: str) -> Measured:
    """Ask for a quantity; return it in ``unit``."""
    question = Question(key, text, Asks.QUANTITY, unit=unit)
    return question.value((yield AskPerson(question)))


def line(key: str, text: str) -> Generator[Waits, str, str]:
    """Ask for a line of text."""
    return (yield AskPerson(Question(key, text, Asks.TEXT))).strip()


def press(key: str, text: str) -> Dialogue:
    """Ask for the word that starts a motion; raises StepRefused for "no"."""
    answer = (yield AskPerson(Question(key, text, Asks.KEY))).strip()
    if answer != GO:
        raise StepRefused(f"left by the person at: {text}")


def wait(seconds: float) -> Dialogue:
    """Let rig time pass, s."""
    until_s: list[float] = []

    def over(now_s: float) -> bool:
        if not until_s:
            until_s.append(now_s + seconds)
        return now_s >= until_s[0] - 1e-9

    yield over
