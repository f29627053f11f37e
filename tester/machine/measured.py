"""How repeats and conditions end, on any machine."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import nan

from tester.analysis.results import RepeatStatus
from tester.store.sql import Ticket


class Ending(Enum):
    """How a repeat ended."""

    COMPLETE = "complete"
    INCOMPLETE = "incomplete"
    """Less than the window requires, after all bursts."""
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    ZERO_DRIFT = "load cell zero drifted"


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
