"""The frames on the buses, while a client watches: a bounded log for people, free of cost while off."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from functools import partial

from drivers.ports import CanPort, LinePort, Unwatch
from tester.service.protocol import Frame, Frames

MOST = 200
"""Frames in a message; five axes at 100 Hz make about 1,500 a second, more than anyone can read."""


class FrameLog:
    """The frames since the last message; if there are too many, the oldest are dropped."""

    def __init__(self, can: CanPort, lines: Mapping[str, LinePort]) -> None:
        """Watch nothing before ``watch``. ``lines`` by their names in the rig file."""
        self._can = can
        self._lines = dict(lines)
        self._frames: deque[tuple[float, str, bool, int, bytes]] = deque(maxlen=MOST)
        self._seen = 0
        self._watched: list[Unwatch] = []

    @property
    def watching(self) -> bool:
        """Whether frames are recorded."""
        return bool(self._watched)

    def watch(self, on: bool) -> None:
        """Start or stop recording; call between two ticks only."""
        if on and not self._watched:
            lines = [line.watch(partial(self._on_line, name)) for name, line in self._lines.items()]
            self._watched = [self._can.watch(self._on_can), *lines]
        elif not on:
            for unwatch in self._watched:
                unwatch()
            self._watched = []

    def take(self) -> Frames | None:
        """Return the frames since the last call, None without any."""
        if not self._seen:
            return None
        frames = tuple(Frame(t, bus, sent, ident, data.hex(" ")) for t, bus, sent, ident, data in self._frames)
        message = Frames(frames, self._seen - len(frames))
        self._frames.clear()
        self._seen = 0
        return message

    def _on_can(self, t: float, can_id: int, data: bytes, sent: bool) -> None:
        self._seen += 1
        self._frames.append((t, "can", sent, can_id, data))

    def _on_line(self, line: str, t: float, data: bytes, sent: bool) -> None:
        """Record a piece of a line's traffic; its first byte is the station's address."""
        self._seen += 1
        self._frames.append((t, line, sent, data[0] if data else 0, data))
