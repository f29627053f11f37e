"""Where a repeat is, and what is known of its burst in progress (bursts.py)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Phase(Enum):
    """Where a repeat is."""

    TARE = "tare"
    ROLL = "roll"
    READY = "wait for temperature"
    COOL = "cool lifted"
    MOVE_IN = "bring slip in"
    RUN_IN = "run in reversed"
    COUNT = "measure"
    MOVE_OUT = "take slip out"
    LIFT = "lift"


@dataclass(slots=True)
class BurstNotes:
    """State of the burst in progress."""

    began_s: float = 0.0
    began_c: float = float("nan")
    blocks_before: int = 0
    counted_s: float = float("-inf")
    slid_s: float = float("nan")
    slid_c: float = float("nan")
    """When half of the slip was there, and the reading of the surface then."""
    peak_rate_k_s: float = 0.0
    sum_before_k: float = 0.0
    count_before: int = 0
