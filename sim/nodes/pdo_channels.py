"""The process data objects of a simulated device: parameters by SDO under the CiA rules, receive PDO, transmit PDO.

A PDO is changed in the order of CiA 301 (7.5.2.36): disabled by bit 31 of its COB-ID, number of mapped objects to 0,
the entries, the number of objects, enabled again. Everything else is refused with the abort code of that clause.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Final, Protocol

from drivers.canopen import objects as o
from drivers.canopen import sdo
from drivers.canopen.pdo import PdoMap, PdoMapError
from sim.nodes.object_store import Key, ObjectStore, SdoAbortError
from sim.wires.can_traffic import Listener

LAST_CYCLIC: Final = 240
"""Last transmission type that follows the SYNC; 254 and 255 are event driven, those between are refused."""
_EVENT: Final = 254
_COB_EXTENDED: Final = 0x2000_0000
_MAX_ENTRIES: Final = 4
_TINY_S: Final = 1e-9
"""Times that differ by less are equal: sums of a clock's floats are not exact, s."""


def _restricted(cob_id: int) -> bool:
    """Return whether an identifier is reserved for other services (CiA 301, table 73)."""
    return (
        cob_id <= 0x7F
        or 0x101 <= cob_id <= 0x180
        or 0x581 <= cob_id <= 0x5FF
        or 0x601 <= cob_id <= 0x67F
        or cob_id >= 0x6E0
    )


class PdoParameters:
    """Communication and mapping parameters of one PDO in the object dictionary."""

    def __init__(self, store: ObjectStore, number: int, transmit: bool, changed: Callable[[], None]) -> None:
        """Guard the parameters of PDO ``number`` (1, 2); ``changed`` is called after every accepted write."""
        self._store = store
        self._transmit = transmit
        self._changed = changed
        self._communication = (o.TPDO_COMMUNICATION if transmit else o.RPDO_COMMUNICATION) + number - 1
        self._mapping = (o.TPDO_MAPPING if transmit else o.RPDO_MAPPING) + number - 1
        store.guards[self._communication] = self._guard_communication
        store.guards[self._mapping] = self._guard_mapping
        store.hooks[self._communication] = self._on_write
        store.hooks[self._mapping] = self._on_write

    @property
    def cob_id(self) -> int | None:
        """The identifier, None while the PDO is disabled or maps nothing."""
        value = self._store.values[(self._communication, 1)]
        if value & o.COB_INVALID or not self._store.values[(self._mapping, 0)]:
            return None
        return value & o.COB_ID_MASK

    @property
    def kind(self) -> int:
        """The transmission type."""
        return self._store.values[(self._communication, 2)]

    @property
    def inhibit_s(self) -> float:
        """The inhibit time in s."""
        return self._store.values[(self._communication, 3)] * 1e-4

    @property
    def timer_s(self) -> float:
        """The event timer in s; 0 is off."""
        return self._store.values[(self._communication, 5)] * 1e-3

    def map(self) -> PdoMap:
        """Return the mapping in force."""
        values = self._store.values
        count = values[(self._mapping, 0)]
        return PdoMap.from_parameters([values[(self._mapping, sub)] for sub in range(1, count + 1)])

    def _valid(self) -> bool:
        return not self._store.values[(self._communication, 1)] & o.COB_INVALID

    def _locked(self) -> bool:
        """Return whether the PDO must be disabled before a change; if it cannot be disabled, it is changed as it is."""
        return self._valid() and self._store.entries[(self._communication, 1)].writable

    def _guard_communication(self, sub: int, value: int) -> None:
        if sub == 1:
            identifier = value & 0x1FFF_FFFF
            if value & _COB_EXTENDED or _restricted(identifier) or identifier > o.COB_ID_MASK:
                raise SdoAbortError(sdo.VALUE_RANGE)
            present = self._store.values[(self._communication, 1)]
            if self._valid() and not value & o.COB_INVALID and (value ^ present) & 0x1FFF_FFFF:
                raise SdoAbortError(sdo.VALUE_RANGE)
        elif sub == 2:
            if LAST_CYCLIC < value < _EVENT:
                raise SdoAbortError(sdo.VALUE_RANGE)
        elif sub == 3 and self._locked():
            raise SdoAbortError(sdo.UNSUPPORTED_ACCESS)

    def _guard_mapping(self, sub: int, value: int) -> None:
        if self._locked():
            raise SdoAbortError(sdo.UNSUPPORTED_ACCESS)
        values = self._store.values
        if sub == 0:
            if value > _MAX_ENTRIES:
                raise SdoAbortError(sdo.PDO_TOO_LONG)
            try:
                PdoMap.from_parameters([values[(self._mapping, entry)] for entry in range(1, value + 1)])
            except PdoMapError as error:
                raise SdoAbortError(error.abort_code) from error
            return
        if values[(self._mapping, 0)]:
            raise SdoAbortError(sdo.UNSUPPORTED_ACCESS)
        if value:
            self._check_mappable(value)

    def _check_mappable(self, value: int) -> None:
        entry = self._store.entries.get((value >> 16, value >> 8 & 0xFF))
        if entry is None:
            raise SdoAbortError(sdo.NO_OBJECT)
        allowed = entry.readable if self._transmit else entry.writable
        if not (entry.mappable and allowed and entry.bits == value & 0xFF):
            raise SdoAbortError(sdo.NOT_MAPPABLE)

    def _on_write(self, sub: int, value: int) -> None:
        self._changed()


class Receiver(Protocol):
    """Receiver of PDOs."""

    fresh: list[ReceivePdo]
    plain: bool

    def take(self, pdo: ReceivePdo, data: bytes, t: float) -> None:
        """Apply the data of a PDO."""
        ...

    def examine(self, pdo: ReceivePdo, data: bytes, t: float) -> None:
        """Process a frame that cannot simply wait for the next SYNC."""
        ...


class ReceivePdo:
    """One RPDO: its present mapping and the last bytes applied.

    Bytes that have not changed since then only refresh ``stamp_s``. The next frame is compared with
    ``data``; None means that it counts as new with any content. ``held`` is the last frame of full length.
    ``deadline_at`` is the time in s by which the next frame must have come, infinity while unwatched; ``faulty`` is the
    EMCY code of a reported wrong length, 0 if none. ``sink`` applies the data at their time; a device may replace the
    general sink by a quicker one.
    """

    def __init__(
        self, receiver: Receiver, store: ObjectStore, number: int, changed: Callable[[], None]
    ) -> None:
        """Create RPDO ``number`` (1, 2) of a device; ``changed`` is called when its parameters were written."""
        self._receiver = receiver
        self.parameters = PdoParameters(store, number, False, changed)
        self.stamp_s = -inf
        self.faulty = 0
        self.load()

    def load(self) -> None:
        """Adopt the PDO's parameters."""
        parameters = self.parameters
        mapped = parameters.map()
        self.cob_id = parameters.cob_id
        self.keys: tuple[Key, ...] = tuple((index, sub) for index, sub, _ in mapped.fields)
        self.fields = mapped.fields
        self.unpack = mapped.unpack
        self.sink: Listener = self._apply
        self.size = mapped.size
        self.synchronous = parameters.kind <= LAST_CYCLIC
        self.deadline_s = parameters.timer_s
        self.deadline_at = inf
        self.data: bytes | None = None
        self.held = bytes(self.size)
        self._plain_size = self.size if self.synchronous and self.deadline_s == 0.0 else -1

    def watch(self, t: float) -> None:
        """Expect the next frame within the deadline from ``t`` s on."""
        self.deadline_at = t + self.deadline_s
        if self.synchronous:
            self._plain_size = self.size

    def unwatch(self) -> None:
        """Expect no frame until another has come."""
        self.deadline_at = inf
        self._plain_size = -1

    def on_frame(self, data: bytes, t: float) -> None:
        """Take a frame that arrived at ``t`` s."""
        self.stamp_s = t
        if data == self.data:
            return
        if len(data) == self._plain_size and not self.faulty:
            self.data = self.held = data
            self._receiver.fresh.append(self)
            self._receiver.plain = False
        else:
            self._receiver.examine(self, data, t)

    def _apply(self, data: bytes, t: float) -> None:
        self._receiver.take(self, data, t)


class TransmitPdo:
    """One TPDO: packs its objects with one precompiled struct and knows when it is due.

    ``source`` returns its bytes; a device may replace ``bytes_now`` by a quicker source. ``due_s`` is the time of
    an event-driven PDO's event timer or of the end of its inhibit time.
    """

    def __init__(self, store: ObjectStore, number: int, changed: Callable[[], None]) -> None:
        """Create TPDO ``number`` (1, 2) of a device; ``changed`` is called when its parameters were written."""
        self._store = store
        self.parameters = PdoParameters(store, number, True, changed)
        self.load()

    def load(self) -> None:
        """Adopt the PDO's parameters."""
        parameters = self.parameters
        mapped = parameters.map()
        self.cob_id = parameters.cob_id
        self.fields = mapped.fields
        self.keys: tuple[Key, ...] = tuple((index, sub) for index, sub, _ in mapped.fields)
        self.pack = mapped.pack
        self.size = mapped.size
        self.source: Callable[[], bytes] = self.bytes_now
        self.kind = parameters.kind
        self.synchronous = self.kind <= LAST_CYCLIC
        self.inhibit_s = parameters.inhibit_s
        self.timer_s = parameters.timer_s
        self.sent: bytes | None = None
        self.sent_s = -inf
        self.due_s = inf
        self.changed = True
        self._count = 0

    def bytes_now(self) -> bytes:
        """Return the mapped objects' present values, packed."""
        read = self._store.read
        return self.pack(*[read(key) for key in self.keys])

    def sync_due(self) -> bool:
        """Count a SYNC; return whether the PDO is sent with this SYNC (type 0: after a change, n: every n-th)."""
        if self.kind == 0:
            due = self.changed
            self.changed = False
            return due
        self._count += 1
        if self._count < self.kind:
            return False
        self._count = 0
        return True

    def event_due(self, data: bytes, t: float) -> bool:
        """Return whether an event-driven PDO with this content is sent at ``t`` s, free of the inhibit time."""
        if data == self.sent and t < self.due_s:
            return False
        free_s = self.sent_s + self.inhibit_s
        if t < free_s - _TINY_S:
            self.due_s = min(self.due_s, free_s)
            return False
        return True

    def note_sent(self, data: bytes, t: float) -> None:
        """Record the data that an event-driven PDO sent at ``t`` s and start its event timer."""
        self.sent = data
        self.sent_s = t
        self.due_s = t + self.timer_s if self.timer_s > 0.0 else inf
