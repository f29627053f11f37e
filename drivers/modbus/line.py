"""Properties of a Modbus line: its framing and speed, and from these the bytes and times of every request."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from drivers.modbus import codec
from drivers.modbus.request import Request, Station
from drivers.modbus.schedule import SLACK_S
from drivers.ports import LineFraming, Parity, byte_bits

RTU_MARGIN_S = 0.003
"""Added to an RTU time-out for adapters and operating systems that deliver late [A]."""
SOCKET_MARGIN_S = 0.05
"""Added to a TCP time-out for the network [A]."""


class LineType:
    """Makes requests. ``gap_s`` is the silence in s that ends a frame, 0 on TCP; ``socket``: a TCP connection."""

    def __init__(self, framing: LineFraming, baud: int, parity: Parity, stop_bits: int = 1) -> None:
        """Take the framing; ``baud`` in bit/s, ``parity`` and ``stop_bits`` matter on a serial line only."""
        self.framing: codec.Framing = "socket" if framing == "socket" else "rtu"
        self.socket = framing == "socket"
        self._requests: list[Request] = []
        bits = byte_bits(framing, parity, stop_bits)
        self._character_s = 0.0 if self.socket else bits / baud
        self.gap_s = 0.0 if self.socket else silent_gap_s(bits, baud)

    def read(
        self, station: Station, function: int, address: int, count: int, period_s: float = inf
    ) -> Request:
        """Add a read; it is not sent before it is enabled. ``period_s``: 0 = every scan, infinity = once."""
        slack_s = 0.0 if period_s == inf else SLACK_S if period_s > 0.0 else inf
        request = Request(station, function, address, count, period_s, slack_s)
        request.frame = codec.read_request(self.framing, station.unit_id, function, address, count)
        if not self.socket:
            request.head = bytes((station.unit_id, function, codec.data_length(function, count)))
        return self._timed(request)

    def write(
        self, station: Station, function: int, address: int, values: Sequence[int], renew_s: float = inf
    ) -> Request:
        """Add a write of ``values``, repeated every ``renew_s``; it is not sent before it is enabled."""
        slack_s = 0.0 if renew_s == inf else SLACK_S
        request = Request(station, function, address, len(values), renew_s, slack_s)
        self.load(request, tuple(values))
        return self._timed(request)

    def load(self, request: Request, values: tuple[int, ...]) -> None:
        """Set the ``values`` of a write."""
        unit_id = request.station.unit_id
        request.frame = codec.write_request(self.framing, unit_id, request.function, request.address, values)
        request.values = values
        request.writes = True
        if not self.socket:
            request.confirmation = codec.write_reply(request.frame)

    def _timed(self, request: Request) -> Request:
        """Calculate the times of a request."""
        request.reply_length = codec.reply_length(self.framing, request.function, request.count)
        request.reply_wire_s = request.reply_length * self._character_s
        request.wire_s = len(request.frame) * self._character_s + self.gap_s + request.reply_wire_s
        self._requests.append(request)
        self._judge(request)
        return request

    def _judge(self, request: Request) -> None:
        """Calculate the time-out of a request's reply."""
        station = request.station
        reply = station.reply
        usual_s = max(station.timing.turnaround_s, reply.least_s) if reply.measured else station.timing.turnaround_s
        request.expected_s = request.wire_s + usual_s
        request.quiet_s = limit_s = reply.limit_s(station.timing)
        request.timeout_s = request.wire_s + limit_s + (SOCKET_MARGIN_S if self.socket else RTU_MARGIN_S)

    def measured(self, station: Station) -> None:
        """Use the reply times of a station that were measured by now."""
        for request in self._requests:
            if request.station is station:
                self._judge(request)

    def exchange_s(self, station: Station) -> float:
        """Return the usual time of a station's longest read from request to reply, as measured, s."""
        wire_s = max((one.wire_s for one in self._requests if one.station is station and not one.writes), default=0.0)
        return wire_s + station.reply.greatest_s


def silent_gap_s(character_bits: int, baud: int) -> float:
    """Return the silence in s that ends an RTU frame.

    3.5 characters up to 19200 bit/s, 1.75 ms above (Modbus over serial line V1.02, 2.5.1.1).
    """
    return 3.5 * character_bits / baud if baud <= 19200 else 0.00175
