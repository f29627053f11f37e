"""A figure with its runs, its limit, and its verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from statistics import median
from typing import Literal


class Verdict(Enum):
    """The verdict on a figure."""

    SHOWN = ""
    HOLDS = "ok"
    MISSED = "MISSED"
    FAILED = "FAILED"
    UNAVAILABLE = "not available here"


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit: a bound on the median of the runs, or on the worst of them."""

    kind: Literal["at most", "at least"]
    value: float
    worst: bool = False

    def holds(self, figure: Figure) -> bool:
        """Return whether the figure keeps the bound; a missing number does not."""
        if self.kind == "at most":
            return (figure.greatest if self.worst else figure.median) <= self.value
        return (figure.least if self.worst else figure.median) >= self.value

    def __str__(self) -> str:
        sign = "<=" if self.kind == "at most" else ">="
        return f"{sign} {number(self.value)}{' always' if self.worst else ''}"


def at_most(value: float, *, worst: bool = False) -> Limit:
    """Limit the median (or the worst run) to at most ``value``."""
    return Limit("at most", value, worst)


def at_least(value: float, *, worst: bool = False) -> Limit:
    """Limit the median (or the worst run) to at least ``value``."""
    return Limit("at least", value, worst)


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the table: a value for each run. Without runs it is not available here, or ``failed``."""

    name: str
    unit: str
    runs: tuple[float, ...]
    limit: Limit | None = None
    note: str = ""
    failed: bool = False

    @property
    def median(self) -> float:
        """The median of the runs."""
        return median(self.runs)

    @property
    def least(self) -> float:
        """The smallest of the runs."""
        return min(self.runs)

    @property
    def greatest(self) -> float:
        """The greatest of the runs."""
        return max(self.runs)

    @property
    def verdict(self) -> Verdict:
        """Whether the figure keeps its limit."""
        if self.failed:
            return Verdict.FAILED
        if not self.runs:
            return Verdict.UNAVAILABLE
        if self.limit is None:
            return Verdict.SHOWN
        return Verdict.HOLDS if self.limit.holds(self) else Verdict.MISSED

    @property
    def missed(self) -> bool:
        """It misses its limit, or could not be measured although it should."""
        return self.verdict in (Verdict.MISSED, Verdict.FAILED)


def unavailable(name: str, unit: str, why: str) -> Figure:
    """Return the line of a figure that is unavailable on this machine or installation."""
    return Figure(name, unit, (), note=why)


def ratio(name: str, above: Sequence[float], below: Sequence[float], limit: Limit | None = None) -> Figure:
    """Return the ratio of two figures run by run: the effects of a busy machine on both cancel."""
    return Figure(name, "x", tuple(a / b for a, b in zip(above, below, strict=True)), limit)


def number(value: float) -> str:
    """Return a value with three or four digits, without an exponent."""
    size = abs(value)
    if value == int(value) and size < 1e7:
        return f"{value:,.0f}"
    digits = 0 if size >= 1000 else 1 if size >= 100 else 2 if size >= 1 else 3
    return f"{value:,.{digits}f}"
