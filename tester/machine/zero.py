"""The zero of a load cell: the mean of its readings while nothing loads it."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan
from typing import Final

from tester.machine.context import AnyContext

LEAST: Final = 10
"""Readings that a zero averages at least."""
SILENT_S: Final = 5.0
"""A zero that has not got its readings this long after its time is given up, s [A]."""


class ZeroOfCell:
    """Averages readings over a time. A kind's activity inherits from it and decides whether to take the zero."""

    def __init__(self, seconds: float) -> None:
        """``seconds``: how long to average."""
        self.seconds = seconds
        self.began_s: float = nan
        self.stamp_s: float = -inf
        self.sums: list[float] = []
        self.count = 0
        self.failed = ""
        """Why the zero is not to be trusted."""

    def averaged(self, ctx: AnyContext, at_s: float, values: Sequence[float], *, valid: bool) -> bool:
        """Take in the reading of ``at_s`` and return whether there are enough; set ``failed`` where none come."""
        ctx.moving = True
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        if valid and at_s > self.stamp_s and at_s > self.began_s:
            self.stamp_s = at_s
            before = self.sums or [0.0] * len(values)
            self.sums = [total + value for total, value in zip(before, values, strict=True)]
            self.count += 1
        late_s = ctx.now - self.began_s - self.seconds
        if late_s >= 0.0 and self.count >= LEAST:
            return True
        if late_s > SILENT_S:
            self.failed = f"the load cell gave {self.count} valid readings in {ctx.now - self.began_s:.0f} s"
        return False

    def zero(self, tare: Sequence[float]) -> tuple[float, ...]:
        """Return the zero in the cell's own readings: the mean, with ``tare`` put back."""
        return tuple(old + total / self.count for old, total in zip(tare, self.sums, strict=True))
