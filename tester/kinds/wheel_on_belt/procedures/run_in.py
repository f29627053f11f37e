"""Sliding after the slip has turned round, before anything counts: rubber's abrasion pattern turns round with it.

In pulses, as all sliding: each as long as the surface stays inside its band.
"""

from __future__ import annotations

from tester.analysis.directions import is_reversed
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition


class RunIn:
    """The distance that is left to slide, m, and the pulses made for it."""

    def __init__(self, distance_m: float) -> None:
        """Begin with all of it."""
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
