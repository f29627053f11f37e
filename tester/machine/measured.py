"""A measured repeat, and how repeats and conditions end, on any machine."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any, Protocol

from tester.analysis.blocks import BlockCounter
from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.store.sql import Ticket


class Ending(Enum):
    """How a repeat ended."""

    COMPLETE = "complete"
    INCOMPLETE = "incomplete"
    """Less than the window requires, after all bursts."""
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    ZERO_DRIFT = "load cell zero drifted"


REPEAT_STATUS: dict[Ending, RepeatStatus] = {
    Ending.CANNOT_HOLD: RepeatStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: RepeatStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: RepeatStatus.VOID,
}
"""Endings without a value, whatever was collected; the reduction judges the others."""

CONDITION_STATUS: dict[Ending, ConditionStatus] = {
    Ending.CANNOT_HOLD: ConditionStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: ConditionStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: ConditionStatus.SKIPPED,
}


class MeasuredRepeat(Protocol):
    """The activity that measures one repeat: it steps until ``ending`` is set."""

    @property
    def ending(self) -> Ending | None:
        """How it ended."""
        ...

    @property
    def detail(self) -> str:
        """The reason, in words."""
        ...

    @property
    def counter(self) -> BlockCounter:
        """The blocks it counted."""
        ...

    @property
    def rolling_only(self) -> bool:
        """Whether it was a repeat without slip."""
        ...

    @property
    def warming_k_s(self) -> float:
        """How fast the surface warmed in contact, K/s; NaN if not measured."""
        ...

    @property
    def holdable_band_k(self) -> float:
        """The narrowest temperature band that could be held, K; NaN if not measured."""
        ...

    def step(self, ctx: Any) -> bool:
        """Advance by one scan; return True when done."""
        ...


@dataclass(frozen=True, slots=True)
class RepeatOutcome:
    """The result of a repeat, and its commit."""

    status: RepeatStatus
    text: str
    ticket: Ticket


@dataclass(frozen=True, slots=True)
class ConditionEnd:
    """How a condition ended: None = no further repeat was needed."""

    ending: Ending | None = None
    detail: str = ""
    warming_k_s: float = nan
    holdable_band_k: float = nan
