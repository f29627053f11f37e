"""A figure, table, equation or statement of a paper, and how it is held against this program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

ROUNDING: Final = 1e-9


class PaperVerdict(StrEnum):
    """What comes of holding an item of a paper against data, formulas or laws."""

    REPRODUCED = "reproduced"
    REFUTED = "refuted"
    NOT_ATTEMPTED = "not attempted"


@dataclass(frozen=True, slots=True)
class PaperFinding:
    """A verdict, and the error or the reason in words."""

    verdict: PaperVerdict
    error: str


@dataclass(frozen=True, slots=True)
class PaperItem:
    """An item of a paper.

    ``where``: its place in the paper. ``states``: what it prints or states. ``command``: shows the same in full, ""
    where only the list does. ``work_out`` returns the verdict from numbers that it makes at that moment.
    """

    where: str
    states: str
    command: str
    work_out: Callable[[], PaperFinding]


@dataclass(frozen=True, slots=True)
class Paper:
    """A paper: what it is called here, its citation, and its items in the order of its pages."""

    name: str
    citation: str
    items: tuple[PaperItem, ...]


def slight(off: float) -> str:
    """Return a small difference in words: below 1e-9 it is one of rounding, which differs from computer to computer."""
    return f"{off:.0e}" if abs(off) >= ROUNDING else f"less than {ROUNDING:.0e}"


def judged(holds: bool, error: str) -> PaperFinding:
    """Return that an item is reproduced, or refuted where it does not hold."""
    return PaperFinding(PaperVerdict.REPRODUCED if holds else PaperVerdict.REFUTED, error)


def unjudged(reason: str) -> PaperFinding:
    """Return that an item cannot be judged, with the numbers or the reason."""
    return PaperFinding(PaperVerdict.NOT_ATTEMPTED, reason)


def not_attempted(where: str, states: str, reason: str) -> PaperItem:
    """Return an item that is not attempted, with the reason."""
    return PaperItem(where, states, "", lambda: unjudged(reason))
