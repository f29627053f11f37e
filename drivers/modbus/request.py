"""Stations (slaves as seen from here) of a Modbus line, their reply times, and the requests to them.

A reply time covers the whole way: the device's own turnaround, the adapter (a USB adapter's latency timer
holds characters back, usually for 16 ms), the operating system, and the interval between two looks at the line.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Final, Protocol

from drivers.profiles.model import Timing

REPLIES: Final = 5
"""Number of replies measured when a station is connected [A]."""
UNMEASURED_S: Final = 0.1
"""Time-out of a reply beyond its wire time, s, until reply times are known [A]: six latency timers of
16 ms. A slower line is as good as silent."""
REPLY_FACTOR: Final = 1.5
"""Time-out of a reply as a multiple of the longest measured [A]. A USB adapter's timer adds 0 to 16 ms by chance, so
the longest of five is above 10 ms in 99 of 100 cases. Bounds: the profile's own limit and UNMEASURED_S."""


class ReplyTimes:
    """Measured times from the end of a request to the start of its reply, s.

    ``count`` replies were measured, ``least_s`` to ``greatest_s``; ``measured``: there are enough.
    """

    def __init__(self) -> None:
        """Begin without measurements."""
        self.forget()

    def forget(self) -> None:
        """Measure anew, from the next reply on."""
        self.count = 0
        self.least_s = inf
        self.greatest_s = 0.0
        self.total_s = 0.0
        self.measured = False

    def note(self, seconds: float) -> None:
        """Record a reply's time, s."""
        self.count += 1
        self.total_s += seconds
        self.least_s = min(self.least_s, seconds)
        self.greatest_s = max(self.greatest_s, seconds)
        self.measured = self.count >= REPLIES

    @property
    def mean_s(self) -> float:
        """Mean of the measured times, s; 0 before the first reply."""
        return self.total_s / self.count if self.count else 0.0

    def limit_s(self, timing: Timing) -> float:
        """Return the time-out of a reply beyond its wire time, s."""
        if not self.measured:
            return max(timing.reply_max_s, UNMEASURED_S)
        return max(timing.reply_max_s, min(REPLY_FACTOR * self.greatest_s, UNMEASURED_S))


class Owner(Protocol):
    """The driver behind a station; it receives the outcome of its requests."""

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Process the registers of a good reply (empty for a write) that arrived at ``t`` s."""
        ...

    def missed(self) -> None:
        """Act on a reply that did not come, of a station that is not lost: it may have begun anew."""
        ...

    def lost(self, t: float) -> None:
        """Act on a station that has stopped answering, or to which a write does not get through."""
        ...


@dataclass(slots=True)
class Counters:
    """Events on the line with one slave since the start."""

    requests: int = 0
    replies: int = 0
    timeouts: int = 0
    crc_errors: int = 0
    garbage: int = 0
    """Pieces that were no reply: wrong address, incomplete, noise."""
    late: int = 0
    """Replies to a request that had been given up, or to an older request than the last."""
    exceptions: dict[int, int] = field(default_factory=dict[int, int])
    """Number of each exception code."""


@dataclass(slots=True, eq=False)
class Station:
    """One slave: its address, its timing and its record so far."""

    unit_id: int
    timing: Timing
    owner: Owner
    counters: Counters = field(default_factory=Counters)
    misses: int = 0
    """Failed attempts in a row."""
    is_lost: bool = False
    """Whether three attempts in a row failed, of all requests or of one write, or a gateway reported the device absent;
    a good reply ends it."""
    refused: str | None = None
    """Reason why the device cannot be used as configured; it stays until the program restarts."""
    reply: ReplyTimes = field(default_factory=ReplyTimes)
    """Its reply times."""
    known_register: tuple[int, int] = (3, 0)
    """Function and address of a read that it answers."""
    contact: Request | None = None
    """A read that shows whether the adapter hears itself, before anything is written."""
    longest_s: float = 0.0
    """Late replies within this time (request, wire and all, s) lengthen the time-out; 0 = none do."""


@dataclass(slots=True, eq=False)
class Request:
    """A read or a write that the link sends when it is due, again and again."""

    station: Station
    function: int
    address: int
    count: int
    period_s: float
    """Time between two; 0 = with every scan, infinity = once for each demand."""
    slack_s: float
    """Longest wait for a regular scan before the link asks to be served."""
    frame: bytes = b""
    head: bytes = b""
    """First three bytes of a good reply to a read over RTU (address, function, byte count)."""
    echo: bytes = b""
    """Good reply over RTU to the write that was sent last."""
    confirmation: bytes = b""
    """Good reply over RTU to the write with its present values."""
    block: int = -1
    """Number of the profile's block that it polls; -1 = none."""
    reply_length: int = 0
    expected_s: float = 0.0
    """Usual time from sending to the complete reply."""
    timeout_s: float = 0.0
    """Time from sending after which the request is given up."""
    reply_wire_s: float = 0.0
    """Time a reply occupies the wire."""
    wire_s: float = 0.0
    """Time on the wire of request, silence and reply."""
    quiet_s: float = 0.0
    """Time of silence required after a time-out."""
    values: tuple[int, ...] = ()
    """Values to write, one number for each register."""
    sent_values: tuple[int, ...] = ()
    """Values written last: new values may come while its reply is under way."""
    due_s: float = inf
    wish_s: float = inf
    """Time at which it has waited as long as it may."""
    sent_s: float = -inf
    attempts: int = 0
    misses: int = 0
    """Failed attempts in a row of a write."""
    enabled: bool = False
    fresh: bool = False
    """Whether new values came after the last was sent."""
    writes: bool = False
    """Whether this is a write."""

    def describe(self) -> str:
        """Return a description of the request for people."""
        what = "writing" if self.writes else "reading"
        thing = {1: "coil", 2: "input", 5: "coil", 15: "coil"}.get(self.function, "register")
        return f"{what} {self.count} {thing}{'s' if self.count > 1 else ''} from address {self.address}"
