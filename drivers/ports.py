"""Interfaces between drivers and wires: frames or bytes in and out, with time stamps.

A log or a screen that shows the frames of a port watches the port itself; any number may.

A port never blocks. Real ports are in ``drivers.transports``, simulated ones in ``sim``. Times are seconds on the
caller's monotonic clock (simulated or real); the caller passes ``now``, and no port reads a clock for it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from typing import Literal, Protocol, TypeVar, runtime_checkable

CanFrame = tuple[float, int, bytes]
"""(arrival time in s, CAN identifier, data of 0..8 bytes)."""

CanWatcher = Callable[[float, int, bytes, bool], None]
"""Called for each frame: time in s, CAN identifier, data, and whether the computer sent it."""

LineWatcher = Callable[[float, bytes, bool], None]
"""Called for each piece on a line: time of its last byte in s, bytes, and whether the computer sent it."""

Unwatch = Callable[[], None]
"""Ends a watch; calling it again does nothing."""

Watcher = TypeVar("Watcher", CanWatcher, LineWatcher)


class BusLost(Exception):  # noqa: N818 - it names what happened
    """The wire below a port is gone (adapter unplugged, bus-off, socket closed, end of file)."""


class CanPort(Protocol):
    """One CAN adapter."""

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Queue one data frame for transmission; raises BusLost."""
        ...

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Queue the frames of one bus cycle, identifiers and data beside each other, in this order; raises BusLost.

        A payload that is the same object as last time is unchanged: a port may make use of that.
        """
        ...

    def receive(self, now: float) -> list[CanFrame]:
        """Return every frame that arrived up to ``now``, oldest first; raises BusLost."""
        ...

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Call ``watcher`` for every frame in both directions, until the returned function is called."""
        ...


@runtime_checkable
class TellingCanPort(CanPort, Protocol):
    """An adapter that reports error frames, and may know its own state."""

    errors: dict[str, int]
    """Error frames since it was opened, by kind; a frame of two kinds counts for both."""

    @property
    def state(self) -> str:
        """Adapter state: active, passive or error; "" if it is not known."""
        ...


def add_watcher(watchers: list[Watcher], watcher: Watcher) -> Unwatch:
    """Add to a port's watchers; return the function that removes this one."""
    watchers.append(watcher)
    return partial(_drop, watchers, watcher)


def _drop(watchers: list[Watcher], watcher: Watcher) -> None:
    if watcher in watchers:
        watchers.remove(watcher)


class FrameByFrame(ABC):
    """A port that sends the frames of a cycle one by one; subclasses report to the ``watchers``."""

    def __init__(self) -> None:
        """Begin without watchers."""
        self.watchers: list[CanWatcher] = []

    @abstractmethod
    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Queue one data frame for transmission."""

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Queue the frames of one bus cycle."""
        for can_id, data in zip(can_ids, payloads, strict=True):
            self.send(can_id, data, now)

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Call ``watcher`` for every frame."""
        return add_watcher(self.watchers, watcher)

    def tell_sent(self, can_id: int, data: bytes, now: float) -> None:
        """Report a frame that ``send`` handed over to the watchers."""
        for watcher in self.watchers:
            watcher(now, can_id, data, True)

    def tell_received(self, frames: list[CanFrame]) -> None:
        """Report the frames that ``receive`` returns to the watchers."""
        for watcher in self.watchers:
            for t, can_id, data in frames:
                watcher(t, can_id, data, False)


Parity = Literal["N", "E", "O"]
LineFraming = Literal["rtu", "ascii", "socket"]
"""Modbus RTU or ASCII on a serial line, or Modbus TCP. ASCII becomes RTU at the port (drivers.transports)."""
Rts = Literal["", "high", "low"]
"""Level of the RTS line while a port sends; "" = not used."""


def byte_bits(framing: LineFraming, parity: Parity, stop_bits: int = 1) -> int:
    """Return the bits of a frame's byte on a serial line: in ASCII two characters of 10 (Modbus over serial line V1.02,
    2.5.2).
    """
    return 20 if framing == "ascii" else 9 + (parity != "N") + stop_bits


class LineSettings(Protocol):
    """Where a line is, and how its characters are sent."""

    @property
    def port(self) -> str:
        """A serial port, or ``host:port``."""
        ...

    @property
    def framing(self) -> LineFraming:
        """Modbus RTU, ASCII or TCP."""
        ...

    @property
    def baud(self) -> int:
        """Speed, bit/s."""
        ...

    @property
    def parity(self) -> Parity:
        """None, even or odd."""
        ...

    @property
    def stop_bits(self) -> Literal[1, 2]:
        """Stop bits of a character."""
        ...

    @property
    def rts(self) -> Rts:
        """Level of RTS while sending; "" = not used."""
        ...


class LinePort(Protocol):
    """One serial line or TCP connection that carries Modbus."""

    def write(self, data: bytes, now: float) -> None:
        """Queue bytes for transmission; raises BusLost."""
        ...

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return (arrival time of the last byte in s, bytes) for every chunk that arrived up to ``now``."""
        ...

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Call ``watcher`` with all bytes in both directions, until the returned function is called."""
        ...


@runtime_checkable
class RenewablePort(LinePort, Protocol):
    """A line that can be opened anew when its framing is in doubt: a TCP connection."""

    def renew(self, now: float) -> None:
        """Drop the connection with all that is under way, and open another one; raises BusLost."""
        ...


class WatchedLine:
    """Common base of lines: the watchers of their bytes, and advice for a slow adapter (``remedy``)."""

    remedy = ""

    def __init__(self) -> None:
        """Begin without watchers."""
        self.watchers: list[LineWatcher] = []

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Call ``watcher`` with all bytes."""
        return add_watcher(self.watchers, watcher)

    def tell(self, t: float, data: bytes, sent: bool) -> None:
        """Report bytes that were handed over or fetched at ``t`` s to the watchers."""
        for watcher in self.watchers:
            watcher(t, data, sent)


@runtime_checkable
class ForeseeingPort(LinePort, Protocol):
    """A simulated line. Unlike a real line it knows when bytes that are on their way will arrive."""

    arrives_s: float
    """Arrival of the next unread bytes, s: there is nothing to read before it. Infinity when none are on their
    way, -infinity when the line is gone."""
