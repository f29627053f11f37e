"""What travels on a Modbus line: stations (slaves as seen from here), how fast they reply, and the requests to them.

The time of a reply is that of the whole way: the device's own turnaround, the adapter (a USB adapter's latency timer
holds characters back, usually for 16 ms), the operating system, and how often the line is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Final, Protocol

from drivers.profiles.model import Timing

REPLIES: Final = 5
"""Replies that are measured when a station is connected [A]."""
UNMEASURED_S: Final = 0.1
"""A reply is waited for this long beyond the wire until it is known how long replies take [A]: six latency timers of
16 ms. A slower line is as good as silent."""
REPLY_FACTOR: Final = 1.5
"""A reply may take this times the longest measured [A]. A USB adapter's timer adds 0 to 16 ms by chance, so that the
longest of five is above 10 ms in 99 of 100 cases. No less than the profile's own limit, no more than UNMEASURED_S."""


class ReplyTimes:
    """Times from the end of a request to the start of its reply, s, as they are seen here.

    ``count`` replies were measured, ``least_s`` and ``greatest_s`` of them; ``measured`` once there are enough.
    """

    def __init__(self) -> None:
        """Nothing is known."""
        self.forget()

    def forget(self) -> None:
        """Measure anew, from the next reply on."""
        self.count = 0
        self.least_s = inf
        self.greatest_s = 0.0
        self.total_s = 0.0
        self.measured = False

    def note(self, seconds: float) -> None:
        """Take a reply's time, s."""
        self.count += 1
        self.total_s += seconds
        self.least_s = min(self.least_s, seconds)
        self.greatest_s = max(self.greatest_s, seconds)
        self.measured = self.count >= REPLIES

    @property
    def mean_s(self) -> float:
        """Mean of what was measured, s; 0 before the first reply."""
        return self.total_s / self.count if self.count else 0.0

    def limit_s(self, timing: Timing) -> float:
        """Return how long a reply is waited for beyond the wire, s."""
        if not self.measured:
            return max(timing.reply_max_s, UNMEASURED_S)
        return max(timing.reply_max_s, min(REPLY_FACTOR * self.greatest_s, UNMEASURED_S))


class Owner(Protocol):
    """The driver behind a station; it is called with the outcome of its requests."""

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Take the registers of a good reply (empty for a write) that arrived at ``t`` s."""
        ...

    def lost(self, t: float) -> None:
        """Act on a station that has stopped answering."""
        ...


@dataclass(slots=True)
class Counters:
    """What happened on the line with one slave since the start."""

    requests: int = 0
    replies: int = 0
    timeouts: int = 0
    crc_errors: int = 0
    garbage: int = 0
    """Pieces that were no reply: wrong address, broken off, noise."""
    late: int = 0
    """Replies to a request that had been given up, or to another than the last."""
    exceptions: dict[int, int] = field(default_factory=dict[int, int])
    """How often each exception code came."""


@dataclass(slots=True, eq=False)
class Station:
    """One slave: its address, its timing and how it has been doing."""

    unit_id: int
    timing: Timing
    owner: Owner
    counters: Counters = field(default_factory=Counters)
    misses: int = 0
    """Attempts that failed in a row."""
    is_lost: bool = False
    """Three attempts in a row failed, or a gateway reported the device as gone; a good reply ends it."""
    refused: str | None = None
    """Why the device cannot be used as configured; stays until the program is started again."""
    reply: ReplyTimes = field(default_factory=ReplyTimes)
    """How long its replies take."""
    known_register: tuple[int, int] = (3, 0)
    """Function and address with which it can be read."""
    contact: Request | None = None
    """A read that shows whether the adapter hears itself, before anything is written."""
    longest_s: float = 0.0
    """Replies that were given up and came within this (request, wire and all, s) lengthen the time-out; 0 = none."""


@dataclass(slots=True, eq=False)
class Request:
    """A read or a write that the link sends when it is due, again and again."""

    station: Station
    function: int
    address: int
    count: int
    period_s: float
    """Time between two; 0 = with every scan, infinity = once each time it is asked for."""
    slack_s: float
    """How long it may wait for a regular scan before the link asks to be served."""
    frame: bytes = b""
    head: bytes = b""
    """First three bytes of a good reply to a read over RTU (address, function, byte count)."""
    echo: bytes = b""
    """Good reply over RTU to the write that was sent last."""
    confirmation: bytes = b""
    """Good reply over RTU to the write as it would be sent now."""
    block: int = -1
    """Number of the profile's block that it reads again and again; -1 = none of them."""
    reply_length: int = 0
    expected_s: float = 0.0
    """Usual time from sending to the complete reply."""
    timeout_s: float = 0.0
    """Time from sending after which it is given up."""
    reply_wire_s: float = 0.0
    """Time a reply occupies the wire."""
    wire_s: float = 0.0
    """Time that request, silence and reply take on the wire."""
    quiet_s: float = 0.0
    """After a time-out the line must have been quiet for this."""
    values: tuple[int, ...] = ()
    """What is written, one number a register."""
    sent_values: tuple[int, ...] = ()
    """What was written last: new values may come while its reply is under way."""
    due_s: float = inf
    wish_s: float = inf
    """When it will have waited as long as it may."""
    sent_s: float = -inf
    attempts: int = 0
    enabled: bool = False
    fresh: bool = False
    """New values came after the last was sent."""
    writes: bool = False
    """A write, not a read."""

    def describe(self) -> str:
        """Say what it does, for messages to people."""
        what = "writing" if self.writes else "reading"
        return f"{what} {self.count} register{'s' if self.count > 1 else ''} from address {self.address}"
