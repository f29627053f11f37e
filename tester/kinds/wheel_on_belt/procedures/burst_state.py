"""The state of a repeat: its phase, the burst in progress, and what is left of its run-in.

A rubber's abrasion pattern turns round with the slip. Sliding after a reversal does not count before the run-in is
over; it comes in pulses, as all sliding, each as long as the surface stays inside its band.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from tester.analysis.directions import is_reversed
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition


class Phase(Enum):
    """The phase of a repeat."""

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


class RunIn:
    """The distance that is left to slide, m, and the pulses made for it."""

    def __init__(self, distance_m: float) -> None:
        """Begin with the whole distance."""
        self.left_m = distance_m
        self.pulses = 0

    def slide(self, distance_m: float) -> bool:
        """Take in what has been slid in a scan; return whether the run-in is over."""
        self.left_m -= distance_m
        return self.left_m <= 0.0


def slides_reversed(step: WheelCondition, repeat: int) -> bool:
    """Return whether a repeat of a condition, from 1, slides the other way than is asked for."""
    return step.both_directions and is_reversed(repeat)


def run_in_m(step: WheelCondition, repeat: int) -> float:
    """Return how far a repeat slides before it counts, m: the first of a condition, and each that turns round."""
    turned = repeat == 1 or slides_reversed(step, repeat) is not slides_reversed(step, repeat - 1)
    return step.run_in_m if step.both_directions and turned else 0.0
