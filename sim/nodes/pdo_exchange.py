"""The process data traffic of a simulated device: RPDOs in, SYNC, TPDOs out, deadlines and event timers."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Final, Protocol

from drivers.canopen import objects as o
from sim.nodes.object_store import ObjectStore
from sim.nodes.pdo_channels import ReceivePdo, TransmitPdo
from sim.wires.can_traffic import Listener, SyncFollower
from sim.wires.can_wire import CanWire

PDO_TOO_SHORT: Final = 0x8210
PDO_TOO_LONG: Final = 0x8220
RPDO_TIMED_OUT: Final = 0x8250
_STATUSWORD: Final = (o.STATUSWORD, 0)


def _nothing() -> bytes:
    return b""


class PdoOwner(Protocol):
    """The device that owns the process data."""

    def process(self, t: float) -> None:
        """Act on received process data, now in the object store."""
        ...

    def error(self, code: int, t: float) -> None:
        """Report a process data error."""
        ...

    def recovered(self, code: int, t: float) -> None:
        """Note that a process data error has gone."""
        ...

    def deadline_missed(self, t: float) -> None:
        """React to an RPDO that did not come in time."""
        ...

    def prepare_source(self, pdo: TransmitPdo) -> None:
        """Put a quicker source into a TPDO, if there is one."""
        ...

    def prepare_sink(self, pdo: ReceivePdo) -> None:
        """Put a quicker sink into an RPDO, if there is one."""
        ...

    def reschedule(self) -> None:
        """Note a new ``PdoExchange.due_s``."""
        ...


class PdoExchange(SyncFollower):
    """All PDOs of one device; running while the device is OPERATIONAL.

    ``due_s`` is the next deadline or event timer; ``urgent`` marks the next synchronous TPDO as urgent for the wire.
    ``plain``: the next SYNC needs only one TPDO, ``sample`` under ``sample_id``; a ``stale`` sample
    is taken anew (``sim.wires.can_traffic.SyncFollower``).
    """

    def __init__(self, owner: PdoOwner, wire: CanWire, store: ObjectStore) -> None:
        """Create the two receive and two transmit PDOs of a device, not running."""
        super().__init__(_nothing)
        self.owner = owner
        self._wire = wire
        self._store = store
        self._running = False
        self._routes: list[tuple[int, Listener]] = []
        self.fresh: list[ReceivePdo] = []
        changed: Callable[[], None] = self.reload
        self.rpdos = [ReceivePdo(self, store, number, changed) for number in (1, 2)]
        self.tpdos = [TransmitPdo(store, number, changed) for number in (1, 2)]
        self._each_sync: tuple[tuple[int, Callable[[], bytes]], ...] = ()
        self._counted_tpdos: tuple[TransmitPdo, ...] = ()
        self._event_tpdos: tuple[TransmitPdo, ...] = ()
        self._status_on_event = False
        self._single = False
        self.urgent = False
        self.due_s = inf

    def start(self, t: float) -> None:
        """Begin at ``t`` s (NMT OPERATIONAL); event-driven TPDOs are sent once."""
        self._running = True
        self.reload()
        self.send_events(t)

    def stop(self) -> None:
        """End the traffic."""
        self._running = False
        self.reload()

    def reload(self) -> None:
        """Take over the PDO parameters and listen accordingly."""
        for can_id, listener in self._routes:
            self._wire.forget(can_id, listener)
        self._wire.unfollow(self)
        self._routes.clear()
        self.fresh.clear()
        for received in self.rpdos:
            received.load()
        for sent in self.tpdos:
            sent.load()
        sending = [pdo for pdo in self.tpdos if pdo.cob_id is not None] if self._running else []
        for pdo in sending:
            self.owner.prepare_source(pdo)
        self._each_sync = tuple((pdo.cob_id or 0, pdo.source) for pdo in sending if pdo.kind == 1)
        self._counted_tpdos = tuple(pdo for pdo in sending if pdo.synchronous and pdo.kind != 1)
        self._event_tpdos = tuple(pdo for pdo in sending if not pdo.synchronous)
        self._status_on_event = any(pdo.kind != 1 and _STATUSWORD in pdo.keys for pdo in sending)
        if self._running:
            for received in self.rpdos:
                if received.cob_id is not None:
                    self.owner.prepare_sink(received)
                    self._listen(received.cob_id, received.on_frame, repeatable=received.synchronous)
            self._single = len(self._each_sync) == 1 and not self._counted_tpdos
            if self._single:
                self.sample_id, self.take_sample = self._each_sync[0]
                self.sample_s = self._wire.frame_s(next(pdo.size for pdo in sending if pdo.kind == 1))
            self.plain = self._single and not self.urgent
            self.stale = True
            self._wire.follow(self, self._store.node_id)
        self._find_due()

    def _listen(self, can_id: int, listener: Listener, *, repeatable: bool) -> None:
        self._routes.append((can_id, listener))
        self._wire.listen(can_id, listener, self._store.node_id, repeatable=repeatable)

    def make_urgent(self) -> None:
        """Mark the next synchronous TPDO as urgent for the wire."""
        self.urgent = True
        self.plain = False

    # in ------------------------------------------------------------------------------------------------------

    def examine(self, pdo: ReceivePdo, data: bytes, t: float) -> None:
        """Process the first RPDO with a deadline, an event-driven RPDO, or an RPDO of the wrong length."""
        pdo.data = data
        size = len(data)
        if pdo.faulty:
            self.owner.recovered(pdo.faulty, t)
            pdo.faulty = 0
        if size != pdo.size:
            pdo.faulty = PDO_TOO_SHORT if size < pdo.size else PDO_TOO_LONG
            self.owner.error(pdo.faulty, t)
            if size < pdo.size:
                return
        pdo.held = data = data[: pdo.size]
        if pdo.deadline_s > 0.0 and pdo.deadline_at == inf:
            pdo.watch(t)
            self.owner.recovered(RPDO_TIMED_OUT, t)
            self._find_due()
        if pdo.synchronous:
            self.fresh.append(pdo)
            self.plain = False
        else:
            pdo.sink(data, t)

    def refresh(self) -> None:
        """Count the next frame of every RPDO as new, even with the bytes of the last one."""
        for pdo in self.rpdos:
            pdo.data = None
        self._wire.forget_cycle()

    # out -----------------------------------------------------------------------------------------------------

    def on_sync(self, t: float, plainly: bool = False) -> bool:
        """Apply the frames held for this SYNC and send its TPDOs, unless the wire sends the only one."""
        for received in self.fresh:
            received.sink(received.held, t)
        self.fresh.clear()
        if plainly and self._single and not self.urgent:
            self.plain = True
            return True
        for cob_id, source in self._each_sync:
            self._wire.transmit(cob_id, source(), t, self.urgent)
        for pdo in self._counted_tpdos:
            if pdo.cob_id is not None and pdo.sync_due():
                self._wire.transmit(pdo.cob_id, pdo.source(), t, self.urgent)
        self.urgent = False
        self.plain = self._single
        return False

    def take(self, pdo: ReceivePdo, data: bytes, t: float) -> None:
        """Write an RPDO's mapped values into the object store and let the device act on them."""
        self._store.values.update(zip(pdo.keys, pdo.unpack(data), strict=True))
        self.owner.process(t)

    def send_events(self, t: float) -> None:
        """Send the event-driven TPDOs whose content has changed or whose event timer is due."""
        for pdo in self.tpdos:
            pdo.changed = True
        for pdo in self._event_tpdos:
            data = pdo.source()
            if pdo.cob_id is not None and pdo.event_due(data, t):
                self._wire.transmit(pdo.cob_id, data, t, data != pdo.sent)  # urgent only with changed data
                pdo.note_sent(data, t)
        self._find_due()

    def status_changed(self, t: float) -> None:
        """Send a new statusword, if an event-driven PDO contains it."""
        if self._status_on_event:
            self.send_events(t)

    # timers --------------------------------------------------------------------------------------------------

    def fire(self, t: float) -> None:
        """Run the timers that are due by ``t`` s."""
        for pdo in self.rpdos:
            if pdo.deadline_at <= t and pdo.cob_id is not None:
                pdo.watch(max(pdo.stamp_s, self._wire.skipped_s(pdo.cob_id)))
                if pdo.deadline_at <= t:
                    pdo.unwatch()
                    self.refresh()
                    self.owner.deadline_missed(t)
        self.send_events(t)

    def _find_due(self) -> None:
        due = inf
        for awaited in self.rpdos:
            if awaited.deadline_at < due:
                due = awaited.deadline_at
        for sent in self._event_tpdos:
            if sent.due_s < due:
                due = sent.due_s
        self.due_s = due
        self.owner.reschedule()
