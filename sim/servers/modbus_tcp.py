"""A Modbus TCP gateway in front of a simulated serial line; sans-IO.

Requests are unwrapped (MBAP header off, CRC on) and sent over the line one at a time, with its wire times; replies
return to the client that asked. An absent slave stays silent, as on the line itself: there is no gateway exception.
Source: Modbus messaging on TCP/IP implementation guide V1.0b, 3.1.3.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf, isfinite
from struct import Struct

from drivers.crc16 import crc16, with_crc
from drivers.ports import BusLost
from sim.wires.modbus_wire import ModbusWire

PATIENCE_S = 0.25
"""Longest wait of the gateway for a slave before it serves the next request, s [A]: beyond any profile's time-out."""
MOST_WAITING = 16
"""Greatest number of waiting requests of one client; further requests get no answer."""

_HEADER = Struct(">HHHB")
_SHORTEST, _LONGEST = 2, 254
"""The header's length field counts the unit id and a PDU of 1 to 253 bytes."""
_SHORTEST_REPLY = 5
"""Bytes of the shortest RTU reply, an exception: unit, function, code, CRC."""


class ModbusSession:
    """One client's connection: ``feed`` takes bytes, ``outgoing`` holds replies; ``ended``: reason for its end."""

    def __init__(self) -> None:
        """Wait for requests."""
        self.outgoing = bytearray()
        self.ended = ""
        self._buffer = b""

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """Process the client's bytes; return complete requests as (transaction, unit id and PDU)."""
        requests: list[tuple[int, bytes]] = []
        buffer = self._buffer + data
        while len(buffer) >= _HEADER.size:
            transaction, protocol, length, _ = _HEADER.unpack_from(buffer)
            if protocol != 0 or not _SHORTEST <= length <= _LONGEST:
                self.ended = "sent what is not Modbus TCP"
                return requests
            end = _HEADER.size - 1 + length
            if len(buffer) < end:
                break
            requests.append((transaction, buffer[_HEADER.size - 1 : end]))
            buffer = buffer[end:]
        self._buffer = buffer
        return requests

    def reply(self, transaction: int, frame: bytes) -> None:
        """Queue a reply from its unit id and PDU."""
        self.outgoing += _HEADER.pack(transaction, 0, len(frame), frame[0]) + frame[1:]


@dataclass(slots=True)
class _Transaction:
    session: ModbusSession | None
    """The client that asked; None once it is gone."""
    number: int
    frame: bytes
    until_s: float = inf


class ModbusGateway:
    """One line's gateway: any number of clients, one transaction at a time."""

    def __init__(self, wire: ModbusWire) -> None:
        """Serve the slaves on ``wire``."""
        self.wire = wire
        self._waiting: deque[_Transaction] = deque()
        self._active: _Transaction | None = None
        self._reply = b""

    @property
    def due_s(self) -> float:
        """Time when ``serve`` has work, s; infinity without a request."""
        if self._active is None:
            return -inf if self._waiting else inf
        return min(self._active.until_s, self.wire.arrives_s)

    def take(self, session: ModbusSession, data: bytes, now: float) -> None:
        """Process a client's bytes."""
        waiting = sum(1 for one in self._waiting if one.session is session)
        for number, frame in session.feed(data)[: MOST_WAITING - waiting]:
            self._waiting.append(_Transaction(session, number, with_crc(frame)))
        self.serve(now)

    def forget(self, session: ModbusSession) -> None:
        """Drop the requests of a client that is gone.

        If its request is on the line already and a reply is on its way, the gateway waits for the reply: two may not
        send at once.
        """
        self._waiting = deque(one for one in self._waiting if one.session is not session)
        if self._active is not None and self._active.session is session:
            self._active.session = None
            self._end_if_unheard()

    def _end_if_unheard(self) -> None:
        """End a transaction whose client is gone, once its reply can no longer come."""
        if self._active is not None and self._active.session is None and not isfinite(self.wire.arrives_s):
            self._active = None

    def serve(self, now: float) -> None:
        """Return the replies that have arrived, and send the next request."""
        self._collect(now)
        while self._active is None and self._waiting:
            self._start(self._waiting.popleft(), now)

    def _start(self, transaction: _Transaction, now: float) -> None:
        try:
            self.wire.write(transaction.frame, now)
        except BusLost:
            return  # an unplugged line is silent
        if transaction.frame[0] != 0:  # a broadcast is not answered
            transaction.until_s = now + PATIENCE_S
            self._active, self._reply = transaction, b""

    def _collect(self, now: float) -> None:
        try:
            chunks = self.wire.read(now)
        except BusLost:
            chunks = []
        active = self._active
        if active is None:
            return
        session = active.session
        if session is None:
            self._end_if_unheard()
            return
        for _, chunk in chunks:
            self._reply += chunk
            if len(self._reply) >= _SHORTEST_REPLY and crc16(self._reply) == 0:
                session.reply(active.number, self._reply[:-2])
                self._active = None
                return
        if now >= active.until_s:
            self._active = None
