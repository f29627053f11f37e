"""Listeners of a simulated CAN bus, and the cycle of frames that all of them have processed already."""

from __future__ import annotations

from itertools import accumulate
from math import inf

from drivers.canopen.objects import SYNC_ID
from sim.wires.can_traffic import Listener, SyncFollower, WiredNode


def _rank(entry: tuple[int, object]) -> int:
    return entry[0]


class CanListeners:
    """The nodes of a bus and their listeners; the bus itself (``sim.wires.can_wire.CanWire``) calls them."""

    __slots__ = (
        "_cycle_ids",
        "_cycle_listeners",
        "_cycle_s",
        "_cycled_s",
        "_followers",
        "_frame_s",
        "_offsets_s",
        "_ranked",
        "_ranked_followers",
        "_repeatable",
        "_routes",
        "_skipped_s",
        "_taken",
        "nodes",
    )

    def __init__(self, frame_s: tuple[float, ...]) -> None:
        """Begin without listeners; ``frame_s``: time of a frame on the wire, s, by its number of bytes."""
        self.nodes: list[WiredNode] = []
        self._frame_s = frame_s
        self._routes: dict[int, tuple[Listener, ...]] = {}
        self._ranked: dict[int, list[tuple[int, Listener]]] = {}
        self._followers: tuple[SyncFollower, ...] = ()
        self._ranked_followers: list[tuple[int, SyncFollower]] = []
        self._repeatable: set[int] = set()
        self._taken: tuple[bytes, ...] | None = None  # payloads of a cycle that every listener has processed
        self._cycle_ids: tuple[int, ...] = ()
        self._cycle_listeners: list[tuple[Listener, ...]] = []
        self._cycle_s = 0.0
        self._cycled_s = -inf  # when that cycle was last skipped by all listeners
        self._skipped_s: dict[int, float] = {}  # the same for frames of earlier cycles
        self._offsets_s: tuple[float, ...] = ()

    def frame_s(self, length: int) -> float:
        """Return the time of a frame with so many bytes on the wire, s."""
        return self._frame_s[length]

    def attach(self, node: WiredNode) -> None:
        """Add a node to ``nodes``; it subscribes to identifiers by ``listen``."""
        self.nodes.append(node)

    def listen(self, can_id: int, listener: Listener, rank: int = 0, *, repeatable: bool = False) -> None:
        """Call ``listener`` for every frame of the computer with this identifier.

        Listeners are called in the order of ``rank``: nodes that answer a broadcast at the same time pass their
        node id, because the lowest identifier wins the wire. ``repeatable``: the listener ignores unchanged data, so it
        need not be called for them (``forget_cycle``) and asks for their time (``skipped_s``).
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
        """Make every listener process the next cycle, whatever its content."""
        if self._taken is not None:
            for can_id in self._cycle_ids:
                self._skipped_s[can_id] = self._cycled_s
            self._taken = None

    def skipped_s(self, can_id: int) -> float:
        """Return when a frame last skipped its ``repeatable`` listeners because it held nothing new, s; or -inf."""
        if self._taken is not None and can_id in self._cycle_ids:
            return self._cycled_s
        return self._skipped_s.get(can_id, -inf)

    def follow(self, follower: SyncFollower, rank: int) -> None:
        """Add a device that answers SYNC, in the order of ``rank`` (its node id)."""
        self._ranked_followers.append((rank, follower))
        self._ranked_followers.sort(key=_rank)
        self._adopt_followers(self._ranked_followers)
        self.forget_cycle()

    def unfollow(self, follower: SyncFollower) -> None:
        """Remove a device that answers SYNC; nothing happens if it did not."""
        self._ranked_followers = [entry for entry in self._ranked_followers if entry[1] is not follower]
        self._adopt_followers(self._ranked_followers)
        self.forget_cycle()

    def _route(self, can_id: int, ranked: list[tuple[int, Listener]]) -> None:
        """Apply the new listeners of an identifier."""
        self._routes[can_id] = tuple(entry[1] for entry in ranked)

    def _adopt_followers(self, ranked: list[tuple[int, SyncFollower]]) -> None:
        """Apply the new devices that answer SYNC."""
        self._followers = tuple(entry[1] for entry in ranked)

    def _remember(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...]) -> None:
        """Record a cycle that was processed, if its frames can be skipped while they stay the same."""
        self.forget_cycle()
        if not can_ids or can_ids[-1] != SYNC_ID or self._routes.get(SYNC_ID):
            return
        if all(can_id in self._repeatable or not self._routes.get(can_id) for can_id in can_ids[:-1]):
            self._cycle_ids = can_ids
            self._taken = payloads
            self._cycle_listeners = [self._routes.get(can_id, ()) for can_id in can_ids]
            self._offsets_s = tuple(accumulate(self._frame_s[len(data)] for data in payloads))
            self._cycle_s = self._offsets_s[-1]
