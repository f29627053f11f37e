"""A CAN bus in place: the computer's frames reach the simulated nodes at once, with computed wire times.

Nothing is scheduled: a frame that is sent is given its start (when the wire is free) and its arrival (start plus
worst-case wire time), the nodes that listen to its identifier are called with the arrival time, and what they answer
is queued for the computer with its own arrival time. Frames a node sends by itself (heartbeats, emergencies, delayed
answers) wait in time order until the wire is read, so they win and lose the wire in the order of their times.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import deque
from collections.abc import Callable
from math import inf
from typing import Protocol

from drivers.ports import BusLost, CanFrame

Listener = Callable[[bytes, float], None]
"""Called with the data of a frame and its arrival time in s."""

_LOAD_MARK_S = 0.1
"""Resolution in s of the one-second bus load."""


class CanTap(Protocol):
    """Whoever wants to see every frame on the wire (the bus log)."""

    def frame(self, t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        """Take note of a frame that was complete at ``t`` seconds."""
        ...


class CanNode(Protocol):
    """A device on the wire: it is advanced in time and listens through ``CanWire.listen``."""

    due_s: float

    def advance(self, t0: float, t1: float) -> None:
        """Move from ``t0`` to ``t1`` seconds, sending what falls due on the way."""
        ...


def frame_bits(length: int) -> int:
    """Return the worst-case bits of a standard data frame with ``length`` data bytes, intermission included.

    44 bits of frame and 3 of intermission around the data, and one stuff bit for every four of the 34 + 8 n - 1
    stuffable ones (ISO 11898-1; 135 bits at 8 bytes).
    """
    return 47 + 8 * length + (33 + 8 * length) // 4


def _rank(entry: tuple[int, Listener]) -> int:
    return entry[0]


class CanWire:
    """The bus and the computer's port on it (``drivers.ports.CanPort``).

    ``urgent_s`` is the arrival time of the earliest urgent frame not yet received (emergency, boot-up, change of a
    drive's state, input change), infinity if there is none. ``tap`` sees every frame in both directions.
    """

    __slots__ = (
        "_busy_s",
        "_frame_s",
        "_inbox",
        "_mark_due_s",
        "_marks",
        "_pending",
        "_ranked",
        "_routes",
        "_sequence",
        "_urgent",
        "bitrate",
        "connected",
        "nodes",
        "occupied_s",
        "tap",
        "urgent_s",
    )

    def __init__(self, bitrate: int = 500_000) -> None:
        """Create an idle bus; ``bitrate`` in bit/s."""
        self.bitrate = bitrate
        self.nodes: list[CanNode] = []
        self.tap: CanTap | None = None
        self.urgent_s = inf
        self.connected = True
        self.occupied_s = 0.0
        self._frame_s = tuple(frame_bits(length) / bitrate for length in range(9))
        self._busy_s = -inf
        self._routes: dict[int, tuple[Listener, ...]] = {}
        self._ranked: dict[int, list[tuple[int, Listener]]] = {}
        self._inbox: list[CanFrame] = []
        self._pending: list[tuple[float, int, int, bytes, bool]] = []
        self._sequence = 0
        self._urgent: list[float] = []
        self._marks: deque[tuple[float, float]] = deque()
        self._mark_due_s = -inf

    # the computer's side -------------------------------------------------------------------------------------

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Put a frame on the wire at ``now`` s or when it is free; every listening node is called in place.

        Raises BusLost when the adapter is disconnected and ValueError for more than 8 bytes.
        """
        if not self.connected:
            raise BusLost("the simulated CAN adapter is disconnected")
        if self._pending and self._pending[0][0] <= now:
            self._settle(now)
        try:
            length_s = self._frame_s[len(data)]
        except IndexError:
            raise ValueError(f"a CAN frame has at most 8 bytes, not {len(data)}") from None
        start = self._busy_s
        arrival = (start if start > now else now) + length_s
        self._busy_s = arrival
        self.occupied_s += length_s
        if self.tap is not None:
            self.tap.frame(arrival, can_id, data, True)
        listeners = self._routes.get(can_id)
        if listeners is not None:
            for listener in listeners:
                listener(data, arrival)

    def receive(self, now: float) -> list[CanFrame]:
        """Return the frames that arrived up to ``now`` s, oldest first; raises BusLost when disconnected."""
        if self._pending and self._pending[0][0] <= now:
            self._settle(now)
        if not self.connected:
            raise BusLost("the simulated CAN adapter is disconnected")
        if self.urgent_s <= now:
            self._find_urgent(now)
        if now >= self._mark_due_s:
            self._mark(now)
        inbox = self._inbox
        if not inbox:
            return []
        if inbox[-1][0] <= now:
            self._inbox = []
            return inbox
        count = bisect_right(inbox, (now, 0x1FFFFFFF, b""))
        self._inbox = inbox[count:]
        return inbox[:count]

    def disconnect(self) -> None:
        """Unplug the computer's adapter: its frames are lost and every call raises BusLost until ``reconnect``."""
        self.connected = False
        self._inbox.clear()
        self._urgent.clear()
        self.urgent_s = inf

    def reconnect(self) -> None:
        """Plug the adapter in again; what was sent meanwhile stays lost."""
        self.connected = True

    # the nodes' side -----------------------------------------------------------------------------------------

    def attach(self, node: CanNode) -> None:
        """Add a node to ``nodes``; it subscribes to identifiers by ``listen``."""
        self.nodes.append(node)

    def listen(self, can_id: int, listener: Listener, rank: int = 0) -> None:
        """Call ``listener`` for every frame of the computer with this identifier.

        Listeners are called in the order of ``rank``: nodes that answer a broadcast at the same time give their
        node id, because the lowest identifier wins the wire.
        """
        ranked = self._ranked.setdefault(can_id, [])
        ranked.append((rank, listener))
        ranked.sort(key=_rank)
        self._route(can_id, ranked)

    def forget(self, can_id: int, listener: Listener) -> None:
        """Stop calling ``listener`` for this identifier; nothing happens when it was not listening."""
        ranked = [entry for entry in self._ranked.get(can_id, ()) if entry[1] != listener]
        self._ranked[can_id] = ranked
        self._route(can_id, ranked)

    def transmit(self, can_id: int, data: bytes, t: float, urgent: bool = False) -> None:
        """Send a node's frame to the computer, ready to go at ``t`` s.

        A frame ready while the wire is busy follows at once; one ready later waits for its time, so that nodes may
        be advanced one after the other over the same interval.
        """
        start = self._busy_s
        length_s = self._frame_s[len(data)]
        if t > start:
            self._sequence += 1  # equal identifiers keep their order
            insort(self._pending, (t, can_id, self._sequence, data, urgent))
            if urgent and self.connected:
                self.urgent_s = min(self.urgent_s, t + length_s)
            return
        arrival = start + length_s
        self._busy_s = arrival
        self.occupied_s += length_s
        if self.tap is not None:
            self.tap.frame(arrival, can_id, data, False)
        if self.connected:
            self._inbox.append((arrival, can_id, data))
            if urgent:
                self._note_urgent(arrival)

    def inject(self, can_id: int, data: bytes, now: float) -> None:
        """Send a frame of a third party (a second master): the nodes act on it and the computer sees it."""
        self._settle(now)
        arrival = max(self._busy_s, now) + self._frame_s[len(data)]
        self._inbox.append((arrival, can_id, data))
        self.send(can_id, data, now)

    # measures ------------------------------------------------------------------------------------------------

    @property
    def load(self) -> float:
        """Share of the last second the wire was occupied, 0..1 (worst-case stuffing), as of the last receive."""
        if len(self._marks) < 2:
            return 0.0
        (t0, occupied0), (t1, occupied1) = self._marks[0], self._marks[-1]
        return (occupied1 - occupied0) / (t1 - t0)

    # inner ---------------------------------------------------------------------------------------------------

    def _route(self, can_id: int, ranked: list[tuple[int, Listener]]) -> None:
        """Take over who listens to an identifier."""
        self._routes[can_id] = tuple(entry[1] for entry in ranked)

    def _settle(self, now: float) -> None:
        """Give the wire to every waiting frame that was ready by ``now`` s, in order of readiness, then identifier."""
        pending = self._pending
        while pending and pending[0][0] <= now:
            t, can_id, _, data, urgent = pending.pop(0)
            if t > self._busy_s:
                self._busy_s = t
            self.transmit(can_id, data, t, urgent)
        if self.urgent_s < inf:
            self._find_urgent(now)

    def _note_urgent(self, arrival: float) -> None:
        self._urgent.append(arrival)
        if arrival < self.urgent_s:
            self.urgent_s = arrival

    def _find_urgent(self, now: float) -> None:
        """Find the earliest urgent arrival after ``now`` s; waiting frames count with the earliest they can have."""
        self._urgent = [t for t in self._urgent if t > now]
        earliest = min(self._urgent, default=inf)
        if self.connected:
            for t, _, _, data, urgent in self._pending:
                if urgent:
                    earliest = min(earliest, t + self._frame_s[len(data)])
        self.urgent_s = earliest

    def _mark(self, now: float) -> None:
        """Note the occupation so far; marks older than one second before ``now`` go."""
        marks = self._marks
        marks.append((now, self.occupied_s))
        while len(marks) > 2 and marks[1][0] <= now - 1.0 + 1e-9:
            marks.popleft()
        self._mark_due_s = now + _LOAD_MARK_S - 1e-9
