"""Choice of the next request on a Modbus line, and of the time when the line wants to be served."""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.modbus.request import Request, Station

MISSES_TO_LOSE: Final = 3
"""Failed attempts in a row after which a station counts as lost (safety page: 3 misses)."""
BUSY_S: Final = 0.02
"""Pause before a request is repeated after exceptions 04 to 07, or 08 on a read: a device that is busy or failed, s."""
POLL_S: Final = 0.002
"""While other requests wait and a reply is overdue, the link asks to be served on a grid of this, s."""
PROBE_S: Final = 1.0
"""Pause between attempts to reach a lost station, s: other stations need the line."""
RETRY_S: Final = 0.5
"""Pause before a write or a single read is tried again after all its attempts failed, s."""
SLACK_S: Final = 0.06
"""A periodic read waits this long for a regular scan: scans at 20 Hz serve the slow line without ticks of its own."""

_TINY_S: Final = 1e-9
EARLY_S: Final = 1e-3
"""A request due within this time is sent now: the next scan would be later."""


class Schedule:
    """The requests of one line. Of the due requests, the one that has waited longest is sent first; of two that have
    waited as long, the one enabled first.

    ``wants_s``: there is nothing to choose before it (s). ``soonest_s``: the time at which the first request that waits
    for no scan falls due. ``latest_s``: the time at which the first request not under way has waited as long as it may.
    """

    def __init__(self) -> None:
        """Begin with no request."""
        self._requests: list[Request] = []  # enabled requests, in the order of enabling
        self.soonest_s = self.latest_s = self.wants_s = -inf
        self._with_scans = False
        self.steady: Request | None = None
        """The only read that goes out with every scan, while nothing has changed since all requests were looked at."""
        self.slowest_s = 0.0
        """The longest usual exchange among the reads that go out with every scan, s."""

    def enable(self, request: Request, due_s: float = -inf) -> None:
        """Schedule a request at ``due_s``, then in its period."""
        if not request.enabled:
            self._requests.append(request)
        request.enabled = True
        request.attempts = 0
        self._plan(request, due_s)

    def disable(self, request: Request) -> None:
        """Stop sending a request."""
        if request.enabled:
            self._requests.remove(request)
        request.enabled = False
        self._plan(request, inf)

    def renew(self, request: Request, urgent: bool) -> None:
        """Schedule a write with new values as soon as its turn comes; ``urgent``: before everything else."""
        request.fresh = True
        request.attempts = 0
        if request.enabled:
            # Counted from the last write: a value that changes in every scan must not starve the reads.
            self._plan(request, -inf if urgent else min(request.due_s, request.sent_s))

    def retime(self, request: Request, period_s: float) -> None:
        """Change the period (s) of a read; 0 = with every scan."""
        request.period_s = period_s
        request.slack_s = SLACK_S if period_s > 0.0 else inf
        if request.enabled and not request.attempts:
            self._plan(request, request.sent_s + period_s)
        self.look_again()

    def periods_s(self) -> list[float]:
        """Return the periods of the reads that have one, s."""
        return [one.period_s for one in self._requests if not one.writes and 0.0 < one.period_s < inf]

    def look_again(self) -> None:
        """Forget the time of the next request after a change."""
        self.soonest_s = self.wants_s = -inf
        self.steady = None

    def choose(self, now: float, scan: bool, reads_only: bool = False) -> Request | None:
        """Return the request to send at ``now``; reads of period 0 go out with a ``scan`` only.

        ``reads_only``: writes wait, whatever is due.
        The same pass finds when the others fall due.
        """
        limit = now + EARLY_S
        steady = self.steady
        # Nearly every scan: the others are not due, and all that was found of them stays.
        if steady is not None and scan and steady.due_s <= limit < self.soonest_s:
            return steady
        if self.soonest_s == -inf:
            self.slowest_s = max((one.expected_s for one in self._requests if one.period_s == 0.0), default=0.0)
            with_scans = [each for each in self._requests if each.period_s == 0.0 and not each.attempts]
            self._with_scans = bool(with_scans)
            self.steady = with_scans[0] if len(with_scans) == 1 and not with_scans[0].writes else None
        chosen: Request | None = None
        rank = soonest = latest = inf
        for request in self._requests:
            due = request.due_s
            if due <= limit:
                if reads_only and request.writes:
                    continue
                if request.period_s == 0.0 and not scan and not request.attempts:
                    continue
                if due < rank - _TINY_S:
                    # The request chosen so far joins the others.
                    before, chosen, rank = chosen, request, due
                    if before is None:
                        continue
                    request = before
                    due = request.due_s
            if due < soonest and (request.period_s > 0.0 or request.attempts):
                soonest = due
            if request.wish_s < latest:
                latest = request.wish_s
        self.soonest_s = soonest
        self.latest_s = latest
        self.wants_s = -inf if self._with_scans else soonest - EARLY_S - _TINY_S
        return chosen

    def write_due(self, now: float) -> Request | None:
        """Return the first write that is due."""
        return next((one for one in self._requests if one.writes and one.due_s <= now + EARLY_S), None)

    def latest(self) -> float:
        """Return the time at which the first request has waited as long as it may."""
        return min((request.wish_s for request in self._requests), default=inf)

    def written(self, request: Request) -> None:
        """Note that a write was sent: it is not due again until its reply comes, or newer values do."""
        request.fresh = False
        request.sent_values = request.values
        request.echo = request.confirmation
        request.due_s = request.wish_s = inf

    def succeeded(self, request: Request, t: float) -> None:
        """Set the next due time of a request that was answered at ``t``: on its grid, unless it has fallen behind."""
        if request is self.steady:
            request.due_s, request.wish_s = request.sent_s, inf
            return
        if request.attempts or request.fresh or not request.enabled:
            request.attempts = 0
            self.look_again()
            if request.fresh or not request.enabled:
                return
        period = request.period_s
        due = request.due_s + period
        if request.writes or not due > t or period == 0.0:  # not due > t: also a read that was due at once (-infinity)
            due = request.sent_s + period
        request.due_s = due
        request.wish_s = wish = due + request.slack_s
        if wish < self.latest_s:
            self.latest_s = wish
        if due < self.soonest_s and period > 0.0:
            self.soonest_s = due
            if not self._with_scans:
                self.wants_s = due - EARLY_S - _TINY_S

    def failed(self, request: Request, t: float) -> None:
        """Set the time of the next attempt of a request without a good reply."""
        station = request.station
        request.attempts += 1
        if not request.enabled:
            self._plan(request, inf)
        elif request.attempts <= station.timing.retries and not station.is_lost:
            self._plan(request, t)
        else:
            self._postpone(request, t)

    def lost(self, station: Station, t: float) -> None:
        """Send the enabled requests of a lost station only now and then."""
        for request in self._requests:
            if request.station is station:
                self._postpone(request, t)

    def _postpone(self, request: Request, t: float) -> None:
        """Delay a request after its last failed attempt."""
        request.attempts = 0
        if request.station.is_lost:
            self._plan(request, t + PROBE_S)
        elif request.writes or request.period_s == inf:
            self._plan(request, t + RETRY_S)
        else:
            self._plan(request, t + request.period_s)

    def _plan(self, request: Request, due_s: float) -> None:
        """Set a request due at ``due_s``; a repeated attempt does not wait for a regular scan."""
        request.due_s = due_s
        if request.attempts:
            request.wish_s = due_s
        else:
            request.wish_s = due_s + request.slack_s if request.slack_s < inf else inf
        self.look_again()
