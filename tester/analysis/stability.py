"""The valid part of a repeat: its length, and the revolutions at its beginning that are left out as transient.

A repeat collects 1.5 windows (45 revolutions for a window of 30) after its transient and is never reopened. Steadiness
is judged for the condition, over all its repeats (module ``drift``): one repeat alone cannot distinguish a drift of 2 %
from chance.

MSER (marginal standard error rule, White 1997) finds the transient in the first 1.5 windows: leave out the first d
blocks for which the squared standard error of the rest, sum((y - mean)^2) / (n - d)^2, is least, d up to half of them.
A least value at the end of that range means a slope, not a transient: nothing is left out, and all blocks enter the
judgement of the drift. A truncation that moves the mean by less than 0.5 % is not made. In a repeat of several bursts
MSER uses the values after the part that follows the surface temperature is removed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Final

from tester.analysis.blocks import Block, BlockCounter
from tester.base.quantities import temperatures

REPEAT_WINDOWS = 1.5
"""Windows that a repeat collects. With one window in each of three repeats a steady condition is often left undecided,
with 1.5 nearly never (python -m tests.campaigns.repeats)."""

MIN_BLOCKS = 6
"""Fewer blocks leave too few degrees of freedom for trend, temperature and correlation."""

MATERIAL = 0.005
"""A truncation is made when it moves the mean by more than this share of it [A]: correlated noise by itself often seems
to have a transient of 0.1 to 0.3 %, and leaving out the steep beginning of a drift would hide it."""


@dataclass(frozen=True, slots=True)
class Window:
    """Length of a repeat: revolutions or accepted seconds; one of the two is None. Without either, any length will do.

    Drift is per window; a repeat collects 1.5 of them. ``extend_to`` (same unit, at least the window): the most that it
    collects, its transient included, if it is judged alone.
    """

    revolutions: float | None = None
    seconds: float | None = None
    extend_to: float = inf

    @property
    def of_repeat(self) -> Window:
        """Return what a repeat collects after its transient."""
        revolutions, seconds = self.revolutions, self.seconds
        return Window(revolutions and REPEAT_WINDOWS * revolutions, seconds and REPEAT_WINDOWS * seconds)

    @property
    def words(self) -> str:
        """Return the window in a recipe's notation: 30 rev, or 60 s."""
        return f"{self.revolutions:g} rev" if self.revolutions is not None else f"{self.seconds or 0.0:g} s"

    def duration_s(self, revolutions_per_s: float) -> float:
        """Return the seconds in which the window is collected at a speed in revolutions/s (> 0)."""
        if self.seconds is not None:
            return self.seconds
        return (self.revolutions or 0.0) / revolutions_per_s


ANY_LENGTH: Final = Window()


def truncation(values: Sequence[float]) -> int | None:
    """Return how many leading values MSER leaves out; None when the least error is at the last cut tried."""
    n = len(values)
    last = n // 2
    total = squares = 0.0
    # Deviations from the mean of the later half keep the sums of squares free of cancellation.
    origin = sum(values[last:]) / (n - last)
    best, best_at = inf, last
    for kept, value in enumerate(reversed(values), start=1):
        deviation = value - origin
        total += deviation
        squares += deviation * deviation
        if kept >= n - last:
            error = (squares - total * total / kept) / (kept * kept)
            # <=: of equal errors (noise-free values) take the one that keeps more blocks.
            if error <= best:
                best, best_at = error, n - kept
    return None if best_at == last and last > 0 else best_at


def centred(values: Sequence[float]) -> list[float]:
    """Return values less their mean."""
    mean = sum(values) / len(values)
    return [value - mean for value in values]


def seconds_of(blocks: Sequence[Block]) -> float:
    """Return the accepted seconds in blocks."""
    return sum(block.ended_s - block.started_s for block in blocks)


def enough(blocks: Sequence[Block], window: Window) -> bool:
    """Return whether blocks fill a window."""
    if window.revolutions is not None:
        return len(blocks) >= window.revolutions
    return window.seconds is None or seconds_of(blocks) >= window.seconds


def filled(counter: BlockCounter, window: Window) -> bool:
    """Return whether the blocks after the transient fill all that a repeat of this window collects."""
    blocks, wanted = counter.blocks, window.of_repeat
    if not enough(blocks, wanted):
        return False
    if counter.transient is None:
        counter.transient = left_out(blocks, window)  # only once: later blocks never change it
    return enough(blocks[counter.transient :], wanted)


def left_out(blocks: Sequence[Block], window: Window) -> int:
    """Return how many leading blocks are transient; only the first 1.5 windows count, so later blocks never change
    it."""
    first = list(blocks)
    if window.revolutions is not None:
        first = first[: int(REPEAT_WINDOWS * window.revolutions)]
    elif window.seconds is not None:
        while len(first) > MIN_BLOCKS and seconds_of(first[:-1]) >= REPEAT_WINDOWS * window.seconds:
            first.pop()
    mu = [block.mu for block in first]
    if len(first) < MIN_BLOCKS or not all(map(isfinite, mu)) or sum(mu) <= 0.0:
        return 0
    return _transient(first, mu)


def _transient(blocks: Sequence[Block], mu: list[float]) -> int:
    n = len(blocks)
    values = centred(mu)
    # Bursts differ in surface temperature: its effect must not look like a transient.
    if blocks[0].burst != blocks[-1].burst:
        surface = centred(temperatures(block.means for block in blocks))
        squares = sum(kelvin * kelvin for kelvin in surface)
        if squares > 0.0:
            per_kelvin = sum(a * b for a, b in zip(surface, values, strict=True)) / squares
            values = [value - per_kelvin * kelvin for value, kelvin in zip(values, surface, strict=True)]
    cut = truncation(values) or 0
    return 0 if abs(sum(values[cut:])) <= MATERIAL * (sum(mu) / n) * (n - cut) else cut
