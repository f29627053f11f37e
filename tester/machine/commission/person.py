"""Questions to the person who commissions a rig, and the one interface behind which that person is.

A terminal, a screen and the person of a test are the same to the engine: a question is put, and looked for an answer
between ticks. Nobody blocks a scan.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Protocol

from tester.base.units import UnitError, parse, units_like


class Asks(Enum):
    """What kind of answer a question wants."""

    CHOICE = "choice"
    """One of ``Question.choices``."""
    QUANTITY = "quantity"
    """A number in ``Question.unit``, or with a unit of the same kind."""
    TEXT = "text"
    """A line of text."""
    KEY = "key"
    """The word GO: something moves for a short time because of it."""


GO = "go"
"""The word that makes something move."""


@dataclass(frozen=True, slots=True)
class Question:
    """One question. ``key``: its name, the same in every commissioning; ``text``: as a person reads it."""

    key: str
    text: str
    asks: Asks
    choices: tuple[str, ...] = ()
    unit: str = ""

    def refusal(self, answer: str) -> str:
        """Return why a text is no answer, "" where it is one."""
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
        """Return a quantity in ``unit``; a bare number counts in it. Raises UnitError."""
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
        """What may be answered, in words."""
        if self.asks is Asks.CHOICE:
            return " / ".join(self.choices)
        if self.asks is Asks.KEY:
            return f"{GO} / no"
        if self.asks is Asks.QUANTITY:
            return f"a number in {self.unit}, or with a unit ({', '.join(units_like(self.unit))})"
        return "a line of text"


class Person(Protocol):
    """Whoever commissions: a front of the engine."""

    @property
    def time_stands(self) -> bool:
        """A simulated rig's time stands still while this person thinks; a scripted person takes rig time."""
        ...

    def tell(self, text: str) -> None:
        """Say something."""
        ...

    def put(self, question: Question) -> None:
        """Put a question; the one before is answered or withdrawn."""
        ...

    def taken(self, now_s: float) -> str | None:
        """Return the answer, None while there is none; ``now_s``: rig time, s, infinity where no rig runs."""
        ...

    def poll(self) -> list[str]:
        """Look at the keyboard; return the commands (tester.base.keys) that were given: "stop", "fast stop"."""
        ...


class StepRefused(Exception):  # noqa: N818 - a finding, said to a person
    """A step does not pass: what was found, and what to do about it; for people and for the record."""


@dataclass(frozen=True, slots=True)
class AskPerson:
    """Wait for an answer that fits."""

    question: Question


Until = Callable[[float], bool]
"""Wait until something is so: called once a tick with rig time, s."""
Waits = AskPerson | Until
Dialogue = Generator[Waits, str, None]
Measured = Generator[Waits, str, float]


def choose(key: str, text: str, *choices: str) -> Generator[Waits, str, str]:
    """Ask for one of some words."""
    return (yield AskPerson(Question(key, text, Asks.CHOICE, choices))).strip()


def measure(key: str, text: str, unit: str) -> Measured:
    """Ask for a quantity; return it in ``unit``."""
    question = Question(key, text, Asks.QUANTITY, unit=unit)
    return question.value((yield AskPerson(question)))


def line(key: str, text: str) -> Generator[Waits, str, str]:
    """Ask for a line of text."""
    return (yield AskPerson(Question(key, text, Asks.TEXT))).strip()


def press(key: str, text: str) -> Dialogue:
    """Ask for the word that makes something move; raises StepRefused for "no"."""
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
