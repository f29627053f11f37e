"""When items begin and end: sums of their estimates, with an interval from the spread that each estimate states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Final

from tester.queue.fold import Queue
from tester.queue.items import ItemState, Needs

BETWEEN_S: Final = 3.0
"""Time between two items for evidence, planning and connecting, s [A]: two processes start and plan."""
SKEW: Final = 0.1
"""The mean of runs is above the estimate by this share of the difference between the upper and the lower half of its
range. On the simulated rig 40 runs of `quickstart` have 0.17 +- 0.10, 37 of three angles 0.05 +- 0.11."""


SHARED: Final = 0.06
"""Half range, 95 %, of the deviations that all items on a rig have in common, as a share of their time: beliefs about
wear and heat, estimates of like conditions. Means of the training recipes of ``tests.campaigns.queue`` lie 0.14 below
to 0.05 above the estimate, and more than one recipe is in most queues [A]."""


@dataclass(frozen=True, slots=True)
class PlannedItem:
    """An item's part of a prediction: its needs, and of the item under way only what is left.

    ``left_s``: seconds to its end, None for an item that has not begun.
    """

    id: int
    needs: Needs
    left_s: float | None = None

    @property
    def share(self) -> float:
        """Share of the item that is left, 0..1."""
        if self.left_s is None or self.needs.seconds <= 0.0:
            return 1.0
        return min(max(self.left_s / self.needs.seconds, 0.0), 1.0)

    @property
    def half_ranges(self) -> tuple[float, float]:
        """How much sooner and later than the estimate 95 % of runs end, s, of what is left."""
        needs = self.needs
        return self.share * (needs.seconds - needs.low_s), self.share * (needs.high_s - needs.seconds)

    @property
    def mean_s(self) -> float:
        """Mean duration from now or from its start, s."""
        sooner_s, later_s = self.half_ranges
        return (self.needs.seconds if self.left_s is None else self.left_s) + SKEW * (later_s - sooner_s)


@dataclass(frozen=True, slots=True)
class Times:
    """When an item begins and ends, s from the prediction; 95 % of queues end it between ``low_s`` and ``high_s``."""

    id: int
    start_s: float
    end_s: float
    low_s: float
    high_s: float


def planned(queue: Queue, left_s: float | None = None) -> list[PlannedItem]:
    """Return the items that will run, in order. ``left_s``: seconds to the end of the item under way, None if unknown:
    then its whole estimate counts.
    """
    items: list[PlannedItem] = []
    for entry in queue.listed:
        if entry.state is not ItemState.SKIPPED:
            under_way = entry.state.under_way and left_s is not None
            items.append(PlannedItem(entry.item.id, entry.item.needs, left_s if under_way else None))
    return items


def beginning(items: Sequence[PlannedItem], times: Sequence[Times], until_s: float) -> list[Times]:
    """Return the times of the items that begin if none may that may last beyond ``until_s``, s from the prediction."""
    begin: list[Times] = []
    for item, one in zip(items, times, strict=True):
        if item.left_s is None and one.start_s + item.needs.high_s > until_s:
            break
        begin.append(one)
    return begin


def predicted(items: Sequence[PlannedItem]) -> list[Times]:
    """Return the times of items that run one after another.

    The squares of the items' half ranges add up, and so do the third moments, which shift the interval (Cornish and
    Fisher); the part that items have in common (``SHARED``) adds up itself. One item alone has the range that its
    estimate states.
    """
    at_s = squares = thirds = common = 0.0
    times: list[Times] = []
    for item in items:
        start_s = at_s + (BETWEEN_S if item.left_s is None and times else 0.0)
        at_s = start_s + item.mean_s
        sooner_s, later_s = item.half_ranges
        half_s = 0.5 * (sooner_s + later_s)
        together = min(SHARED * item.mean_s, half_s)
        squares += half_s * half_s + 2.0 * together * common
        common += together
        thirds += (0.5 - SKEW) * (later_s - sooner_s) * half_s * half_s
        wide_s, shift_s = sqrt(squares), thirds / squares if squares else 0.0
        times.append(Times(item.id, start_s, at_s, max(at_s - wide_s + shift_s, start_s), at_s + wide_s + shift_s))
    return times
