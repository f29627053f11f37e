"""A figure, table, equation or statement of a paper, and its comparison with this program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

ROUNDING: Final = 1e-9


class PaperVerdict(StrEnum):
    """Result of comparing an item of a paper with data, formulas or laws."""

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

    ``where``: its place in the paper. ``states``: its content. ``command``: a command that shows the same in full, ""
    where only the list does. ``work_out`` returns the verdict from numbers computed by the call.
    """

    where: str
    states: str
    command: str
    work_out: Callable[[], PaperFinding]


@dataclass(frozen=True, slots=True)
class Paper:
    """A paper: its short name, its citation, and its items in the order of its pages."""

    name: str
    citation: str
    items: tuple[PaperItem, ...]


def slight(off: float) -> str:
    """Return a small difference in words: below 1e-9 it is due to rounding, which differs from computer to computer."""
    return f"{off:.0e}" if abs(off) >= ROUNDING else f"less than {ROUNDING:.0e}"


def judged(holds: bool, error: str) -> PaperFinding:
    """Return the finding "reproduced", or "refuted" where the item does not hold."""
    return PaperFinding(PaperVerdict.REPRODUCED if holds else PaperVerdict.REFUTED, error)


def unjudged(reason: str) -> PaperFinding:
    """Return the finding of an item that cannot be judged, with the numbers or the reason."""
    return PaperFinding(PaperVerdict.NOT_ATTEMPTED, reason)


def not_attempted(where: str, states: str, reason: str) -> PaperItem:
    """Return an item that is not attempted, with the reason."""
    return PaperItem(where, states, "", lambda: unjudged(reason))
