"""A CANopen node of any kind, as its master serves it."""

from __future__ import annotations

from math import inf

from drivers.canopen import objects as o
from drivers.canopen.conversation import AwaitedCondition
from drivers.canopen.heartbeat import HeartbeatMonitor


class CanNode:
    """One node of a bus, as its master reads and commands it.

    ``connected``: the node is configured, and its frames are believed. ``online``: connected, OPERATIONAL and with a
    heartbeat. ``lost``: the heartbeat stopped, or the node booted while in use; this stays until the next connect.
    ``stamp_s`` is the arrival of its last TPDO1, -inf before the first; bytes equal to ``tpdo1_data`` renew the stamp
    and are not decoded. ``dirty``: its RPDO1 has to be composed anew. ``has_outputs``: the master asks for its RPDO2 in
    every scan. ``place``: its place among the nodes of its master. ``refused`` is the reason why the node cannot be
    used, None if it can.
    """

    __slots__ = ("booted", "connected", "dirty", "has_outputs", "heartbeat", "lost", "malformed", "name", "nmt_state",
                 "node_id", "online", "place", "refused", "rpdo1_id", "rpdo2_id", "stamp_s", "tpdo1_data",
                 "usual_heartbeat")

    def __init__(self, name: str, node_id: int, heartbeat_s: float, has_outputs: bool = False) -> None:
        """Know nothing of the node yet; ``heartbeat_s`` is the period of its heartbeat."""
        self.name = name
        self.node_id = node_id
        self.has_outputs = has_outputs
        self.rpdo1_id = o.RPDO1_BASE + node_id
        self.rpdo2_id = o.RPDO2_BASE + node_id
        self.heartbeat = HeartbeatMonitor(heartbeat_s)
        self.usual_heartbeat = b""
        self.tpdo1_data = b""
        self.stamp_s = -inf
        self.nmt_state = -1
        self.booted = False
        self.connected = False
        self.online = False
        self.lost = False
        self.dirty: int = False
        self.malformed: int = 0
        self.place: int = 0
        self.refused: str | None = None

    def emit(self, sync: bool) -> bytes | None:
        """Return RPDO1 for this scan, None if the node takes none; ``sync``: a SYNC follows."""
        self.dirty = False
        return None

    def emit_outputs(self, now: float) -> bytes | None:
        """Return RPDO2 if it is to be sent now, else None."""
        return None

    def on_tpdo1(self, t: float, data: bytes) -> None:
        """Decode a TPDO1 that arrived at ``t``."""

    def on_tpdo2(self, t: float, data: bytes) -> None:
        """Decode a TPDO2 that arrived at ``t``."""

    def on_emergency(self, t: float, data: bytes) -> None:
        """Record an EMCY message that arrived at ``t``."""

    def on_heartbeat(self, t: float, nmt_state: int) -> None:
        """Record a heartbeat or boot-up message that arrived at ``t``."""
        self.nmt_state = nmt_state
        if nmt_state == o.NmtState.BOOT_UP:
            self.booted = True
            if self.connected:
                self.lost = True
                self.disconnect()
        self.heartbeat.arrived(t)
        self.online = self.connected and not self.lost and nmt_state == o.NmtState.OPERATIONAL

    def check_heartbeat(self, now: float) -> None:
        """Call the node lost when its heartbeat is overdue."""
        if self.heartbeat.expired(now):
            self.lost = True
            self.online = False
            self.usual_heartbeat = b""

    def disconnect(self) -> None:
        """Accept no frames any more; the readings stay, and age."""
        self.connected = False
        self.online = False
        self.tpdo1_data = self.usual_heartbeat = b""
        self.heartbeat.disarm()

    def holds(self, condition: AwaitedCondition) -> bool:
        """Return whether a condition that a conversation waits for is true."""
        if condition is AwaitedCondition.BOOTED:
            return self.booted
        return condition is AwaitedCondition.OPERATIONAL and self.nmt_state == o.NmtState.OPERATIONAL
