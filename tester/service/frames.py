"""The frames on the buses, while somebody watches: a log for people, bounded, which costs nothing when it is off."""

from __future__ import annotations

from collections import deque
from typing import Protocol, runtime_checkable

from drivers.ports import CanFrame, CanPort, FrameByFrame, LinePort
from tester.engine.devices import Devices
from tester.service.protocol import Frame, Frames

MOST = 200
"""Frames of one message; five axes at 100 Hz make about 1,500 a second: more than anybody reads."""


class CanFrames:
    """Takes CAN frames; a tap of a simulated wire."""

    def __init__(self, log: FrameLog) -> None:
        """Put them into ``log``."""
        self._log = log

    def frame(self, t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        """Take one frame that was complete at ``t`` s."""
        self._log.add(t, "can", from_pc, can_id, data)


class LineFrames:
    """Takes the frames of one Modbus line; a tap of a simulated wire."""

    def __init__(self, log: FrameLog, line: str) -> None:
        """Put them into ``log`` under the line's name."""
        self._log = log
        self._line = line

    def frame(self, t: float, data: bytes, from_pc: bool) -> None:
        """Take one frame that was complete at ``t`` s."""
        self._log.add(t, self._line, from_pc, data[0] if data else 0, data)


@runtime_checkable
class TapableCan(CanPort, Protocol):
    """A simulated bus, which can be listened to."""

    tap: CanFrames | None


@runtime_checkable
class TapableLine(LinePort, Protocol):
    """A simulated line, which can be listened to."""

    tap: LineFrames | None


class WatchedCan(FrameByFrame):
    """A real CAN port whose frames are seen on their way."""

    def __init__(self, port: CanPort, log: FrameLog) -> None:
        """Wrap ``port``."""
        self.port = port
        self._log = log

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Send and show one frame."""
        self.port.send(can_id, data, now)
        self._log.add(now, "can", True, can_id, data)

    def receive(self, now: float) -> list[CanFrame]:
        """Receive and show."""
        frames = self.port.receive(now)
        for t, can_id, data in frames:
            self._log.add(t, "can", False, can_id, data)
        return frames


class WatchedLine:
    """A real line whose bytes are seen on their way."""

    def __init__(self, port: LinePort, log: FrameLog, line: str) -> None:
        """Wrap ``port``."""
        self.port = port
        self._log = log
        self._line = line

    def write(self, data: bytes, now: float) -> None:
        """Write and show."""
        self.port.write(data, now)
        self._log.add(now, self._line, True, data[0] if data else 0, data)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Read and show."""
        chunks = self.port.read(now)
        for t, data in chunks:
            self._log.add(t, self._line, False, data[0] if data else 0, data)
        return chunks


class FrameLog:
    """The frames since the last message, the oldest dropped where there are too many."""

    def __init__(self, devices: Devices, line_names: tuple[str, ...]) -> None:
        """Nothing is watched before ``watch``. ``line_names``: in the order of ``devices.lines``."""
        self._devices = devices
        self._names = line_names
        self._frames: deque[tuple[float, str, bool, int, bytes]] = deque(maxlen=MOST)
        self._seen = 0
        self.watching = False

    def add(self, t: float, bus: str, sent: bool, ident: int, data: bytes) -> None:
        """Take one frame."""
        self._seen += 1
        self._frames.append((t, bus, sent, ident, data))

    def take(self) -> Frames | None:
        """Return what came since the last call, None for nothing."""
        if not self._seen:
            return None
        frames = tuple(Frame(t, bus, sent, ident, data.hex(" ")) for t, bus, sent, ident, data in self._frames)
        made = Frames(frames, self._seen - len(frames))
        self._frames.clear()
        self._seen = 0
        return made

    def watch(self, on: bool) -> None:
        """Begin or end to listen; between two ticks only."""
        if on == self.watching:
            return
        self.watching = on
        devices = self._devices
        can = devices.can
        if isinstance(can, TapableCan):
            can.tap = CanFrames(self) if on else None
        elif isinstance(can, WatchedCan):
            devices.can = can.port
        elif on:
            devices.can = WatchedCan(can, self)
        for place, (port, link) in enumerate(devices.lines):
            if isinstance(port, TapableLine):
                port.tap = LineFrames(self, self._names[place]) if on else None
            elif isinstance(port, WatchedLine):
                devices.lines[place] = (port.port, link)
            elif on:
                devices.lines[place] = (WatchedLine(port, self, self._names[place]), link)
