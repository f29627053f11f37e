"""Doors on pseudo-terminals: an slcan adapter for the CAN bus, a serial port for a Modbus line."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf
from pathlib import Path

from drivers.ports import BusLost
from sim.servers.doors import Place, Readable
from sim.servers.pty import Pty
from sim.servers.rtu import RtuEar
from sim.servers.slcan import SlcanSession
from sim.wires.can_wire import CanWire
from sim.wires.modbus_wire import ModbusWire

ADAPTER_BAUD = 115200
"""Baud rate of the adapter's port before a program sets it, bit/s. It does not limit the characters: adapters of today
are USB devices, which ignore it; an adapter on a real serial port of this rate carries 400 frames a second."""
REMEMBERED_S = 1.0
"""Time without a request after which a program counts as gone, s [A]: a serial port does not report it."""


class SlcanDoor:
    """The CAN bus behind a serial adapter, for one program: a second one on the device would take its bytes away."""

    def __init__(self, wire: CanWire, link: Path | None = None) -> None:
        """Wait with the channel closed; raises OSError if there is no pseudo-terminal."""
        self.pty = Pty(ADAPTER_BAUD, link)
        self.session = SlcanSession(wire.bitrate)
        self._wire = wire

    @property
    def place(self) -> Place:
        """Its address: a device."""
        return Place("slcan", self.pty.name)

    @property
    def taken(self) -> bool:
        """Whether the channel is open."""
        return self.session.is_open

    @property
    def due_s(self) -> float:
        """Arrival of the next frame for the program, s."""
        return self._wire.arrives_s if self.session.is_open else inf

    def sources(self) -> Sequence[Readable]:
        """Return the device."""
        return [self.pty]

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Put the program's frames on the bus."""
        if self.pty not in ready:
            return
        was_open = self.session.is_open
        try:
            for can_id, data in self.session.feed(self.pty.read()):
                self._wire.send(can_id, data, now)
        except BusLost:
            self.session.is_open = False  # the adapter has lost its bus: it sends nothing more
        if was_open and not self.session.is_open:
            self.pty.forget()

    def deliver(self, now: float) -> None:
        """Send the frames that have arrived; with the channel closed they are dropped."""
        try:
            self.session.relay(self._wire.receive(now))
        except BusLost:
            self.session.is_open = False
        self.pty.write(self.session.outgoing)
        self.session.outgoing.clear()

    def close(self) -> None:
        """Close it."""
        self.pty.close()


class RtuDoor:
    """A Modbus line behind a serial port, with the line's own times; bytes at another baud rate are garbled."""

    def __init__(self, wire: ModbusWire, baud: int, link: Path | None = None) -> None:
        """Listen; ``baud`` is the line's, bit/s. Raises OSError if there is no pseudo-terminal."""
        self.pty = Pty(baud, link)
        self.ear = RtuEar(wire)
        self._baud = baud
        self._heard_s = -inf
        self._now_s = 0.0

    @property
    def place(self) -> Place:
        """Its address: a device."""
        return Place("Modbus RTU", self.pty.name)

    @property
    def taken(self) -> bool:
        """Whether a program has sent a request lately."""
        return self._now_s - self._heard_s < REMEMBERED_S

    @property
    def due_s(self) -> float:
        """Time when a request ends or a reply arrives, s."""
        return self.ear.due_s

    def sources(self) -> Sequence[Readable]:
        """Return the device."""
        return [self.pty]

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Process the program's bytes."""
        if self.pty in ready:
            self.ear.hear(self.pty.read(), now, understood=self.pty.baud in (self._baud, 0))
            self._heard_s = now

    def deliver(self, now: float) -> None:
        """Send the bytes that have arrived on the line."""
        self._now_s = now
        self.pty.write(self.ear.serve(now))

    def close(self) -> None:
        """Close it."""
        self.pty.close()
