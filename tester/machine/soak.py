"""The wait for a temperature, on any machine."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import Any, Final

from tester.base.screen import SoakView
from tester.machine.context import AnyContext
from tester.machine.trend import TemperatureTrend

SHOW_S: Final = 1.0
"""Period for reporting the progress of a wait, s."""


class SoakWait:
    """A wait until a temperature has stayed within ``within_k`` of ``target_c`` for ``for_s``, or time has run out.

    A kind's activity inherits from it, and demands the temperature.
    """

    def __init__(self, target_c: float, within_k: float, for_s: float, at_most_s: float) -> None:
        """Temperatures in degC and K, times in s."""
        self.target_c = target_c
        self.within_k = within_k
        self.for_s = for_s
        self.at_most_s = at_most_s
        self.began_s: float = nan
        self.since_s: float = inf
        """Time since when the temperature has been in its band; infinite outside."""
        self.shown_s: float = -inf
        self.reached = False
        self._trend = TemperatureTrend()

    def over(self, ctx: AnyContext, work: str, shown_c: float, *, valid: bool = True) -> bool:
        """Return whether the wait is over, soaked or given up (``reached``), at the temperature of this scan.

        ``work``: the wait in a word, for people; ``valid``: whether the temperature is.
        """
        if not isfinite(self.began_s):
            self.began_s = ctx.now
        if ctx.now >= self.shown_s:
            self.shown_s = ctx.now + SHOW_S
            ctx.progress.phase = f"{work} {shown_c:.1f} of {self.target_c:.1f} degC"
        inside = valid and abs(shown_c - self.target_c) <= self.within_k
        self._trend.follow(shown_c)
        self.since_s = min(self.since_s, ctx.now) if inside else inf
        self.reached = ctx.now - self.since_s >= self.for_s
        return self.reached or ctx.now - self.began_s > self.at_most_s

    def waits_s(self, ctx: Any) -> float:
        """Return the rig time for which the wait surely continues, s: while the temperature is far from its band's
        edge.
        """
        off_k = abs(self._trend.last_c - self.target_c)
        if not self._trend.far(abs(off_k - self.within_k)):
            return 0.0
        left_s = self.at_most_s - (ctx.now - self.began_s)
        if off_k <= self.within_k:
            left_s = min(left_s, self.for_s - (ctx.now - self.since_s))
        return left_s

    def view(self, now: float, shown_c: float) -> SoakView:
        """Return the wait as clients see it at ``now``, rig s."""
        within_s, whole_s = (max(now - t, 0.0) if isfinite(t) else 0.0 for t in (self.since_s, self.began_s))
        known_c = shown_c if isfinite(shown_c) else None
        return SoakView(known_c, self.target_c, self.within_k, within_s, self.for_s, whole_s, self.at_most_s)
