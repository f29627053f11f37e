"""Spoiled replies of Modbus RTU and Modbus TCP; every reply has registers of its own, so that a mix-up shows."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise
from typing import Final

from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink, Request
from drivers.modbus.request import REPLIES
from drivers.ports import LineWatcher, Unwatch
from drivers.profiles import Timing
from tests.campaigns.wire.tally import Tally

COUNT: Final = 9
"""Registers of a read: the load cell's."""
UNIT: Final = 7
TIMING: Final = Timing(turnaround_s=0.001, reply_max_s=0.008, retries=1)
APART_S: Final = 1.0
"""Time between two transactions: the next always begins on a quiet line."""
STEP_S: Final = 0.05

Chunks = list[tuple[float, bytes]]


class Owner:
    """Stores the last value."""

    def __init__(self) -> None:
        self.value: bytes | None = None

    def received(self, request: Request, data: bytes, t: float) -> None:
        self.value = data

    def missed(self) -> None: ...

    def lost(self, t: float) -> None: ...


class Line:
    """Records writes; ``renew`` drops what is still in transit."""

    def __init__(self) -> None:
        self.sent = b""
        self.rest = b""
        """Bytes of an earlier reply that the gateway has yet to send on this connection."""

    def write(self, data: bytes, now: float) -> None:
        self.sent = data

    def read(self, now: float) -> Chunks:
        return []

    def watch(self, watcher: LineWatcher) -> Unwatch:
        raise NotImplementedError

    def renew(self, now: float) -> None:
        self.rest = b""


class Wire:
    """A link and the line under it; a call is one transaction with a spoiled reply."""

    def __init__(self, framing: str, spoilings: dict[str, Callable[[random.Random, bytes, Line], Chunks]]) -> None:
        """Poll one station with known reply times."""
        self.link = ModbusLink(framing)  # type: ignore[arg-type]
        self.link.ear.hears_itself = False
        self.line, self.owner = Line(), Owner()
        station = self.link.station(UNIT, TIMING, self.owner)
        for _ in range(REPLIES):
            station.reply.note(TIMING.turnaround_s)
        self.request = self.link.read(station, 3, 0, COUNT, 0.0)
        self.link.enable(self.request)
        self.spoilings = spoilings
        self.now = 0.0

    def __call__(self, source: random.Random, tally: Tally) -> None:
        """Request, answer, spoil, and compare the accepted value."""
        self._ask()
        data = source.randbytes(2 * COUNT)
        kind = source.choice([*self.spoilings])
        tally.kinds[kind] += 1
        self.owner.value = None
        chunks = self.spoilings[kind](source, self._reply(data), self.line)
        for t, chunk in chunks:
            at = self.now + t
            self.link.feed([(at, chunk)], at)
            self.link.service(self.line, at, scan=False)
        value = self.owner.value
        if value is not None:
            tally.accepted += 1
            if value != data:
                tally.wrong += 1
                tally.blame(f"{kind}: took {value.hex()} for {data.hex()} of {[c.hex() for _, c in chunks]}")

    def _ask(self) -> None:
        """Let the current transaction end, and send the next request."""
        self.now += APART_S
        self.line.sent = b""
        for _ in range(60):
            self.link.service(self.line, self.now)
            if self.line.sent:
                return
            self.now += STEP_S
        raise AssertionError("no request within 3 s")

    def _reply(self, data: bytes) -> bytes:
        body = bytes((UNIT, 3, len(data))) + data
        sent = self.line.sent
        if self.link.framing == "rtu":
            return with_crc(body)
        return sent[:2] + b"\0\0" + len(body).to_bytes(2, "big") + body


def _at_once(data: bytes) -> Chunks:
    return [(0.005, data)]


def _pieces(source: random.Random, data: bytes) -> Chunks:
    cuts = sorted({0, len(data), *(source.randrange(len(data)) for _ in range(source.randint(1, 4)))})
    return [(0.001 * (1 + n), data[a:b]) for n, (a, b) in enumerate(pairwise(cuts))]


def _flipped(source: random.Random, data: bytes, line: Line) -> Chunks:
    # A CRC-16 always detects up to three wrong bits in a frame this short.
    found = bytearray(data)
    for bit in source.sample(range(8 * len(data)), source.randint(1, 3)):
        found[bit // 8] ^= 1 << bit % 8
    return _at_once(bytes(found))


def _burst(source: random.Random, data: bytes, line: Line) -> Chunks:
    # And any burst of up to 16 bits.
    length = source.randint(2, 16)
    at = source.randrange(8 * len(data) - length)
    pattern = (1 | 1 << (length - 1) | source.getrandbits(length)) << at
    found = int.from_bytes(data, "little") ^ pattern
    return _at_once(found.to_bytes(len(data), "little"))


def _cut(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(data[: source.randrange(len(data))])


def _beheaded(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(data[source.randint(1, len(data) - 1) :])


def _split(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _pieces(source, data)


def _twice(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(data + data)


def _twice_apart(source: random.Random, data: bytes, line: Line) -> Chunks:
    return [(0.004, data), (0.005, data)]


def _noise(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(source.randbytes(source.randint(1, 6)) + data)


def _tail(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(data + source.randbytes(source.randint(1, 6)))


def _late(source: random.Random, data: bytes, line: Line) -> Chunks:
    if line.sent[2:4] == b"\0\0" and len(line.sent) == 12:
        line.rest = data
        return []
    return [(0.017, data)]


def _other_unit(source: random.Random, data: bytes, line: Line) -> Chunks:
    return _at_once(with_crc(bytes((data[0] ^ source.randint(1, 255),)) + data[1:-2]))


def _other_length(source: random.Random, data: bytes, line: Line) -> Chunks:
    count = source.choice([n for n in range(1, 20) if n != COUNT])
    return _at_once(with_crc(data[:2] + bytes((2 * count,)) + source.randbytes(2 * count)))


RTU: Final = {
    "bits": _flipped, "burst": _burst, "cut": _cut, "beheaded": _beheaded, "split": _split, "twice": _twice,
    "twice apart": _twice_apart, "noise before": _noise, "noise after": _tail, "late": _late,
    "other unit": _other_unit, "other length": _other_length,
}  # fmt: skip


def _cut_and_on(source: random.Random, data: bytes, line: Line) -> Chunks:
    """Send part of a reply, after any remains of earlier ones; the rest never comes."""
    rest, line.rest = line.rest, b""
    return _at_once(rest + data[: source.randrange(len(data))])


def _cut_and_later(source: random.Random, data: bytes, line: Line) -> Chunks:
    """Send part of a reply; the rest comes before the next one, on the same connection."""
    at = source.randint(1, len(data) - 1)
    line.rest = data[at:]
    return _at_once(data[:at])


def _with_rest(source: random.Random, data: bytes, line: Line) -> Chunks:
    rest, line.rest = line.rest, b""
    return _at_once(rest + data)


def _held(source: random.Random, data: bytes, line: Line) -> Chunks:
    """Keep the reply; it comes in one piece with the next one."""
    line.rest += data
    return []


def _cut_then_whole(source: random.Random, data: bytes, line: Line) -> Chunks:
    return [(0.002, data[: source.randint(1, len(data) - 1)]), (0.004, data)]


def _header(source: random.Random, data: bytes, line: Line) -> Chunks:
    # TCP's own checksum protects the bits in transit; a gateway's mistakes are in the frame's header.
    found = bytearray(data)
    at = source.randrange(9)
    found[at] ^= source.randint(1, 255)
    return _at_once(bytes(found))


def _in_time(source: random.Random, data: bytes, line: Line) -> Chunks:
    return [(0.001 * source.randint(1, 50), data)]


TCP: Final = {
    "cut and goes on": _cut_and_on, "cut, rest later": _cut_and_later, "merged with what was kept": _with_rest,
    "kept": _held, "cut, then whole": _cut_then_whole, "header": _header, "split": _split, "twice": _twice,
    "twice apart": _twice_apart, "noise before": _noise, "noise after": _tail, "late": _late, "in time": _in_time,
    "beheaded": _beheaded,
}  # fmt: skip


def rtu() -> Wire:
    """Return an RTU line."""
    return Wire("rtu", RTU)


def tcp() -> Wire:
    """Return a TCP connection through a gateway that makes mistakes."""
    return Wire("socket", TCP)
