"""The lateness of scans with and without other processes, judged with the error of the sample."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from math import ceil

from tests.campaigns.acceptance.figure import Figure, at_least, holds
from tests.campaigns.stop.place import Place

SHARE = 0.99
BLOCK_S = 0.5
"""Late scans come in clusters: the bootstrap draws blocks of this length."""
DRAWS = 400
INTERVAL = 0.95


class Scans:
    """Lateness of scans without and with others, over equal times, and of bare loops, s, by time."""

    def __init__(self, place: Place, quiet: tuple[float, float], loud: tuple[float, float]) -> None:
        """``quiet``, ``loud``: from when to when (tester.base.clock.monotonic); the run has ended."""
        scans = place.scans()
        self.seconds = loud[1] - loud[0]
        self.before = [late for at, late in scans if quiet[0] <= at <= quiet[1]]
        self.beside = [late for at, late in scans if loud[0] <= at <= loud[1]]
        self.loops = place.loops_late_s(*loud)

    def figures(self, others: str) -> list[Figure]:
        """Figures with ``others``; the latest scan is judged over all rounds."""
        return [
            at_least(f"scans beside {others}", len(self.beside), 0.9 * 100.0 * self.seconds),
            self._share_in_time(),
            holds("latest scan without them", True, f"{1e3 * nth(self.before, 1.0):.1f} ms of {len(self.before)}",
                  "no limit"),
        ]  # fmt: skip

    def _share_in_time(self) -> Figure:
        """99 % of scans are not later than without others by more than a bare loop's lateness: a miss exceeds the
        sample's error.

        Ten seconds have ten scans beyond that share, so a figure from them alone sometimes misses although nothing is
        late.
        """
        least_s = self.least_excess_s()
        return holds(
            "99 % of scans beside them are late by",
            least_s <= 0.0,
            f"{1e3 * nth(self.beside, SHARE):.2f} ms (without them {1e3 * nth(self.before, SHARE):.2f}, bare loops "
            f"{1e3 * nth(self.loops, SHARE):.2f}; beyond both {1e3 * self.excess_s():.2f}, with "
            f"{100.0 * INTERVAL:.0f} % certainty at least {1e3 * least_s:.2f})",
            "beyond both at least 0 ms at most",
        )

    def excess_s(self) -> float:
        """Return how much later scans with others are than scans without others plus a bare loop, s."""
        return nth(self.beside, SHARE) - nth(self.before, SHARE) - nth(self.loops, SHARE)

    def least_excess_s(self) -> float:
        """Return the lower limit of ``excess_s``, s, by a block bootstrap; NaN without data."""
        drawn = random.Random(0)
        excess = [
            nth(_again(self.beside, self.seconds, drawn), SHARE)
            - nth(_again(self.before, self.seconds, drawn), SHARE)
            - nth(_again(self.loops, self.seconds, drawn), SHARE)
            for _ in range(DRAWS)
        ]
        return nth(excess, 1.0 - INTERVAL)


def _again(late: Sequence[float], seconds: float, drawn: random.Random) -> list[float]:
    """Return as many of them, in blocks drawn with replacement."""
    blocks = max(1, round(seconds / BLOCK_S))
    size = max(1, len(late) // blocks)
    starts = range(max(1, len(late) - size + 1))
    return [one for _ in range(blocks) for start in drawn.choices(starts) for one in late[start : start + size]]


def latest_kept(rounds: Sequence[Scans]) -> bool:
    """The latest scan with others is not later than the latest without them by more than the loops show."""
    seen = all(one.before and one.beside and one.loops for one in rounds)
    return seen and worst(one.beside for one in rounds) <= latest_limit_s(rounds)


def latest_limit_s(rounds: Sequence[Scans]) -> float:
    """Return the allowed lateness of a scan with others, of all rounds, s."""
    return worst(one.before for one in rounds) + worst(one.loops for one in rounds)


def latest_of(rounds: Sequence[Scans]) -> str:
    """Return the latest scan with others, as text."""
    loop_s = worst(one.loops for one in rounds)
    return f"{1e3 * worst(one.beside for one in rounds):.1f} ms (bare loop {1e3 * loop_s:.1f})"


def limit_of(rounds: Sequence[Scans]) -> str:
    """Return its limit, as text."""
    return f"at most {1e3 * latest_limit_s(rounds):.1f} ms"


def worst(late: Iterable[Sequence[float]]) -> float:
    """Return the greatest of all, NaN if there are none."""
    return max((nth(one, 1.0) for one in late), default=float("nan"))


def nth(late: Sequence[float], share: float) -> float:
    """Return the quantile of the numbers for a share, NaN for none."""
    return sorted(late)[max(0, ceil(share * len(late)) - 1)] if late else float("nan")
