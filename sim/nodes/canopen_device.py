"""The communication half of a simulated CANopen device (CiA 301): boot-up, NMT, heartbeats, SDO, emergencies.

A subclass (the drive) adds the device's own function: its methods are called on resets, lost connections and process
data.
"""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.canopen import objects as o
from drivers.canopen.objects import NmtCommand, NmtState
from sim.nodes import communication_objects
from sim.nodes.emergencies import Emergencies
from sim.nodes.object_store import ObjectStore
from sim.nodes.pdo_channels import ReceivePdo, TransmitPdo
from sim.nodes.pdo_exchange import RPDO_TIMED_OUT, PdoExchange
from sim.nodes.sdo_server import SdoServer
from sim.wires.can_traffic import Beat
from sim.wires.can_wire import CanWire

HEARTBEAT_LOST: Final = 0x8130
COMMUNICATION_BOOT_S: Final = 0.02
"""Time from a communication reset to the boot-up message, s [A]."""

# NMT states as plain integers for the hot path.
BOOTING: Final = int(NmtState.BOOT_UP)
STOPPED: Final = int(NmtState.STOPPED)
OPERATIONAL: Final = int(NmtState.OPERATIONAL)
PRE_OPERATIONAL: Final = int(NmtState.PRE_OPERATIONAL)


class CanopenDevice:
    """A node on a simulated wire.

    ``due_s`` is the time of its next timer, ``now_s`` the time to which it was advanced. Frames reach it through the
    wire's listeners, SYNC and RPDOs only while OPERATIONAL.
    """

    __slots__ = (
        "_boot_at",
        "_boot_s",
        "_consumer_at",
        "_consumer_heard_s",
        "_consumer_id",
        "_consumer_timeout_s",
        "_heartbeat",
        "_sdo",
        "_turnaround_s",
        "_withheld",
        "due_s",
        "emergencies",
        "nmt",
        "node_id",
        "now_s",
        "pdos",
        "powered",
        "store",
        "wire",
    )

    def __init__(self, wire: CanWire, store: ObjectStore, boot_s: float, turnaround_s: float, now: float) -> None:
        """Put a device on the wire, unpowered; ``boot_s`` and ``turnaround_s`` (of SDO answers) in s."""
        self.wire = wire
        self.store = store
        self.node_id = store.node_id
        self.now_s = now
        self.due_s = inf
        self.powered = False
        self.nmt = BOOTING
        self._boot_s = boot_s
        self._turnaround_s = turnaround_s
        self._consumer_id = 0
        self._consumer_timeout_s = 0.0
        self._consumer_heard_s = -inf
        self._boot_at = self._consumer_at = inf
        self._heartbeat = Beat(o.HEARTBEAT_BASE + self.node_id, b"\0", inf)
        self._withheld = False
        self._sdo = SdoServer(store)
        self.emergencies = Emergencies(wire, store)
        self.pdos = PdoExchange(self, wire, store)
        communication_objects.install(store)
        store.hooks[o.CONSUMER_HEARTBEAT] = self._on_consumer_written
        store.hooks[o.PRODUCER_HEARTBEAT] = self._on_producer_written
        wire.attach(self)
        wire.listen(o.NMT_ID, self._on_nmt, self.node_id)
        wire.listen(o.SDO_REQUEST_BASE + self.node_id, self._on_sdo, self.node_id)

    # hooks for a subclass ------------------------------------------------------------------------------------

    def process(self, t: float) -> None:
        """Act on received process data, now in the object store."""

    def prepare_source(self, pdo: TransmitPdo) -> None:
        """Put a quicker source into a TPDO, if there is one."""

    def prepare_sink(self, pdo: ReceivePdo) -> None:
        """Put a quicker sink into an RPDO, if there is one."""

    def _application_reset(self) -> None:
        """Reset the application to its power-on state (power cycle and NMT reset node)."""

    def _application_ready(self, t: float) -> None:
        """React to the end of the boot."""

    def _application_due(self) -> float:
        """Return the next timer of the application, s."""
        return inf

    def _application_fire(self, t: float) -> None:
        """Run the application's timers that are due by ``t`` s."""

    def _connection_lost(self, t: float) -> None:
        """React to a lost connection as set by object 0x6007."""

    def _left_operational(self, t: float) -> None:
        """React to the end of process data."""

    # power, boot, NMT ----------------------------------------------------------------------------------------

    def power(self, on: bool) -> None:
        """Switch the control supply at the present time: off makes it silent at once, on boots it."""
        if on == self.powered:
            return
        self.powered = on
        if on:
            self._restart(self.now_s, self._boot_s, communication_only=False)
        else:
            self._silence(communication_only=False)
            self._application_reset()
            self.reschedule()

    def _restart(self, t: float, boot_s: float, communication_only: bool) -> None:
        self._silence(communication_only)
        self.store.reset(communication_only)
        if not communication_only:
            self._application_reset()
        self._boot_at = t + boot_s
        self.reschedule()

    def _silence(self, communication_only: bool) -> None:
        """End all communication."""
        self._enter(BOOTING, self.now_s)
        self.emergencies.reset(communication_only)
        self._sdo.reset()
        self._forget_consumer()
        self._boot_at = inf
        self.wire.unbeat(self._heartbeat, self.now_s)

    def _boot(self, t: float) -> None:
        self._boot_at = inf
        self.now_s = max(self.now_s, t)
        self.emergencies.refresh()
        self._on_consumer_written(1, self.store.values[(o.CONSUMER_HEARTBEAT, 1)])
        self._on_producer_written(0, self.store.values[(o.PRODUCER_HEARTBEAT, 0)])
        self.wire.transmit(self._heartbeat.can_id, b"\0", t, True)
        self._enter(PRE_OPERATIONAL, t)
        self._application_ready(t)

    def _on_nmt(self, data: bytes, t: float) -> None:
        if len(data) != 2 or data[1] not in (0, self.node_id) or self.nmt == BOOTING:
            return
        command = data[0]
        if command == NmtCommand.START:
            self._enter(OPERATIONAL, t)
        elif command == NmtCommand.PRE_OPERATIONAL:
            self._enter(PRE_OPERATIONAL, t)
        elif command == NmtCommand.STOP:
            self._enter(STOPPED, t)
            self._connection_lost(t)
        elif command == NmtCommand.RESET_NODE:
            self._restart(t, self._boot_s, communication_only=False)
        elif command == NmtCommand.RESET_COMMUNICATION:
            self._connection_lost(t)
            self._restart(t, COMMUNICATION_BOOT_S, communication_only=True)

    def _enter(self, nmt: int, t: float) -> None:
        """Change the NMT state: PDOs are exchanged in OPERATIONAL only, emergencies also sent in PRE-OPERATIONAL."""
        if nmt == self.nmt:
            return
        was_operational = self.nmt == OPERATIONAL
        self.nmt = nmt
        if self.wire.ready_s <= t:
            self.wire.settle(t)  # frames due earlier contain the earlier state
        self._heartbeat.data = bytes((nmt,))
        self.emergencies.allowed = nmt in (PRE_OPERATIONAL, OPERATIONAL)
        if nmt == OPERATIONAL:
            self.pdos.start(t)
        elif was_operational:
            self.pdos.stop()
            self._left_operational(t)

    # timers --------------------------------------------------------------------------------------------------

    def advance(self, t0: float, t1: float) -> None:
        """Advance from ``t0`` to ``t1`` s; every timer fires at its own time."""
        while self.due_s <= t1:
            self.fire(max(t0, self.due_s))
        self.now_s = t1

    def reschedule(self) -> None:
        """Find the next timer."""
        due_s = self._application_due()
        # Comparisons: a call of min or a loop costs several times as much, and this runs several times a scan.
        if self._boot_at < due_s:
            due_s = self._boot_at
        if self._consumer_at < due_s:
            due_s = self._consumer_at
        if self.pdos.due_s < due_s:
            due_s = self.pdos.due_s
        self.due_s = due_s

    def fire(self, t: float) -> None:
        """Run the timers that are due by ``t`` s."""
        if self._boot_at <= t:
            self._boot(t)
        if self._consumer_at <= t:
            self._check_consumer(t)
        if self.pdos.due_s <= t:
            self.pdos.fire(t)
        self._application_fire(t)
        self.reschedule()

    # heartbeats ----------------------------------------------------------------------------------------------

    def withhold_heartbeat(self, withheld: bool) -> None:
        """Send no heartbeat (True) although 0x1017 asks for it, or send it again."""
        self._withheld = withheld
        self._beat_again(self.nmt != BOOTING)

    def _on_producer_written(self, sub: int, value: int) -> None:
        self._heartbeat.period_s = value * 1e-3 if value else inf
        self._beat_again(True)

    def _beat_again(self, up: bool) -> None:
        """Begin the heartbeat anew, if there is one and the device is ``up``."""
        beat = self._heartbeat
        self.wire.unbeat(beat, self.now_s)
        if up and not self._withheld and beat.period_s < inf:
            self.wire.beat(beat, self.now_s + beat.period_s)

    def _on_consumer_written(self, sub: int, value: int) -> None:
        """Watch the node in 0x1016; the watch begins with its first heartbeat (CiA 301, 7.2.8.2.2.3)."""
        self._forget_consumer()
        node, milliseconds = value >> 16, value & 0xFFFF
        if node and milliseconds:
            self._consumer_id = o.HEARTBEAT_BASE + node
            self._consumer_timeout_s = milliseconds * 1e-3
            self.wire.listen(self._consumer_id, self._on_heartbeat, self.node_id)
        self.reschedule()

    def _forget_consumer(self) -> None:
        if self._consumer_id:
            self.wire.forget(self._consumer_id, self._on_heartbeat)
        self._consumer_id = 0
        self._consumer_at = inf

    def _on_heartbeat(self, data: bytes, t: float) -> None:
        self._consumer_heard_s = t
        if self._consumer_at == inf:
            self._consumer_at = t + self._consumer_timeout_s
            self.reschedule()
            self.recovered(HEARTBEAT_LOST, t)

    def _check_consumer(self, t: float) -> None:
        deadline = self._consumer_heard_s + self._consumer_timeout_s
        if deadline > t:
            self._consumer_at = deadline
            return
        self._consumer_at = inf
        self.error(HEARTBEAT_LOST, t)
        self._connection_lost(t)
        behaviour = self.store.values[(o.ERROR_BEHAVIOUR, 1)]
        if behaviour == 0 and self.nmt == OPERATIONAL:
            self._enter(PRE_OPERATIONAL, t)
        elif behaviour == 2:
            self._enter(STOPPED, t)

    # errors --------------------------------------------------------------------------------------------------

    def error(self, code: int, t: float) -> None:
        """Report an error by EMCY, register and history."""
        self.emergencies.add(code, t)

    def recovered(self, code: int, t: float) -> None:
        """Report that an error no longer exists."""
        self.emergencies.remove(code, t)

    def deadline_missed(self, t: float) -> None:
        """Report an RPDO that did not come in time, and react like to a lost connection."""
        self.error(RPDO_TIMED_OUT, t)
        self._connection_lost(t)

    def serve_with(self, server: SdoServer) -> None:
        """Replace the SDO server from now on."""
        self._sdo = server

    # SDO -----------------------------------------------------------------------------------------------------

    def _on_sdo(self, data: bytes, t: float) -> None:
        if self.nmt in (BOOTING, STOPPED):
            return
        self.now_s = max(self.now_s, t)
        reply = self._sdo.request(data)
        # A value written by SDO lasts until the next RPDO, even if its bytes are those of the last one.
        self.pdos.refresh()
        if reply is not None:
            self.wire.transmit(o.SDO_REPLY_BASE + self.node_id, reply, t + self._turnaround_s)
