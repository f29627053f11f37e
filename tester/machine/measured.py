"""A measured repeat, and how repeats and conditions end, on any machine."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import nan
from typing import Any

from tester.analysis.blocks import BlockCounter
from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.base.deriving import mypyc_attr
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


@mypyc_attr(allow_interpreted_subclasses=True)
class MeasuredRepeat:
    """The activity that measures one repeat: it steps until ``ending`` is set. A kind implements ``step``."""

    def __init__(self, counter: BlockCounter) -> None:
        """``counter``: counts the repeat's blocks."""
        self.counter = counter
        self.ending: Ending | None = None
        """How the repeat ended; None while it is measured."""
        self.detail = ""
        """The reason for the ending, in words."""
        self.rolling_only = False
        """Whether the repeat was made without slip."""
        self.warming_k_s: float = nan
        self.holdable_band_k: float = nan
        """How fast the surface warmed while in contact, K/s, and the narrowest temperature band that could be held, K;
        NaN if not measured."""

    def step(self, ctx: Any) -> bool:
        """Advance by one scan; return True when done."""
        raise NotImplementedError


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
