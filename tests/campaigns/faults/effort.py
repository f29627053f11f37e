"""Processor time as a share of a fixed loop's, timed in the same run: the cost of a campaign, independent of the
machine.

A machine that is slower today, or shares its cores, is also slower in the loop: a limit in loops stays valid.
"""

from __future__ import annotations

import os
from statistics import median
from time import process_time
from typing import Final

LOOP_S: Final = 0.1
"""Duration of the loop on the reference machine, where `python3 -c pass` takes 15 ms of CPU time: 6.5 times as long
(CPython 3.11: 6.0 to 7.2 in eight measurements)."""
_ROUNDS, _TIMES = 300_000, 3


def cpu_s() -> float:
    """Return the processor time of this process and of its workers that have ended, s."""
    return sum(os.times()[:4])


class Effort:
    """Counts the processor time since it was created; ``look`` times the loop again between parts."""

    def __init__(self) -> None:
        """Begin to count."""
        self._loops_s: list[float] = []
        self._looked_s = 0.0
        self._began_s = cpu_s()
        self.look()

    def look(self) -> None:
        """Time the loop: the least of a few times; its own time is not counted."""
        before = cpu_s()
        self._loops_s.append(min(_loop_s() for _ in range(_TIMES)))
        self._looked_s += cpu_s() - before

    @property
    def used_s(self) -> float:
        """Processor time so far, s."""
        return cpu_s() - self._began_s - self._looked_s

    @property
    def reference_s(self) -> float:
        """The same scaled to the reference machine, s."""
        return self.used_s / median(self._loops_s) * LOOP_S


def _loop_s() -> float:
    """Return the processor time of one loop, s: whole numbers, floats and a dictionary, as in a scan."""
    began_s = process_time()
    total, kept = 0.0, dict[int, int]()
    for i in range(_ROUNDS):
        x = (i * 1_103_515_245 + 12_345) & 0x7FFF_FFFF
        kept[x & 1023] = x
        total += kept[x & 1023] * 0.5 - i
    return process_time() - began_s
