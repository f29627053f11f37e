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
    """Fewer samples than the window requires, after all bursts."""
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    ZERO_DRIFT = "load cell zero drifted"


REPEAT_STATUS: dict[Ending, RepeatStatus] = {
    Ending.CANNOT_HOLD: RepeatStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: RepeatStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: RepeatStatus.VOID,
}
"""Status of a repeat whose ending gives no value, whatever was collected; the reduction judges the others."""

CONDITION_STATUS: dict[Ending, ConditionStatus] = {
    Ending.CANNOT_HOLD: ConditionStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: ConditionStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: ConditionStatus.SKIPPED,
}


class MeasuredRepeat(Protocol):
    """The activity that measures one repeat: it steps until ``ending`` is set."""

    @property
    def ending(self) -> Ending | None:
        """How the repeat ended; None while it is measured."""
        ...

    @property
    def detail(self) -> str:
        """The reason for the ending, in words."""
        ...

    @property
    def counter(self) -> BlockCounter:
        """The counter with the repeat's counted blocks."""
        ...

    @property
    def rolling_only(self) -> bool:
        """Whether the repeat was made without slip."""
        ...

    @property
    def warming_k_s(self) -> float:
        """How fast the surface warmed while in contact, K/s; NaN if not measured."""
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
    """The result of a repeat, and the state of its commit."""

    status: RepeatStatus
    text: str
    ticket: Ticket


@dataclass(frozen=True, slots=True)
class ConditionEnd:
    """How a condition ended; None if no further repeat was needed."""

    ending: Ending | None = None
    detail: str = ""
    warming_k_s: float = nan
    holdable_band_k: float = nan
