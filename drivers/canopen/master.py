"""The PC's side of one CAN bus: process data of all nodes, heartbeats, and conversations with each of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from drivers.canopen import heartbeat
from drivers.canopen import objects as o
from drivers.canopen.conversation import Conversation, Dialogue

if TYPE_CHECKING:
    from drivers.canopen.node import CanNode
    from drivers.ports import CanFrame, CanPort

EARLY_S: Final = 0.0005
"""Work due within half a millisecond is done at once: this saves a tick and tolerates rounding of times."""

_FUNCTION: Final = 0x780
_NODE: Final = 0x07F
_MASTER_FUNCTIONS: Final = {
    o.RPDO1_BASE: "RPDO1", o.RPDO2_BASE: "RPDO2", o.RPDO3_BASE: "RPDO3", o.RPDO4_BASE: "RPDO4",
    o.SDO_REQUEST_BASE: "SDO request",
}
"""Only masters send this identifier: a received frame comes from another master."""
_SYNC_ID: Final = o.SYNC_ID


class CanMaster:
    """Serves the nodes of one bus; sans-IO: frames and times come in as arguments, frames go out to the port.

    Each tick: ``feed`` the frames that the port received, decide, then ``scan``. Between ticks, at ``deadline`` or when
    frames arrive: ``feed`` and ``service``. Only these two send heartbeats: no scan, no
    heartbeat. Calls that send raise BusLost when the wire is gone.

    ``deadline`` (s) is the earliest time at which the master wants service; a time in the past means "at once".
    ``foreign_master`` is set by the first frame that only a master sends, and ``foreign_frame`` describes
    that frame; the caller clears them. ``unknown_frames`` counts frames of nodes that were not added.
    """

    def __init__(self, node_id: int = 127, heartbeat_s: float = 0.05, sdo_timeout_s: float = 0.3) -> None:
        self.node_id = node_id
        self.heartbeat_s = heartbeat_s
        self.sdo_timeout_s = sdo_timeout_s
        self.sync = True
        self.deadline = -math.inf
        self.foreign_master = False
        self.foreign_frame = ""
        self.unknown_frames = 0
        self.withhold_setpoints = False
        self._heartbeat = (o.HEARTBEAT_BASE + node_id, bytes((o.NmtState.OPERATIONAL,)))
        self._heartbeat_due = -math.inf
        self._withheld = False
        self._commands: list[bytes | None] = []
        self._cycle_ids: tuple[int, ...] = ()
        self._payloads: tuple[bytes, ...] = ()
        self._cycle_syncs = False
        self._nodes: list[CanNode] = []
        self._io_nodes: list[CanNode] = []
        self._by_node: dict[int, CanNode] = {}
        self._tpdo1: dict[int, CanNode] = {}
        self._heartbeats: dict[int, CanNode] = {}
        self._dialogues: dict[int, Dialogue] = {}

    @property
    def nodes(self) -> tuple[CanNode, ...]:
        """The nodes of the bus in the order added."""
        return tuple(self._nodes)

    @property
    def withhold_heartbeat(self) -> bool:
        """Whether our heartbeat is withheld: only to prove that the drives notice (safety.md, principle 4)."""
        return self._withheld

    @withhold_heartbeat.setter
    def withhold_heartbeat(self, withhold: bool) -> None:
        self._withheld = withhold
        self.deadline = -math.inf

    def add(self, node: CanNode) -> None:
        """Add a node to the bus; raises ValueError where its id is taken."""
        node_id = node.node_id
        if node_id == self.node_id or node_id in self._by_node:
            raise ValueError(f"{node.name}: node id {node_id} is taken")
        node.place = len(self._nodes)
        self._nodes.append(node)
        self._commands.append(None)
        if node.has_outputs:
            self._io_nodes.append(node)
        self._by_node[node_id] = node
        self._tpdo1[o.TPDO1_BASE + node_id] = node
        self._heartbeats[o.HEARTBEAT_BASE + node_id] = node

    def start(self, node: CanNode, conversation: Conversation) -> None:
        """Begin a conversation with a node at the next service; raises ValueError while another one runs."""
        if self.busy(node):
            raise ValueError(f"{node.name}: a conversation is still running")
        self._dialogues[node.node_id] = Dialogue(node, conversation, self.sdo_timeout_s)
        self.deadline = -math.inf

    def busy(self, node: CanNode) -> bool:
        """Whether a conversation with this node runs."""
        return node.node_id in self._dialogues

    def cancel(self, node: CanNode) -> None:
        """End this node's conversation at its present step, if one runs."""
        dialogue = self._dialogues.pop(node.node_id, None)
        if dialogue is not None:
            dialogue.close()

    def feed(self, frames: list[CanFrame], now: float) -> None:
        """Take the frames that arrived up to ``now``, oldest first."""
        tpdo1, heartbeats, dialogues = self._tpdo1, self._heartbeats, self._dialogues
        for t, can_id, data in frames:
            node = tpdo1.get(can_id)
            if node is not None:
                if data == node.tpdo1_data:
                    node.stamp_s = t
                else:
                    node.on_tpdo1(t, data)
                continue
            node = heartbeats.get(can_id)
            if node is not None and data == node.usual_heartbeat and not dialogues:
                monitor = node.heartbeat
                monitor.heard_s = t
                monitor.due = t + monitor.timeout_s
            else:
                self._route(t, can_id, data)

    def scan(self, port: CanPort, now: float, until: float = -math.inf) -> None:
        """Send every node's commands, then SYNC (while ``sync``), then what ``service`` sends.

        A heartbeat that would fall due before ``until`` (s), the next scan, leaves with this one. So its period is
        never exceeded, and it needs no tick of its own.
        """
        sync = self.sync
        for node in self._io_nodes:
            outputs = node.emit_outputs(now)
            if outputs is not None:
                port.send(node.rpdo2_id, outputs, now)
        changed = sync is not self._cycle_syncs
        commands = self._commands
        for node in self._nodes:
            if node.dirty:
                changed = True
                place = node.place
                before, command = commands[place], node.emit(sync)
                commands[place] = command
                if before is None or command is None:
                    self._cycle_ids = ()  # another node takes part, or one less
        if changed:
            # Unchanged payloads stay the same object.
            payloads = tuple(filter(None, commands))
            self._payloads = (*payloads, b"") if sync else payloads
            if not self._cycle_ids or sync is not self._cycle_syncs:
                self._compose(sync)
        if not self.withhold_setpoints:
            port.send_cycle(self._cycle_ids, self._payloads, now)
        elif sync:
            port.send(_SYNC_ID, b"", now)
        if self._heartbeat_due < until - EARLY_S:
            self._heartbeat_due = self.deadline = now
        if self._dialogues or now + EARLY_S >= self.deadline:
            self._serve(port, now)

    def _compose(self, sync: bool) -> None:
        """Set the identifiers of the cycle: those of all nodes with a command, and SYNC."""
        self._cycle_syncs = sync
        commanded = zip(self._nodes, self._commands, strict=True)
        can_ids = [node.rpdo1_id for node, command in commanded if command is not None]
        self._cycle_ids = (*can_ids, _SYNC_ID) if sync else tuple(can_ids)

    def service(self, port: CanPort, now: float) -> None:
        """Send our heartbeat when due, continue the conversations, and notice nodes whose heartbeat stopped."""
        if self._dialogues or now + EARLY_S >= self.deadline:
            self._serve(port, now)

    def _serve(self, port: CanPort, now: float) -> None:
        if not self._withheld and now + EARLY_S >= self._heartbeat_due:
            can_id, data = self._heartbeat
            port.send(can_id, data, now)
            self._heartbeat_due = now + self.heartbeat_s
        if self._dialogues:
            self._converse(port, now)
        for node in self._nodes:
            if now >= node.heartbeat.due:
                node.check_heartbeat(now)
        self._set_deadline()

    def _converse(self, port: CanPort, now: float) -> None:
        send = _sender(port, now)
        for node_id, dialogue in list(self._dialogues.items()):
            dialogue.step(now, send)
            if dialogue.ended:
                del self._dialogues[node_id]

    def _set_deadline(self) -> None:
        deadline = math.inf if self._withheld else self._heartbeat_due
        for node in self._nodes:
            if node.heartbeat.due < deadline:
                deadline = node.heartbeat.due
        for dialogue in self._dialogues.values():
            if dialogue.due < deadline:
                deadline = dialogue.due
        self.deadline = deadline

    def _route(self, t: float, can_id: int, data: bytes) -> None:
        """Route a frame that is no TPDO1 of our nodes, by its function code."""
        function = can_id & _FUNCTION
        if can_id in (o.NMT_ID, o.SYNC_ID) or function in _MASTER_FUNCTIONS:
            self._foreign(can_id, data)
            return
        node = self._by_node.get(can_id & _NODE)
        if node is None:
            if can_id == self._heartbeat[0]:
                self._foreign(can_id, data)
            else:
                self.unknown_frames += 1
        elif function == o.HEARTBEAT_BASE:
            self._on_heartbeat(node, t, data)
        elif function == o.SDO_REPLY_BASE:
            dialogue = self._dialogues.get(node.node_id)
            if dialogue is not None:
                dialogue.receive(data)
                self.deadline = min(self.deadline, t)
        elif function == o.TPDO2_BASE:
            node.on_tpdo2(t, data)
        elif function == o.EMERGENCY_BASE:
            node.on_emergency(t, data)
        else:
            self.unknown_frames += 1

    def _on_heartbeat(self, node: CanNode, t: float, data: bytes) -> None:
        state = heartbeat.state_of(data)
        if state is None:
            self.unknown_frames += 1
            return
        node.on_heartbeat(t, state)
        # While the node is online, the same state byte again brings no news.
        node.usual_heartbeat = data if node.online else b""
        if node.node_id in self._dialogues:
            self.deadline = min(self.deadline, t)

    def _foreign(self, can_id: int, data: bytes) -> None:
        if not self.foreign_master:
            name = {o.NMT_ID: "NMT", o.SYNC_ID: "SYNC", self._heartbeat[0]: "heartbeat of our node id"}.get(can_id)
            name = name or _MASTER_FUNCTIONS[can_id & _FUNCTION]
            self.foreign_frame = f"{name} {can_id:03X}#{data.hex().upper()}"
        self.foreign_master = True


def _sender(port: CanPort, now: float) -> Callable[[int, bytes], None]:
    def send(can_id: int, data: bytes) -> None:
        port.send(can_id, data, now)
    return send
