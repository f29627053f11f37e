"""The frames on the buses, while somebody watches: a log for people, bounded, which costs nothing when it is off."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from functools import partial

from drivers.ports import CanPort, LinePort, Unwatch
from tester.service.protocol import Frame, Frames

MOST = 200
"""Frames of one message; five axes at 100 Hz make about 1,500 a second: more than anybody reads."""


class FrameLog:
    """The frames since the last message, the oldest dropped where there are too many."""

    def __init__(self, can: CanPort, lines: Mapping[str, LinePort]) -> None:
        """Nothing is watched before ``watch``. ``lines`` by their names in the rig file."""
        self._can = can
        self._lines = dict(lines)
        self._frames: deque[tuple[float, str, bool, int, bytes]] = deque(maxlen=MOST)
        self._seen = 0
        self._watched: list[Unwatch] = []

    @property
    def watching(self) -> bool:
        """Frames are taken."""
        return bool(self._watched)

    def watch(self, on: bool) -> None:
        """Begin or end to listen; between two ticks only."""
        if on and not self._watched:
            lines = [line.watch(partial(self._on_line, name)) for name, line in self._lines.items()]
            self._watched = [self._can.watch(self._on_can), *lines]
        elif not on:
            for unwatch in self._watched:
                unwatch()
            self._watched = []

    def take(self) -> Frames | None:
        """Return what came since the last call, None for nothing."""
        if not self._seen:
            return None
        frames = tuple(Frame(t, bus, sent, ident, data.hex(" ")) for t, bus, sent, ident, data in self._frames)
        made = Frames(frames, self._seen - len(frames))
        self._frames.clear()
        self._seen = 0
        return made

    def _on_can(self, t: float, can_id: int, data: bytes, sent: bool) -> None:
        self._seen += 1
        self._frames.append((t, "can", sent, can_id, data))

    def _on_line(self, line: str, t: float, data: bytes, sent: bool) -> None:
        """Take a piece of a line's traffic; its first byte is the station's address."""
        self._seen += 1
        self._frames.append((t, line, sent, data[0] if data else 0, data))
