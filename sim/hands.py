"""Hands at a simulated machine: what a person does there, as lines of text.

A machine lists its verbs (``sim.machines.SimulatedMachine.verbs``). Its console carries out a line; a run in another
process writes the same line (``tester.run.remote_hands``).
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, Final

from sim.noise import normal

DONE: Final = "done: "
REFUSED: Final = "not done: "
"""Beginnings of a console's answer to a verb."""
TEXT: Final = "text"
"""A word; quotes keep spaces in it."""
COUNT: Final = "count"
"""A whole number, 0 and up."""
FLAG: Final = "yes|no"
VALUES: Final = "name=number"
"""All further words, each a name and its number."""


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a verb. ``kind``: one of the above, allowed words separated by ``|``, or the unit of a number."""

    name: str
    kind: str

    @property
    def form(self) -> str:
        """Its form in a line, for people: a number is followed by its unit."""
        if self.kind in (TEXT, COUNT):
            return self.name.upper()
        if self.kind == VALUES:
            return "NAME=NUMBER..."
        return self.kind if "|" in self.kind else f"{self.name.upper()} {self.kind}"

    def words(self, value: Any) -> list[str]:
        """Return the words of a value."""
        if self.kind == VALUES:
            return [f"{name}={number!r}" for name, number in value.items()]
        if self.kind == FLAG:
            return ["yes" if value else "no"]
        if self.kind in (TEXT, COUNT) or "|" in self.kind:
            return [str(value)]
        return [repr(float(value)), self.kind]

    def read(self, words: list[str]) -> Any:
        """Take the argument's words from the front of ``words`` and return its value; raises ValueError."""
        if self.kind == VALUES:
            taken, words[:] = list(words), []
            return {name: _number(number, name) for name, _, number in (word.partition("=") for word in taken)}
        if not words:
            raise ValueError(f"{self.form} is missing")
        word = words.pop(0)
        if self.kind == TEXT:
            return word
        if self.kind == COUNT:
            if not (word.isascii() and word.isdigit()):
                raise ValueError(f"{self.form} is a whole number, not {word!r}")
            return int(word)
        if "|" in self.kind:
            if word not in self.kind.split("|"):
                raise ValueError(f"expected {self.kind}, not {word!r}")
            return word == "yes" if self.kind == FLAG else word
        number = word.removesuffix(self.kind)
        if number == word and (not words or words.pop(0) != self.kind):
            raise ValueError(f"expected {self.form}: a number in {self.kind}")
        return _number(number, self.form)


def _number(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise ValueError(f"{what}: {text!r} is not a number")
    return number


@dataclass(frozen=True, slots=True)
class Verb:
    """One thing that a person does: its word, the method of the simulated rig that does it, its arguments in order."""

    word: str
    method: str
    about: str
    arguments: tuple[Argument, ...] = ()

    @property
    def form(self) -> str:
        """The form of a line, for people."""
        return " ".join((self.word, *(argument.form for argument in self.arguments)))

    def line(self, *values: object) -> str:
        """Return the line for these values, in the order of the arguments."""
        pairs = zip(self.arguments, values, strict=True)
        return shlex.join([self.word, *(word for argument, value in pairs for word in argument.words(value))])

    def act(self, rig: object, words: Sequence[str]) -> None:
        """Do it at a rig; ``words`` follow the verb's. Raises ValueError with the reason, also the rig's own."""
        left = list(words)
        values = {argument.name: argument.read(left) for argument in self.arguments}
        if left:
            raise ValueError(f"{' '.join(left)!r} is too much; the form is {self.form!r}")
        getattr(rig, self.method)(**values)


DUROMETER_SHORE_A: Final = 1.5
"""Standard deviation of a hardness that a person reads by a pocket durometer, Shore A [A]."""


def durometer(seed: int, piece: int, shore_a: float) -> float:
    """Return a person's reading of a mounted piece whose true hardness is ``shore_a``: 0 to 100 Shore A."""
    return min(max(shore_a + DUROMETER_SHORE_A * normal(seed, "durometer", piece), 0.0), 100.0)


def by_word(verbs: Sequence[Verb]) -> Mapping[str, Verb]:
    """Return verbs by the first word of their lines."""
    return {verb.word: verb for verb in verbs}


REPEAT: Final = Verb(
    "repeat", "begin_repeat", "draw the scatter of a repeat; a run sends it, no person has to",
    (Argument("condition", COUNT), Argument("repeat", COUNT), Argument("attempt", COUNT)),
)  # fmt: skip
"""The start of a repeat, for kinds whose repeats have no further keys."""
SPECIMEN: Final = Verb(
    "specimen", "install", "put on a new specimen, by its number and rubber",
    (Argument("specimen", COUNT), Argument("compound", TEXT)),
)  # fmt: skip
