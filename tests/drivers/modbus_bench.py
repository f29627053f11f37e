"""A line under a Modbus link on which the test plays the slaves, byte by byte."""

from __future__ import annotations

from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink, Request
from drivers.modbus.request import REPLIES
from drivers.ports import BusLost
from drivers.profiles import Timing

TIMING = Timing(turnaround_s=0.001, reply_max_s=0.008, retries=1)
"""Like the load cell: times out after 15.4 ms with 9 registers at 115200 bit/s."""


class Line:
    """Keeps what is written."""

    def __init__(self) -> None:
        self.sent: list[tuple[float, bytes]] = []
        self.lost = False
        self.renewed: list[float] = []

    def renew(self, now: float) -> None:
        self.renewed.append(now)

    def watch(self, watcher: object) -> None:
        raise NotImplementedError

    def write(self, data: bytes, now: float) -> None:
        if self.lost:
            raise BusLost("unplugged")
        self.sent.append((now, data))

    def read(self, now: float) -> list[tuple[float, bytes]]:
        return []


class Notes:
    """A station's owner that keeps what it receives."""

    def __init__(self) -> None:
        self.replies: list[tuple[float, bytes]] = []
        self.requests: list[Request] = []
        self.losses: list[float] = []
        self.misses = 0

    def received(self, request: Request, data: bytes, t: float) -> None:
        self.requests.append(request)
        self.replies.append((t, data))

    def missed(self) -> None:
        self.misses += 1

    def lost(self, t: float) -> None:
        self.losses.append(t)


class Bench:
    """One link, one line, any number of stations."""

    def __init__(self, framing: str = "rtu", baud: int = 115200, *, known: bool = True) -> None:
        """``known``: the adapter does not receive its own frames, and stations answer within their timing."""
        self.link = ModbusLink(framing, baud)  # type: ignore[arg-type]
        self.known = known
        if known:
            self.link.ear.hears_itself = False
        self.line = Line()
        self.notes = Notes()

    def station(self, unit_id: int = 1, timing: Timing = TIMING):
        station = self.link.station(unit_id, timing, self.notes)
        if self.known:
            for _ in range(REPLIES):
                station.reply.note(timing.turnaround_s)
        return station

    def serve(self, now: float, *chunks: tuple[float, bytes], scan: bool = True) -> None:
        """Feed, then service, as every tick does."""
        if chunks:
            self.link.feed(list(chunks), now)
        self.link.service(self.line, now, scan=scan)

    @property
    def frames(self) -> list[bytes]:
        return [data for _, data in self.line.sent]

    @property
    def times(self) -> list[float]:
        return [round(t, 6) for t, _ in self.line.sent]


def reply(*registers: int, unit_id: int = 1, function: int = 3) -> bytes:
    """Return the RTU reply to a read."""
    data = b"".join(value.to_bytes(2, "big") for value in registers)
    return with_crc(bytes((unit_id, function, len(data))) + data)


def refusal(code: int, unit_id: int = 1, function: int = 3) -> bytes:
    """Return the RTU exception reply."""
    return with_crc(bytes((unit_id, function | 0x80, code)))
