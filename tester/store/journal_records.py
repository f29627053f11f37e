"""Rows of a run's journal as plain values: events, prompts, trips, tares, parameters of devices, exclusions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isnan
from typing import Final

LEAP: Final = "leap"
"""Kind of the event that ends a step with leaps (``tester.machine.leaps``); its data are the seconds leapt."""


@dataclass(frozen=True, slots=True)
class StoredTare:
    """A zero of the load cell. ``kind``: reference, repeat or check; ``zeros``: zero of each channel, by its name."""

    t_s: float
    kind: str
    repeat_id: int
    zeros: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class StoredPrompt:
    """A question to a person, and its answer (empty: no answer)."""

    asked_s: float
    asked_utc: str
    text: str
    answered_s: float
    answered_utc: str
    answer: str
    answered_by: str


@dataclass(frozen=True, slots=True)
class StoredTrip:
    """A trip: the interlock, the value that caused it and its limit, the person who acknowledged it, and when.

    Value and limit are NaN if the interlock watches no number; ``acknowledged_s`` is NaN if the run had already ended.
    """

    id: int
    t_s: float
    utc: str
    interlock: str
    text: str
    value: float
    limit_value: float
    unit: str
    acknowledged_s: float
    acknowledged_utc: str
    acknowledged_by: str

    @property
    def compared(self) -> str:
        """Return value and limit in words; "" if there are none."""
        if isnan(self.value) and isnan(self.limit_value):
            return ""
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        value, limit = ("unknown" if isnan(number) else f"{number:.4g}" for number in (self.value, self.limit_value))
        return f"{value}{unit}, limit {limit}{unit}"

    @property
    def acknowledged(self) -> str:
        """Return who acknowledged the trip and when, in words."""
        if not self.acknowledged_utc:
            return "not acknowledged"
        by = f" by {self.acknowledged_by}" if self.acknowledged_by else ""
        return f"acknowledged {self.acknowledged_utc}{by}"


@dataclass(frozen=True, slots=True)
class StoredParameter:
    """A value read back from a device."""

    t_s: float
    device: str
    parameter: str
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class StoredExclusion:
    """A person's decision on a repeat: excluded from the mean (``excluded`` 1), or included again (0); ``id`` counts
    from 1.

    ``manifest_before`` is the text of the folder's manifest before the decision, "" if there was none.
    """

    id: int
    condition: int
    repeat: int
    attempt: int
    excluded: int
    reason: str
    operator: str
    utc: str
    software_version: str
    manifest_before: str

    @property
    def target(self) -> tuple[int, int, int]:
        """Return condition, repeat and attempt."""
        return self.condition, self.repeat, self.attempt


@dataclass(frozen=True, slots=True)
class StoredEvent:
    """One line of the journal: sequence number from 1, rig seconds, wall clock, kind, severity, text, data."""

    sequence: int
    t_s: float
    utc: str
    kind: str
    severity: str
    text: str
    data: str
