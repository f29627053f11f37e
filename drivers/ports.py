"""What a driver needs of a wire: frames or bytes in and out, with time stamps.

A port never blocks. Real ports live in ``drivers.edges``; simulated ones in ``sim``. Times are seconds on the
caller's monotonic clock (simulated or real); the caller passes ``now`` and no port reads a clock for it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Protocol, runtime_checkable

CanFrame = tuple[float, int, bytes]
"""(arrival time in s, CAN identifier, data of 0..8 bytes)."""


class BusLost(Exception):  # noqa: N818 - it names what happened
    """The wire below a port is gone (adapter unplugged, bus-off, socket closed, end of file)."""


class CanPort(Protocol):
    """One CAN adapter."""

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Queue one data frame for transmission; raises BusLost."""
        ...

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Queue the frames of one bus cycle, identifiers and data beside each other, in this order; raises BusLost.

        The very same bytes again in a place say that nothing has changed there: a port may make use of that.
        """
        ...

    def receive(self, now: float) -> list[CanFrame]:
        """Return every frame that arrived up to ``now``, oldest first; raises BusLost."""
        ...


class FrameByFrame(ABC):
    """A port that sends the frames of a cycle one by one."""

    __slots__ = ()

    @abstractmethod
    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Queue one data frame for transmission."""

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Queue the frames of one bus cycle."""
        for can_id, data in zip(can_ids, payloads, strict=True):
            self.send(can_id, data, now)


class LinePort(Protocol):
    """One serial line or TCP connection that carries Modbus."""

    def write(self, data: bytes, now: float) -> None:
        """Queue bytes for transmission; raises BusLost."""
        ...

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return (arrival time of the last byte in s, bytes) for every chunk that arrived up to ``now``."""
        ...


@runtime_checkable
class ForeseeingPort(LinePort, Protocol):
    """A simulated line, which knows what a real one cannot: when bytes that are on their way will be there."""

    arrives_s: float
    """Arrival of the next bytes not read yet, s: before it there is nothing to read. Infinity when none are on their
    way, -infinity when the line is gone."""
