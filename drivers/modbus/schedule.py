"""Which request goes next on a Modbus line, and when the line wants to be served."""

from __future__ import annotations

from math import inf

from drivers.modbus.request import Request, Station

PROBE_S = 1.0
"""Pause between attempts to reach a lost station: it must not take the line from the others."""
RETRY_S = 0.5
"""Pause before a write or a single read is tried again whose attempts all failed."""
SLACK_S = 0.06
"""A periodic read waits this long for a regular scan: scans at 20 Hz serve the slow line without ticks of its own."""

_EARLY_S = 1e-3
"""What falls due within this is sent now: the next scan would be later."""


class Schedule:
    """The requests of one line. Of those due, the one goes first that has waited longest, priority added."""

    __slots__ = ("_requests", "_soonest_s", "_with_scans")

    def __init__(self) -> None:
        """Nothing is due."""
        self._requests: list[Request] = []  # those enabled, in the order they were
        self._soonest_s = -inf
        self._with_scans = False

    def enable(self, request: Request, due_s: float = -inf) -> None:
        """Let a request be sent at ``due_s``, then in its period."""
        if not request.enabled:
            self._requests.append(request)
        request.enabled = True
        request.attempts = 0
        request.due_s = due_s
        self.look_again()

    def disable(self, request: Request) -> None:
        """Send a request no more."""
        if request.enabled:
            self._requests.remove(request)
        request.enabled = False
        request.due_s = inf

    def renew(self, request: Request, urgent: bool) -> None:
        """Let a write with new values go out as soon as its turn comes; ``urgent``: before everything else."""
        request.fresh = True
        request.attempts = 0
        if request.enabled:
            # Counted from the last one: a value that changes in every scan cannot starve the reads.
            request.due_s = -inf if urgent else min(request.due_s, request.sent_s)
            self.look_again()

    def retime(self, request: Request, period_s: float) -> None:
        """Change the period (s) of a read; 0 = with every scan."""
        request.period_s = period_s
        request.slack_s = SLACK_S if period_s > 0.0 else inf
        if request.enabled and not request.attempts:
            request.due_s = request.sent_s + period_s
        self.look_again()

    def look_again(self) -> None:
        """Forget when the next request falls due: something has changed."""
        self._soonest_s = -inf

    def nothing_due(self, now: float, scan: bool) -> bool:
        """Tell, cheaply, that ``choose`` would find nothing."""
        return now < self._soonest_s - _EARLY_S and not (scan and self._with_scans)

    def choose(self, now: float, scan: bool) -> Request | None:
        """Return the request to send at ``now``; reads of period 0 go out with a ``scan`` only."""
        chosen: Request | None = None
        rank = soonest = inf
        with_scans = False
        limit = now + _EARLY_S
        for request in self._requests:
            due = request.due_s
            if request.period_s == 0.0 and not request.attempts:
                with_scans = True
                if not scan:
                    continue
            elif due < soonest:
                soonest = due
            if due <= limit and (chosen is None or due - request.priority_s < rank):
                chosen, rank = request, due - request.priority_s
        self._with_scans = with_scans
        self._soonest_s = soonest
        return chosen

    def latest(self, without: Request | None = None) -> float:
        """Return when the first of the requests (``without`` one) will have waited as long as it may."""
        latest = inf
        for request in self._requests:
            wish = request.due_s if request.attempts else request.due_s + request.slack_s
            if wish < latest and request is not without:
                latest = wish
        return latest

    def succeeded(self, request: Request, t: float) -> None:
        """Set when a request that was answered at ``t`` is due again: on its grid, unless it has fallen behind."""
        request.attempts = 0
        self._soonest_s = -inf
        if not request.enabled or request.fresh:
            return
        period = request.period_s
        due = request.due_s + period
        on_grid = due > t and period > 0.0 and not request.writes
        request.due_s = due if on_grid else request.sent_s + period

    def failed(self, request: Request, t: float) -> None:
        """Set when a request without a good reply is tried again."""
        self._soonest_s = -inf
        station = request.station
        request.attempts += 1
        if not request.enabled:
            request.due_s = inf
        elif request.attempts <= station.timing.retries and not station.is_lost:
            request.due_s = t
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
            request.due_s = t + PROBE_S
        elif request.writes or request.period_s == inf:
            request.due_s = t + RETRY_S
        else:
            request.due_s = t + request.period_s
