"""The far end of a serial port on a simulated Modbus line; sans-IO.

A pseudo-terminal transfers a whole frame at once; on a real line its characters take time. So the time of each
character is calculated from the line's baud rate. As for a real slave, a request ends with the silence after its last
character. A reply leaves after its last character, at the time that ``ModbusWire`` gives.
"""

from __future__ import annotations

from math import inf

from drivers.ports import BusLost
from sim.wires.modbus_wire import ModbusWire

LONGEST_FRAME = 256
"""Bytes of the longest RTU frame (Modbus over serial line V1.02, 2.5.1): slaves ignore a longer one."""


class RtuEar:
    """Receives the computer's bytes on a line; ``garbled`` counts bytes with other settings than the line's."""

    def __init__(self, wire: ModbusWire) -> None:
        """Listen in front of the slaves on ``wire``."""
        self.wire = wire
        self.garbled = 0
        self._frame = bytearray()
        self._began_s = 0.0
        self._over_s = 0.0

    @property
    def due_s(self) -> float:
        """Time when ``serve`` has work, s: a request ends, or bytes arrive."""
        # An unplugged line has "now" as its time, although no bytes will come.
        arrives_s = self.wire.arrives_s if self.wire.connected else inf
        return self._over_s + self.wire.gap_s if self._frame else arrives_s

    def hear(self, data: bytes, now: float, *, understood: bool = True) -> None:
        """Process bytes that came at ``now`` s; ``understood``: sent with the line's own baud rate."""
        if not data:
            return
        if not understood:
            self.garbled += len(data)
            return
        self.serve_request(now)
        if not self._frame:
            self._began_s = self._over_s = now
        self._over_s = max(self._over_s, now) + len(data) * self.wire.character_s
        self._frame += data

    def serve_request(self, now: float) -> None:
        """Send a request to the slaves once the silence after it is over by ``now`` s."""
        if not self._frame or now < self._over_s + self.wire.gap_s:
            return
        frame = bytes(self._frame)
        self._frame.clear()
        if len(frame) > LONGEST_FRAME:
            self.garbled += len(frame)
            return
        try:
            self.wire.write(frame, self._began_s)
        except BusLost:
            return  # an unplugged line is silent

    def serve(self, now: float) -> bytes:
        """Send a complete request to the slaves, and return the bytes that have arrived for the computer."""
        self.serve_request(now)
        if self._frame and self._began_s < self.wire.arrives_s:
            return b""  # the computer sends while a slave does: the line decides what is left of the reply
        try:
            return b"".join(data for _, data in self.wire.read(now))
        except BusLost:
            return b""
