"""A fact is one statement of an output: its subject, quantity, value, and number of digits.

A number is kept with half a unit of its last digit. Two outputs agree where a value exists that both round to.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from math import floor, isfinite, log10

Subject = tuple[str | int, ...]
"""The subject of a fact: ("run", name), ("condition", name, 3), ("row", name, 2), ("repeat", name, 3, 1)."""
Value = float | str | frozenset[str] | None
"""A number, a text, a set of words; None where the output prints a dash or leaves the cell empty."""

_NUMBER = re.compile(r"[+\-−]?(\d+)(?:\.(\d+))?(?:e([+-]?\d+))?")
_DASHES = frozenset({"", "-", "–", "—", "nan"})
_MARKS = "!?"


@dataclass(frozen=True, slots=True)
class Fact:
    """A statement of ``output``. ``half``: half a unit of the last digit, 0 for counts and texts."""

    subject: Subject
    quantity: str
    value: Value
    half: float
    output: str

    def __str__(self) -> str:
        """Return the statement as readable text."""
        shown = ", ".join(sorted(self.value)) or "none" if isinstance(self.value, frozenset) else self.value
        return f"{self.output}: {shown}"


@dataclass
class Facts:
    """The facts of one output, collected while it is read."""

    output: str
    collected: list[Fact] = field(default_factory=list[Fact])
    strange: list[str] = field(default_factory=list[str])
    """What the reader could not interpret: a line without a place, a row without a condition."""

    def add(self, subject: Subject, quantity: str, value: Value, half: float = 0.0) -> None:
        """Add a statement."""
        self.collected.append(Fact(subject, quantity, value, half, self.output))

    def count(self, subject: Subject, quantity: str, value: str | int) -> None:
        """Add a count, which is exact."""
        self.add(subject, quantity, float(value))

    def number(self, subject: Subject, quantity: str, cell: str, significant: int = 0) -> None:
        """Add a number as printed. ``significant``: digits, if trailing zeros are not printed."""
        if is_dash(cell):
            self.add(subject, quantity, None)
            return
        parsed = printed(cell, significant)
        if parsed is None:
            self.add(subject, quantity, cell.strip())
        else:
            self.add(subject, quantity, *parsed)

    def words(self, subject: Subject, quantity: str, words: Iterable[str]) -> None:
        """Add a set of words, such as flags."""
        self.add(subject, quantity, frozenset(word.strip() for word in words if word.strip()))


def is_dash(cell: str) -> bool:
    """Return whether a cell means "no value"."""
    return cell.strip().strip(_MARKS).strip().lower() in _DASHES


def marks_of(cell: str) -> str:
    """Return the mark behind a number: "", ``?`` or ``!``."""
    text = cell.strip()
    return text[-1] if text and text[-1] in _MARKS else ""


def printed(cell: str, significant: int = 0) -> tuple[float, float] | None:
    """Return a printed number and half a unit of its last digit; None if the cell is not a number.

    A unit or a per cent sign may follow. With ``significant`` digits (C's %g) missing trailing zeros count; a negative
    count means that the number is exact.
    """
    text = cell.replace("\u00a0", " ").replace("−", "-").strip().rstrip(_MARKS)
    match = _NUMBER.match(text)
    if match is None or not _is_unit(text[match.end() :]):
        return None
    value = float(match.group())
    exponent = int(match.group(3) or 0)
    half = 0.5 * 10.0 ** (exponent - len(match.group(2) or ""))
    if significant < 0:
        half = 0.0
    elif significant and value:
        half = 0.5 * 10.0 ** (floor(log10(abs(value))) + 1 - significant)
    elif significant:
        half = 0.0
    return (value, half) if isfinite(value) else None


def _is_unit(rest: str) -> bool:
    return not rest or re.fullmatch(r" ?[A-Za-z°%]\S{0,11}", rest) is not None


def seconds_of(text: str) -> float | None:
    """Return a duration printed as h:mm:ss or m:ss, in s; None for another text."""
    parts = text.strip().lstrip("~").split(":")
    if len(parts) not in (2, 3) or not all(part.isdigit() for part in parts):
        return None
    total = 0
    for part in parts:
        total = 60 * total + int(part)
    return float(total)
