"""A CAN bus without a scheduler: the computer's frames reach the simulated nodes at once, with computed wire times.

A frame that is sent gets its start (when the wire is free) and its arrival (start plus worst-case wire time). The
nodes that listen to its identifier are called with the arrival time, and their answers
are queued for the computer with their own arrival times. Frames that a node sends by itself (heartbeats, emergencies,
delayed answers) wait in time order until the wire is read, so they win and lose the wire in the order of their times.
"""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import deque
from itertools import compress
from math import inf
from operator import is_not
from typing import Final

from drivers.canopen.objects import SYNC_ID
from drivers.ports import BusLost, CanFrame, CanWatcher, Unwatch, add_watcher
from sim.wires.can_listeners import CanListeners
from sim.wires.can_traffic import Beat, frame_bits

_PLACES: Final = range(2048)
"""Places in a cycle: it has a frame of each identifier of 11 bits at most."""
_LOAD_MARK_S: Final = 0.1
"""Resolution in s of the one-second bus load."""


class CanWire(CanListeners):
    """The bus and the computer's port on it (``drivers.ports.CanPort``).

    ``urgent_s`` is the arrival time of the earliest urgent frame not yet received (emergency, boot-up, change of a
    drive's state, input change), infinity if there is none. ``ready_s`` is the time when the next frame that a node
    sends by itself needs the wire. ``watchers`` are called for every frame in both directions, with its arrival.
    """

    __slots__ = (
        "_beats",
        "_busy_s",
        "_inbox",
        "_mark_due_s",
        "_marks",
        "_pending",
        "_sequence",
        "_urgent",
        "bitrate",
        "connected",
        "occupied_s",
        "ready_s",
        "urgent_s",
        "watchers",
    )

    def __init__(self, bitrate: int = 500_000) -> None:
        """Create an idle bus; ``bitrate`` in bit/s."""
        super().__init__(tuple(frame_bits(length) / bitrate for length in range(9)))
        self.bitrate = bitrate
        self.watchers: list[CanWatcher] = []
        self.urgent_s = inf
        self.ready_s = inf
        self.connected = True
        self.occupied_s = 0.0
        self._busy_s = -inf
        self._inbox: list[CanFrame] = []
        self._pending: list[tuple[float, int, int, bytes, bool]] = []
        self._beats: list[Beat] = []  # the next one first
        self._sequence = 0
        self._urgent: list[float] = []
        self._marks: deque[tuple[float, float]] = deque()
        self._mark_due_s = -inf

    # the computer's side -------------------------------------------------------------------------------------

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Put a frame on the wire at ``now`` s or when it is free; call every listening node at once.

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
        if self.watchers:
            self._tell(arrival, can_id, data, True)
        listeners = self._routes.get(can_id)
        if listeners is not None:
            for listener in listeners:
                listener(data, arrival)
        if can_id == SYNC_ID:
            self._answer(arrival)

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Send the frames of a bus cycle one after the other.

        A frame that its listeners have processed already only occupies the wire: a drive ignores unchanged process
        data. SYNC is answered as always.
        """
        taken = self._taken
        changed: list[int] = []
        known = taken is not None and (can_ids is self._cycle_ids or can_ids == self._cycle_ids)
        if taken is not None and known and payloads is not taken:
            changed.extend(compress(_PLACES, map(is_not, payloads, taken)))
            for i in changed:
                if len(payloads[i]) != len(taken[i]):
                    known = False  # other lengths, other times
        if not known:
            self._remember(can_ids, payloads)  # before a listener may ask to forget it
            for can_id, data in zip(can_ids, payloads, strict=True):
                self.send(can_id, data, now)
            return
        if not self.connected:
            raise BusLost("the simulated CAN adapter is disconnected")
        if self.ready_s <= now:
            self.settle(now)
        start = self._busy_s if self._busy_s > now else now
        self._cycled_s = self._busy_s = end = start + self._cycle_s
        self.occupied_s += self._cycle_s
        self._taken = payloads
        for i in changed:
            for listener in self._cycle_listeners[i]:
                listener(payloads[i], start + self._offsets_s[i])
        if self.watchers:
            for can_id, data, offset_s in zip(can_ids, payloads, self._offsets_s, strict=True):
                self._tell(start + offset_s, can_id, data, True)
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

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Call ``watcher`` for every frame."""
        return add_watcher(self.watchers, watcher)

    def disconnect(self) -> None:
        """Unplug the computer's adapter: its frames are lost and every call raises BusLost until ``reconnect``."""
        self.connected = False
        self._inbox.clear()
        self._urgent.clear()
        self.urgent_s = inf

    def reconnect(self) -> None:
        """Plug the adapter in again; frames sent meanwhile stay lost."""
        self.connected = True

    # the nodes' side -----------------------------------------------------------------------------------------

    def beat(self, beat: Beat, first_s: float) -> None:
        """Send a node's frame at ``first_s`` s and then in its period, until ``unbeat``."""
        beat.due_s = first_s
        self._queue(beat)
        self._find_ready()

    def unbeat(self, beat: Beat, t: float) -> None:
        """End a periodic frame at ``t`` s; nothing happens if it was not being sent."""
        if self.ready_s <= t:
            self.settle(t)
        self._beats = [other for other in self._beats if other is not beat]
        self._find_ready()

    def transmit(self, can_id: int, data: bytes, t: float, urgent: bool = False) -> None:
        """Send a node's frame to the computer, ready at ``t`` s.

        A frame that is ready while the wire is busy follows at once; a later frame waits for its time. So nodes may
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
        if self.watchers:
            self._tell(arrival, can_id, data, False)
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
        """Earliest arrival of the next frame not received yet, s; infinity when none is under way."""
        arrival = self.ready_s + self._frame_s[0]
        if self._inbox and self._inbox[0][0] < arrival:
            arrival = self._inbox[0][0]
        return arrival

    @property
    def load(self) -> float:
        """Share of the last second that the wire was occupied, 0..1 (worst-case stuffing), as of the last receive."""
        if len(self._marks) < 2:
            return 0.0
        (t0, occupied0), (t1, occupied1) = self._marks[0], self._marks[-1]
        return (occupied1 - occupied0) / (t1 - t0)

    # inner ---------------------------------------------------------------------------------------------------

    def _tell(self, t: float, can_id: int, data: bytes, sent: bool) -> None:
        for watcher in self.watchers:
            watcher(t, can_id, data, sent)

    def _answer(self, t: float) -> None:
        """Let every device answer a SYNC that arrived at ``t`` s; the lowest identifier is first."""
        if self.watchers or not self.connected:
            for follower in self._followers:
                follower.on_sync(t)
            return
        inbox, arrival, occupied_s = self._inbox, self._busy_s, self.occupied_s
        for follower in self._followers:
            if not follower.plain:
                self._busy_s, self.occupied_s = arrival, occupied_s
                left = follower.on_sync(t, True)
                arrival, occupied_s = self._busy_s, self.occupied_s
                if not left:
                    continue
            data = follower.sample
            if follower.stale:
                take = follower.take_sample  # called as a method it is looked up anew (CPython 3.11)
                data = take()
            length_s = follower.sample_s
            arrival += length_s
            occupied_s += length_s
            inbox.append((arrival, follower.sample_id, data))
        self._busy_s, self.occupied_s = arrival, occupied_s

    def settle(self, now: float) -> None:
        """Give the wire to every waiting frame that was ready by ``now`` s, in order of readiness, then identifier."""
        pending, beats = self._pending, self._beats
        frame_s, quick = self._frame_s, self.connected and not self.watchers
        while True:
            first = pending[0] if pending else None
            if beats:
                beat = beats[0]
                due = beat.due_s
                if due <= now and (first is None or (due, beat.can_id) <= first[:2]):
                    del beats[0]
                    beat.due_s = next_s = due + beat.period_s
                    last = beats[-1] if beats else beat
                    if last.due_s < next_s or (last.due_s == next_s and last.can_id <= beat.can_id):
                        beats.append(beat)  # as nearly always
                    else:
                        self._queue(beat)
                    if due < self._busy_s:
                        due = self._busy_s
                    if quick:
                        length_s = frame_s[len(beat.data)]
                        self._busy_s = due = due + length_s
                        self.occupied_s += length_s
                        self._inbox.append((due, beat.can_id, beat.data))
                    else:
                        self._busy_s = due
                        self.transmit(beat.can_id, beat.data, due)
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

    def _queue(self, beat: Beat) -> None:
        """Insert a periodic frame by its time, then its identifier."""
        beats = self._beats
        at = len(beats)
        while at > 0:
            other = beats[at - 1]
            if other.due_s < beat.due_s or (other.due_s == beat.due_s and other.can_id <= beat.can_id):
                break
            at -= 1
        beats.insert(at, beat)

    def _find_ready(self) -> None:
        ready = self._pending[0][0] if self._pending else inf
        self.ready_s = min(ready, self._beats[0].due_s) if self._beats else ready

    def _note_urgent(self, arrival: float) -> None:
        self._urgent.append(arrival)
        if arrival < self.urgent_s:
            self.urgent_s = arrival

    def _find_urgent(self, now: float) -> None:
        """Find the earliest urgent arrival after ``now`` s; waiting frames count with their earliest possible one."""
        self._urgent = [t for t in self._urgent if t > now]
        earliest = min(self._urgent, default=inf)
        if self.connected:
            for t, _, _, data, urgent in self._pending:
                if urgent:
                    earliest = min(earliest, t + self._frame_s[len(data)])
        self.urgent_s = earliest

    def _mark(self, now: float) -> None:
        """Record the occupation so far; drop marks older than one second before ``now``."""
        marks = self._marks
        marks.append((now, self.occupied_s))
        while len(marks) > 2 and marks[1][0] <= now - 1.0 + 1e-9:
            marks.popleft()
        self._mark_due_s = now + _LOAD_MARK_S - 1e-9
