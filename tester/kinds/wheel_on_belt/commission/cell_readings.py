"""Readings of the load cell of a rig at rest, once the hung weight is at rest."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator
from itertools import pairwise
from math import inf, isfinite, sqrt
from statistics import fmean
from typing import Final

from tester.kinds.wheel_on_belt.commission.quiet import QuietSeat
from tester.machine.commission.person import StepRefused, Waits

LEAST_READINGS: Final = 20
"""Fewest readings of the cell for judging whether they have settled [A]: five a quarter."""
QUARTERS: Final = 4
NOISES: Final = 4.0
"""Means of pure noise differ by more than this many of its standard deviations in 2 % of cases [A]."""


def settled_cell(
    seat: QuietSeat, least_s: float, at_most_s: float, still_n: float
) -> Generator[Waits, str, list[float]]:
    """Yield until the cell's readings have settled; return the means of Fx, Fy, Fz, raw, N.

    Settled: the means of the quarters of the last ``least_s`` of readings agree within ``still_n`` and their noise,
    which is estimated from successive readings, because a swing is slower. Raises StepRefused if it still swings after
    ``at_most_s``.
    """
    rows: deque[tuple[float, float, float, float]] = deque()
    began_s = inf

    def settled() -> bool:
        quarter = len(rows) // QUARTERS
        for i in range(1, 4):
            values = [row[i] for row in rows]
            noise = sqrt(0.5 * fmean((two - one) ** 2 for one, two in pairwise(values)))
            means = [fmean(values[place * quarter : (place + 1) * quarter]) for place in range(QUARTERS)]
            if max(means) - min(means) > still_n + NOISES * noise / sqrt(quarter):
                return False
        return True

    def enough(now_s: float) -> bool:
        nonlocal began_s
        began_s = min(began_s, now_s)
        cell = seat.devices.cell
        if cell.valid and (not rows or cell.stamp_s > rows[-1][0]) and all(isfinite(one) for one in cell.raw[:3]):
            rows.append((cell.stamp_s, cell.raw[0], cell.raw[1], cell.raw[2]))
            while rows[-1][0] - rows[0][0] > least_s:
                rows.popleft()
        if now_s - began_s > at_most_s:
            raise StepRefused(
                f"the load cell's readings have not settled within {still_n:g} N in {at_most_s:g} s: the weight swings,"
                " or the cell drifts"
            )
        return now_s - began_s >= least_s and len(rows) >= LEAST_READINGS and settled()

    yield enough
    return [fmean(row[i] for row in rows) for i in range(1, 4)]
