"""A CAN bus in place: the computer's frames reach the simulated nodes at once, with computed wire times.

Nothing is scheduled: a frame that is sent is given its start (when the wire is free) and its arrival (start plus
worst-case wire time), the nodes that listen to its identifier are called with the arrival time, and what they answer
is queued for the computer with its own arrival time. Frames a node sends by itself (heartbeats, emergencies, delayed
answers) wait in time order until the wire is read, so they win and lose the wire in the order of their times.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right, insort
from collections import deque
from collections.abc import Callable
from heapq import heapify, heapreplace
from itertools import accumulate
from math import inf
from typing import Protocol

from drivers.canopen.objects import SYNC_ID
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


class SyncFollower(ABC):
    """A device that answers SYNC.

    ``plain``: nothing but one TPDO goes with the next SYNC: ``sample`` under ``sample_id``, or what ``take_sample``
    returns where it is ``stale``.
    """

    __slots__ = ("plain", "sample", "sample_id", "stale", "take_sample")

    def __init__(self, take_sample: Callable[[], bytes]) -> None:
        """Not ``plain``: answer by ``on_sync``."""
        self.plain = False
        self.stale = True
        self.sample = b""
        self.sample_id = 0
        self.take_sample = take_sample

    @abstractmethod
    def on_sync(self, t: float) -> None:
        """Act on a SYNC that arrived at ``t`` s and answer it."""


class Beat:
    """A frame that a node sends in a fixed period, by itself."""

    __slots__ = ("can_id", "data", "period_s")

    def __init__(self, can_id: int, data: bytes, period_s: float) -> None:
        """Take the identifier, the data and the period in s (> 0)."""
        self.can_id = can_id
        self.data = data
        self.period_s = period_s


def frame_bits(length: int) -> int:
    """Return the worst-case bits of a standard data frame with ``length`` data bytes, intermission included.

    44 bits of frame and 3 of intermission around the data, and one stuff bit for every four of the 34 + 8 n - 1
    stuffable ones (ISO 11898-1; 135 bits at 8 bytes).
    """
    return 47 + 8 * length + (33 + 8 * length) // 4


def _same_shape(frames: tuple[tuple[int, bytes], ...], others: tuple[tuple[int, bytes], ...]) -> bool:
    """Tell whether two cycles have the same identifiers and lengths in the same places: the same times on the wire."""
    if len(frames) != len(others):
        return False
    for one, other in zip(frames, others, strict=True):
        if one is not other and (one[0] != other[0] or len(one[1]) != len(other[1])):
            return False
    return True


def _rank(entry: tuple[int, object]) -> int:
    return entry[0]


class CanWire:
    """The bus and the computer's port on it (``drivers.ports.CanPort``).

    ``urgent_s`` is the arrival time of the earliest urgent frame not yet received (emergency, boot-up, change of a
    drive's state, input change), infinity if there is none. ``ready_s`` is when the next frame that a node sends by
    itself asks for the wire. ``tap`` sees every frame in both directions.
    """

    __slots__ = (
        "_beats",
        "_busy_s",
        "_cycle",
        "_cycle_s",
        "_cycled_s",
        "_followers",
        "_frame_s",
        "_inbox",
        "_mark_due_s",
        "_marks",
        "_offsets_s",
        "_pending",
        "_ranked",
        "_ranked_followers",
        "_repeatable",
        "_routes",
        "_sequence",
        "_skipped_s",
        "_urgent",
        "bitrate",
        "connected",
        "nodes",
        "occupied_s",
        "ready_s",
        "tap",
        "urgent_s",
    )

    def __init__(self, bitrate: int = 500_000) -> None:
        """Create an idle bus; ``bitrate`` in bit/s."""
        self.bitrate = bitrate
        self.nodes: list[CanNode] = []
        self.tap: CanTap | None = None
        self.urgent_s = inf
        self.ready_s = inf
        self.connected = True
        self.occupied_s = 0.0
        self._frame_s = tuple(frame_bits(length) / bitrate for length in range(9))
        self._busy_s = -inf
        self._routes: dict[int, tuple[Listener, ...]] = {}
        self._ranked: dict[int, list[tuple[int, Listener]]] = {}
        self._inbox: list[CanFrame] = []
        self._pending: list[tuple[float, int, int, bytes, bool]] = []
        self._beats: list[tuple[float, int, Beat]] = []  # a heap
        self._followers: tuple[SyncFollower, ...] = ()
        self._ranked_followers: list[tuple[int, SyncFollower]] = []
        self._repeatable: set[int] = set()
        self._cycle: tuple[tuple[int, bytes], ...] | None = None  # that every listener has taken already
        self._cycle_s = 0.0
        self._cycled_s = -inf  # when that cycle last went unheard
        self._skipped_s: dict[int, float] = {}  # the same of frames of earlier cycles
        self._offsets_s: tuple[float, ...] = ()
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
        if self.ready_s <= now:
            self.settle(now)
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
        if can_id == SYNC_ID:
            self._answer(arrival)

    def send_cycle(self, frames: tuple[tuple[int, bytes], ...], now: float) -> None:
        """Send the frames of a bus cycle one after the other.

        A frame that its listeners have taken already only takes its time on the wire: equal process data mean nothing
        new to a drive. SYNC is answered as ever.
        """
        taken = self._cycle
        if taken is None or (frames is not taken and not _same_shape(frames, taken)):
            self._remember(frames)  # before a listener may ask to forget it
            for can_id, data in frames:
                self.send(can_id, data, now)
            return
        if not self.connected:
            raise BusLost("the simulated CAN adapter is disconnected")
        if self.ready_s <= now:
            self.settle(now)
        start = self._busy_s if self._busy_s > now else now
        self._cycled_s = self._busy_s = end = start + self._cycle_s
        self.occupied_s += self._cycle_s
        if frames is not taken:
            self._cycle = frames
            for frame, before, offset_s in zip(frames, taken, self._offsets_s, strict=True):
                if frame is not before:
                    for listener in self._routes.get(frame[0], ()):
                        listener(frame[1], start + offset_s)
        if self.tap is not None:
            for (can_id, data), offset_s in zip(frames, self._offsets_s, strict=True):
                self.tap.frame(start + offset_s, can_id, data, True)
        self._answer(end)

    def receive(self, now: float) -> list[CanFrame]:
        """Return the frames that arrived up to ``now`` s, oldest first; raises BusLost when disconnected."""
        if self.ready_s <= now:
            self.settle(now)
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

    def listen(self, can_id: int, listener: Listener, rank: int = 0, *, repeatable: bool = False) -> None:
        """Call ``listener`` for every frame of the computer with this identifier.

        Listeners are called in the order of ``rank``: nodes that answer a broadcast at the same time give their
        node id, because the lowest identifier wins the wire. ``repeatable``: the same data again mean nothing to the
        listener; it need not be called for them (``forget_cycle``) and asks when they came (``skipped_s``).
        """
        first = not self._routes.get(can_id)
        if repeatable and (first or can_id in self._repeatable):
            self._repeatable.add(can_id)
        else:
            self._repeatable.discard(can_id)
        self.forget_cycle()
        ranked = self._ranked.setdefault(can_id, [])
        ranked.append((rank, listener))
        ranked.sort(key=_rank)
        self._route(can_id, ranked)

    def forget(self, can_id: int, listener: Listener) -> None:
        """Stop calling ``listener`` for this identifier; nothing happens when it was not listening."""
        self.forget_cycle()
        ranked = [entry for entry in self._ranked.get(can_id, ()) if entry[1] != listener]
        self._ranked[can_id] = ranked
        self._route(can_id, ranked)

    def forget_cycle(self) -> None:
        """Have the next cycle taken by every listener, whatever it holds."""
        if self._cycle is not None:
            for can_id, _ in self._cycle:
                self._skipped_s[can_id] = self._cycled_s
            self._cycle = None

    def skipped_s(self, can_id: int) -> float:
        """Return when a frame last went past its ``repeatable`` listeners because it held nothing new, s; or -inf."""
        if self._cycle is not None and any(frame[0] == can_id for frame in self._cycle):
            return self._cycled_s
        return self._skipped_s.get(can_id, -inf)

    def follow(self, follower: SyncFollower, rank: int) -> None:
        """Have a device answer SYNC, in the order of ``rank`` (its node id)."""
        self._ranked_followers.append((rank, follower))
        self._ranked_followers.sort(key=_rank)
        self._adopt_followers(self._ranked_followers)
        self.forget_cycle()

    def unfollow(self, follower: SyncFollower) -> None:
        """Let a device answer SYNC no more; nothing happens when it did not."""
        self._ranked_followers = [entry for entry in self._ranked_followers if entry[1] is not follower]
        self._adopt_followers(self._ranked_followers)
        self.forget_cycle()

    def beat(self, beat: Beat, first_s: float) -> None:
        """Send a node's frame at ``first_s`` s and then in its period, until ``unbeat``."""
        self._beats.append((first_s, beat.can_id, beat))
        heapify(self._beats)
        self._find_ready()

    def unbeat(self, beat: Beat, t: float) -> None:
        """End a periodic frame at ``t`` s; nothing happens when it was not sent."""
        if self.ready_s <= t:
            self.settle(t)
        self._beats = [entry for entry in self._beats if entry[2] is not beat]
        heapify(self._beats)
        self._find_ready()

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
            if t < self.ready_s:
                self.ready_s = t
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
        self.settle(now)
        arrival = max(self._busy_s, now) + self._frame_s[len(data)]
        self._inbox.append((arrival, can_id, data))
        self.send(can_id, data, now)

    # measures ------------------------------------------------------------------------------------------------

    @property
    def arrives_s(self) -> float:
        """Arrival of the next frame not received yet, s: the earliest it can have; infinity when none is under way."""
        arrival = self.ready_s + self._frame_s[0]
        if self._inbox and self._inbox[0][0] < arrival:
            arrival = self._inbox[0][0]
        return arrival

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

    def _adopt_followers(self, ranked: list[tuple[int, SyncFollower]]) -> None:
        """Take over who answers SYNC."""
        self._followers = tuple(entry[1] for entry in ranked)

    def _remember(self, frames: tuple[tuple[int, bytes], ...]) -> None:
        """Note a cycle that was taken, if its frames need not be taken again while they stay the same."""
        self.forget_cycle()
        if not frames or frames[-1][0] != SYNC_ID or self._routes.get(SYNC_ID):
            return
        if all(can_id in self._repeatable or not self._routes.get(can_id) for can_id, _ in frames[:-1]):
            self._cycle = frames
            self._offsets_s = tuple(accumulate(self._frame_s[len(data)] for _, data in frames))
            self._cycle_s = self._offsets_s[-1]

    def _answer(self, t: float) -> None:
        """Have every device answer a SYNC that arrived at ``t`` s; the lowest identifier goes first."""
        inbox, frame_s = self._inbox, self._frame_s
        quick = self.connected and self.tap is None
        arrival = self._busy_s
        for follower in self._followers:
            if quick and follower.plain:
                data = follower.take_sample() if follower.stale else follower.sample
                length_s = frame_s[len(data)]
                arrival += length_s
                self.occupied_s += length_s
                inbox.append((arrival, follower.sample_id, data))
            else:
                self._busy_s = arrival
                follower.on_sync(t)
                arrival = self._busy_s
        self._busy_s = arrival

    def settle(self, now: float) -> None:
        """Give the wire to every waiting frame that was ready by ``now`` s, in order of readiness, then identifier."""
        pending, beats = self._pending, self._beats
        frame_s, quick = self._frame_s[1], self.connected and self.tap is None
        while True:
            first = pending[0] if pending else None
            if beats:
                due, can_id, beat = beats[0]
                if due <= now and (first is None or (due, can_id) <= first[:2]):
                    heapreplace(beats, (due + beat.period_s, can_id, beat))
                    if due < self._busy_s:
                        due = self._busy_s
                    if quick:
                        self._busy_s = due = due + frame_s
                        self.occupied_s += frame_s
                        self._inbox.append((due, can_id, beat.data))
                    else:
                        self._busy_s = due
                        self.transmit(can_id, beat.data, due)
                    continue
            if first is None or first[0] > now:
                break
            t, can_id, _, data, urgent = pending.pop(0)
            if t > self._busy_s:
                self._busy_s = t
            self.transmit(can_id, data, t, urgent)
        self._find_ready()
        if self.urgent_s < inf:
            self._find_urgent(now)

    def _find_ready(self) -> None:
        ready = self._pending[0][0] if self._pending else inf
        self.ready_s = min(ready, self._beats[0][0]) if self._beats else ready

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
