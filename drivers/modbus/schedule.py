"""Which request goes next on a Modbus line, and when the line wants to be served."""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.modbus.request import Request, Station

PROBE_S: Final = 1.0
"""Pause between attempts to reach a lost station: it must not take the line from the others."""
RETRY_S: Final = 0.5
"""Pause before a write or a single read is tried again whose attempts all failed."""
SLACK_S: Final = 0.06
"""A periodic read waits this long for a regular scan: scans at 20 Hz serve the slow line without ticks of its own."""

_TINY_S: Final = 1e-9
_EARLY_S: Final = 1e-3
"""What falls due within this is sent now: the next scan would be later."""


class Schedule:
    """The requests of one line. Of those due, the one goes first that has waited longest.

    ``wants_s``: before it there is nothing to choose (s); ``latest_s``: when the first request will have waited as long
    as it may, of those not under way.
    """

    def __init__(self) -> None:
        """Nothing is due."""
        self._requests: list[Request] = []  # those enabled, in the order they were
        self._soonest_s = self.latest_s = self.wants_s = -inf
        self._with_scans = False
        self.slowest_s = 0.0
        """The longest usual exchange among the reads that go out with every scan, s."""

    def enable(self, request: Request, due_s: float = -inf) -> None:
        """Let a request be sent at ``due_s``, then in its period."""
        if not request.enabled:
            self._requests.append(request)
        request.enabled = True
        request.attempts = 0
        self._plan(request, due_s)

    def disable(self, request: Request) -> None:
        """Send a request no more."""
        if request.enabled:
            self._requests.remove(request)
        request.enabled = False
        self._plan(request, inf)

    def renew(self, request: Request, urgent: bool) -> None:
        """Let a write with new values go out as soon as its turn comes; ``urgent``: before everything else."""
        request.fresh = True
        request.attempts = 0
        if request.enabled:
            # Counted from the last one: a value that changes in every scan cannot starve the reads.
            self._plan(request, -inf if urgent else min(request.due_s, request.sent_s))

    def retime(self, request: Request, period_s: float) -> None:
        """Change the period (s) of a read; 0 = with every scan."""
        request.period_s = period_s
        request.slack_s = SLACK_S if period_s > 0.0 else inf
        if request.enabled and not request.attempts:
            self._plan(request, request.sent_s + period_s)
        self.look_again()

    def look_again(self) -> None:
        """Forget when the next request falls due: something has changed."""
        self._soonest_s = self.wants_s = -inf

    def choose(self, now: float, scan: bool, reads_only: bool = False) -> Request | None:
        """Return the request to send at ``now``; reads of period 0 go out with a ``scan`` only.

        ``reads_only``: writes wait, whatever is due.
        The same pass finds when the others fall due.
        """
        if self._soonest_s == -inf:
            self.slowest_s = max((one.expected_s for one in self._requests if one.period_s == 0.0), default=0.0)
            self._with_scans = any(each.period_s == 0.0 and not each.attempts for each in self._requests)
        chosen: Request | None = None
        rank = soonest = latest = inf
        limit = now + _EARLY_S
        for request in self._requests:
            due = request.due_s
            if due <= limit:
                if reads_only and request.writes:
                    continue
                if request.period_s == 0.0 and not scan and not request.attempts:
                    continue
                if due < rank:
                    # The one chosen so far is one of the others now.
                    before, chosen, rank = chosen, request, due
                    if before is None:
                        continue
                    request = before
                    due = request.due_s
            if due < soonest and (request.period_s > 0.0 or request.attempts):
                soonest = due
            if request.wish_s < latest:
                latest = request.wish_s
        self._soonest_s = soonest
        self.latest_s = latest
        self.wants_s = -inf if self._with_scans else soonest - _EARLY_S - _TINY_S
        return chosen

    def write_due(self, now: float) -> Request | None:
        """Return the first write that is due."""
        return next((one for one in self._requests if one.writes and one.due_s <= now + _EARLY_S), None)

    def latest(self) -> float:
        """Return when the first of the requests will have waited as long as it may."""
        return min((request.wish_s for request in self._requests), default=inf)

    def succeeded(self, request: Request, t: float) -> None:
        """Set when a request that was answered at ``t`` is due again: on its grid, unless it has fallen behind."""
        if request.attempts or request.fresh or not request.enabled:
            request.attempts = 0
            self.look_again()
            if request.fresh or not request.enabled:
                return
        period = request.period_s
        due = request.due_s + period
        if request.writes or not due > t or period == 0.0:  # also of a read that was due at once, since -infinity
            due = request.sent_s + period
        request.due_s = due
        request.wish_s = wish = due + request.slack_s
        if wish < self.latest_s:
            self.latest_s = wish
        if due < self._soonest_s and period > 0.0:
            self._soonest_s = due
            if not self._with_scans:
                self.wants_s = due - _EARLY_S - _TINY_S

    def failed(self, request: Request, t: float) -> None:
        """Set when a request without a good reply is tried again."""
        station = request.station
        request.attempts += 1
        if not request.enabled:
            self._plan(request, inf)
        elif request.attempts <= station.timing.retries and not station.is_lost:
            self._plan(request, t)
        else:
            self._postpone(request, t)

    def lost(self, station: Station, t: float) -> None:
        """Try the enabled requests of a lost station now and then only."""
        for request in self._requests:
            if request.station is station:
                self._postpone(request, t)

    def _postpone(self, request: Request, t: float) -> None:
        """Leave a request alone after its last attempt."""
        request.attempts = 0
        if request.station.is_lost:
            self._plan(request, t + PROBE_S)
        elif request.writes or request.period_s == inf:
            self._plan(request, t + RETRY_S)
        else:
            self._plan(request, t + request.period_s)

    def _plan(self, request: Request, due_s: float) -> None:
        """Let a request fall due at ``due_s``; a repeated one does not wait for a regular scan."""
        request.due_s = due_s
        if request.attempts:
            request.wish_s = due_s
        else:
            request.wish_s = due_s + request.slack_s if request.slack_s < inf else inf
        self.look_again()
