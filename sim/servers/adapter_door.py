"""A door on a real CAN interface: the simulated nodes as nodes of that bus, over python-can.

On SocketCAN any number of programs may share the bus with these nodes, so the door is for tests of a second master. The
transmission times of the real bus add to the simulated times; a program's frames also occupy the simulated wire.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

from drivers.ports import BusLost
from sim.servers.doors import Place, Readable
from sim.wires.can_wire import CanWire

if TYPE_CHECKING:
    import can

POLL_S = 0.001
"""Period of polling an interface that ``select`` cannot wait for, s [A]."""
MOST_AT_ONCE = 256
"""Frames read in one turn: the rest waits for the next turn."""
REMEMBERED_S = 0.5
"""Time without a frame after which no program counts as present, s [A]: a master's heartbeats come more often."""
_STANDARD = 0x7FF


class AdapterDoor:
    """The simulated nodes on a bus of python-can.

    ``ignored`` counts frames that the simulated bus does not carry (29-bit, remote, FD and error frames), ``unsent``
    frames that the interface did not accept.
    """

    def __init__(self, wire: CanWire, interface: str, channel: str) -> None:
        """Open the interface at the bit rate of ``wire``; raises OSError."""
        import can

        self._errors = (can.CanError, OSError, ValueError)
        try:
            self._bus: can.BusABC = can.Bus(
                interface=interface, channel=channel, bitrate=wire.bitrate, receive_own_messages=False,
                ignore_config=True,
            )  # fmt: skip
        except (*self._errors, ImportError, NotImplementedError) as error:
            raise OSError(f"CAN interface {interface} {channel}: {error}") from error
        self._message: Any = can.Message
        self._wire = wire
        self._name = (interface, channel)
        self._waits = _selectable(self._bus)
        self._due_s = 0.0 if not self._waits else inf
        self._heard_s = -inf
        self._now_s = 0.0
        self.ignored = 0
        self.unsent = 0

    @property
    def place(self) -> Place:
        """Its address: a channel of an interface."""
        return Place(*self._name)

    @property
    def taken(self) -> bool:
        """Whether a program has sent a frame lately."""
        return self._now_s - self._heard_s < REMEMBERED_S

    @property
    def due_s(self) -> float:
        """Time when a frame of a simulated node arrives, or the interface is polled again, s."""
        return min(self._wire.arrives_s, self._due_s)

    def sources(self) -> Sequence[Readable]:
        """Return the bus, if ``select`` can wait for it."""
        return [self._bus] if self._waits else []

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Pass received frames to the simulated nodes."""
        if self._waits and self._bus not in ready:
            return
        self._now_s = now
        try:
            for _ in range(MOST_AT_ONCE):
                message = self._bus.recv(0.0)
                if message is None:
                    break
                self._hear(message, now)
        except self._errors:
            pass  # the interface is down: no frame comes until it is up again
        if not self._waits:
            self._due_s = now + POLL_S

    def _hear(self, message: can.Message, now: float) -> None:
        special = message.is_extended_id or message.is_remote_frame or message.is_error_frame or message.is_fd
        if special or message.arbitration_id > _STANDARD:
            self.ignored += 1
            return
        self._heard_s = now
        try:
            self._wire.send(message.arbitration_id, bytes(message.data), now)
        except BusLost:
            self.ignored += 1

    def deliver(self, now: float) -> None:
        """Send the frames that the simulated nodes have sent by now."""
        self._now_s = now
        try:
            frames = self._wire.receive(now)
        except BusLost:
            return
        for _, can_id, data in frames:
            try:
                self._bus.send(self._message(arbitration_id=can_id, data=data, is_extended_id=False), timeout=0)
            except self._errors:
                self.unsent += 1

    def close(self) -> None:
        """Close the interface."""
        self._bus.shutdown()


def _selectable(bus: can.BusABC) -> bool:
    """Return whether ``select`` can wait for a bus: SocketCAN's and the virtual ones over UDP are sockets."""
    try:
        return bus.fileno() >= 0
    except NotImplementedError:
        return False
