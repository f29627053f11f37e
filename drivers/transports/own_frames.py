"""Separates our own frames that an interface returns from the frames of others.

Most interfaces return none. Some do (``receive_own_messages``, adapters that report sent frames as received,
bridges that loop), and no mark in a frame shows it: python-can's ``is_rx`` is False for our own frames on some of them,
and for those of other programs of the same computer on SocketCAN (hardbyte/python-can#1274). So a test decides: the
first frame sent is a probe that no other program sends. An interface that returns it returns all our frames.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from drivers.ports import CanFrame

PROBE_ID: Final = 0x6E0
"""Identifier of the probe: no CANopen device uses it (CiA 301, restricted CAN identifiers: 0x6E0 to 0x6FF)."""
SETTLE_S: Final = 0.1
"""Time within which an interface that returns our frames has returned the probe, s [A]: its driver's queue, or a
bridge's network, delays it."""
RETURN_S: Final = 1.0
"""Time after which a frame that has not come back counts as never sent on the bus, s [A]."""


class OwnFrames:
    """``echoes``: whether the interface returns our frames, None until this is known.

    ``returned`` counts our frames that came back, ``unreturned`` those that should have and did not. ``trouble`` is the
    reason why the interface cannot be used, "" if it can.
    """

    def __init__(self, token: bytes) -> None:
        """Prepare the probe; ``token``: eight bytes that no other program uses."""
        self._probe = token
        self._until_s: float | None = None
        self._awaited: deque[tuple[float, int, bytes]] = deque()
        self._held: list[CanFrame] = []
        self.echoes: bool | None = None
        self.returned = 0
        self.unreturned = 0
        self.trouble = ""

    @property
    def probe(self) -> tuple[int, bytes] | None:
        """The probe, while it has to be sent before anything else."""
        return (PROBE_ID, self._probe) if self._until_s is None else None

    def sent(self, can_id: int, data: bytes, now: float) -> None:
        """Record a frame that was handed to the interface at ``now`` s."""
        if self.echoes is False:
            return
        if self._until_s is None:
            self._until_s = now + SETTLE_S
        else:
            self._awaited.append((now, can_id, bytes(data)))

    def others(self, frames: list[CanFrame], now: float) -> list[CanFrame]:
        """Return the frames of others from the frames received up to ``now`` s.

        Until ``echoes`` is known, frames that look like ours are held back: for ``SETTLE_S`` at most.
        """
        if self._until_s is None:
            return frames
        found = [frame for frame in frames if not self._is_own(frame)]
        if self.echoes is None and now >= self._until_s:
            self.echoes = False
            found = sorted([*self._held, *found], key=lambda frame: frame[0])
            self._held.clear()
            self._awaited.clear()
        while self._awaited and self._awaited[0][0] < now - RETURN_S:
            self._awaited.popleft()
            self.unreturned += 1
        return found

    def _is_own(self, frame: CanFrame) -> bool:
        _, can_id, data = frame
        if can_id == PROBE_ID and data == self._probe:
            self._probe_returned()
            return True
        if self.echoes is False:
            return False
        for place, (_, sent_id, sent) in enumerate(self._awaited):
            if sent_id == can_id and sent == data:
                del self._awaited[place]
                if self.echoes is None:
                    self._held.append(frame)
                else:
                    self.returned += 1
                return True
        return False

    def _probe_returned(self) -> None:
        if self.echoes is None:
            self.echoes = True
            self.returned += 1 + len(self._held)
            self._held.clear()
        elif self.echoes:
            self.trouble = "it gives every frame of ours back more than once"
        else:
            self.trouble = f"it gives our own frames back, and later than {1000 * SETTLE_S:g} ms"
