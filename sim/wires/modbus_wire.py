"""A Modbus RTU line without a scheduler: the computer's request reaches the simulated slaves at once, with wire times.

A request gets its arrival (its length on the wire and the silence that ends a frame). The addressed
slave answers with its registers at that time, and the reply is queued with its own arrival time.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Literal

from drivers.crc16 import with_crc
from drivers.ports import BusLost, LineWatcher, Unwatch, add_watcher
from sim.nodes.modbus_slave import BROADCAST, READ_HOLDING, READ_INPUT, ModbusSlave

Kind = Literal[
    "silence", "lost", "late", "corrupt", "truncate", "split", "noise", "wrong_id", "stale", "exception",
    "swapped", "torn", "merged",
]  # fmt: skip
"""Faults of a transaction:

``silence`` the slave does not get the request; ``lost`` it acts, the reply is lost; ``late`` the reply comes
``delay_s`` later; ``corrupt`` one bit of it is wrong; ``truncate`` its end is missing; ``split`` its second half comes
``delay_s`` later; ``noise`` a few bytes come before it; ``wrong_id`` it has another address; ``stale`` the reply to
the request before is sent again; ``exception`` the slave answers with exception ``code`` and does nothing; ``swapped``
each pair of registers comes in the other order; ``torn`` the first register of each pair is from the reply before, as
if the device had not finished writing it; ``merged`` the reply is kept, and comes in one piece with the next one.
"""


@dataclass(slots=True)
class Impairment:
    """A fault of a line: the next ``count`` transactions (-1 = all) of one slave, after ``skip`` good ones."""

    kind: Kind
    count: int = 1
    unit_id: int = 0
    """Address of the faulty slave; 0 = every slave."""
    skip: int = 0
    delay_s: float = 0.05
    code: int = 4
    kept: bytes = b""
    """A reply that waits for the next one."""
    besides: Impairment | None = None
    """The earlier fault of the line: it applies where this one does not."""

    def striking(self, unit_id: int) -> Impairment | None:
        """Return the impairment that applies to this transaction, and count the transaction there."""
        impairment: Impairment | None = self
        while impairment is not None:
            if impairment.strikes(unit_id):
                return impairment
            impairment = impairment.besides
        return None

    def strikes(self, unit_id: int) -> bool:
        """Return whether the impairment applies to this transaction, and count it."""
        if self.count == 0 or self.unit_id not in (0, unit_id):
            return False
        if self.skip > 0:
            self.skip -= 1
            return False
        if self.count > 0:
            self.count -= 1
        return True


class ModbusWire:
    """The line and the computer's port on it (``drivers.ports.LinePort``).

    ``watchers`` are called for every frame either way; ``impair`` spoils transactions; ``occupied_s`` is the time
    for which the line has carried characters, ``collisions`` counts requests sent during a reply. The computer's
    adapter may hold received bytes back, like a USB adapter with its latency timer. ``arrives_s`` is the arrival
    of the next unread bytes, s: infinity when none are on their way, -infinity when a read would raise.
    """

    def __init__(
        self,
        baud: int = 115200,
        parity: Literal["N", "E", "O"] = "N",
        slaves: Iterable[ModbusSlave] = (),
        held_s: float = 0.0,
        byte_bits: int = 0,
    ) -> None:
        """Create a quiet line at ``baud`` bit/s and put ``slaves`` on it; a byte takes ``byte_bits``, or by default 8
        data bits, the parity's and 1 stop bit.

        ``held_s``: the adapter delivers everything this long after its last character, s. A real latency timer takes
        0 to its whole time by chance: this is the worst case.
        """
        self._held_s = held_s
        self.baud = baud
        self.character_s: float = (byte_bits or (10 if parity == "N" else 11)) / baud
        # Silence that ends a frame: 3.5 characters up to 19200 bit/s, 1.75 ms above (Modbus over serial line V1.02).
        self.gap_s = 3.5 * self.character_s if baud <= 19200 else 0.00175
        self._busy_s = -inf
        self._inbox: list[tuple[float, bytes]] = []
        self.arrives_s = inf
        self._slaves: dict[int, ModbusSlave] = {}
        self._last_reply = b""
        self.watchers: list[LineWatcher] = []
        self.impair: Impairment | None = None
        self.connected = True
        self.collisions = 0
        self.requests = 0
        self.occupied_s = 0.0
        for slave in slaves:
            self.attach(slave)

    @property
    def remedy(self) -> str:
        """Advice that makes the computer's adapter deliver at once."""
        return "lower sim.latency_timer"

    def attach(self, slave: ModbusSlave) -> None:
        """Put a slave on the line. Raises ValueError if its address is taken."""
        if slave.unit_id in self._slaves:
            raise ValueError(f"two slaves have Modbus address {slave.unit_id}")
        self._slaves[slave.unit_id] = slave

    def has(self, slave: ModbusSlave) -> bool:
        """Return whether a slave is on this line."""
        return self._slaves.get(slave.unit_id) is slave

    # the computer's side ---------------------------------------------------------------------------------------

    def write(self, data: bytes, now: float) -> None:
        """Send a frame at ``now`` s; the slave answers at once. Raises BusLost when disconnected."""
        if not self.connected:
            raise BusLost("the simulated serial adapter is disconnected")
        length_s = len(data) * self.character_s
        end = now + length_s
        self.requests += 1
        self.occupied_s += length_s
        if self.watchers:
            self._tell(end, data, True)
        if now < self._busy_s:
            self._collide(now, end)
            return
        t = end + self.gap_s
        slave = self._slaves.get(data[0])
        if slave is None:
            if data[0] == BROADCAST:
                for each in self._slaves.values():
                    each.answer(data, t)
            self._busy_s = end
            return
        if self.impair is not None:
            striking = self.impair.striking(slave.unit_id)
            if striking is not None:
                self._spoil(striking, slave, data, t)
                return
        reply = slave.answer(data, t)
        if reply is None:
            self._busy_s = end
            return
        # As in ``_reply``, but written out here: nearly every transaction ends here.
        length_s = len(reply) * self.character_s
        self._busy_s = arrival = t + slave.turnaround_s + length_s
        self.occupied_s += length_s
        self._last_reply = reply
        if self._held_s:
            arrival += self._held_s
        if self.watchers:
            self._tell(arrival, reply, False)
        self._inbox.append((arrival, reply))
        if arrival < self.arrives_s:
            self.arrives_s = arrival

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return (arrival of the last byte in s, bytes) up to ``now``, oldest first. Raises BusLost."""
        if now < self.arrives_s:
            return []
        if not self.connected:
            raise BusLost("the simulated serial adapter is disconnected")
        inbox = self._inbox
        if len(inbox) == 1:
            self._inbox = []
            self.arrives_s = inf
            return inbox
        arrived = [chunk for chunk in inbox if chunk[0] <= now]
        self._inbox = [chunk for chunk in inbox if chunk[0] > now]
        self.arrives_s = min((chunk[0] for chunk in self._inbox), default=inf)
        return sorted(arrived)

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Call ``watcher`` for every frame."""
        return add_watcher(self.watchers, watcher)

    def disconnect(self) -> None:
        """Unplug the computer's adapter: bytes under way are lost, and every call raises BusLost."""
        self.connected = False
        self._inbox = []
        self.arrives_s = -inf

    def reconnect(self) -> None:
        """Plug the adapter in again."""
        self.connected = True
        self.arrives_s = min((chunk[0] for chunk in self._inbox), default=inf)

    # inner -----------------------------------------------------------------------------------------------------

    def _tell(self, t: float, data: bytes, sent: bool) -> None:
        for watcher in self.watchers:
            watcher(t, data, sent)

    def _reply(self, reply: bytes, start: float) -> None:
        """Send a slave's reply from ``start`` s."""
        length_s = len(reply) * self.character_s
        arrival = start + length_s
        self._busy_s = arrival
        self.occupied_s += length_s
        self._last_reply = reply
        arrival += self._held_s
        if self.watchers:
            self._tell(arrival, reply, False)
        self._inbox.append((arrival, reply))
        if arrival < self.arrives_s:
            self.arrives_s = arrival

    def _collide(self, now: float, end: float) -> None:
        """Handle two senders at once: the request and the rest of the reply are garbled."""
        self.collisions += 1
        self._inbox = [
            (t, data) if t <= now else (t, bytes(byte ^ 0x55 for byte in data)) for t, data in self._inbox
        ]
        self._busy_s = max(self._busy_s, end)

    def _spoil(self, impairment: Impairment, slave: ModbusSlave, data: bytes, t: float) -> None:
        """Apply the line's fault to a transaction."""
        kind = impairment.kind
        start = t + slave.turnaround_s
        before = self._last_reply
        if kind == "silence":
            reply = None
        elif kind == "exception":
            reply = slave.exception(data[1], impairment.code)
        else:
            reply = slave.answer(data, t)
        if reply is None or kind == "lost":
            self._busy_s = t
            return
        half = len(reply) // 2
        if kind == "late":
            # Other devices may send before it: the line is busy when it comes, not until then.
            self._reply(reply, start + impairment.delay_s)
            self._busy_s = t
        elif kind == "split":
            self._reply(reply[:half], start)
            self._reply(reply[half:], self._busy_s + impairment.delay_s)
        elif kind == "corrupt":
            self._reply(reply[:-3] + bytes((reply[-3] ^ 0x10,)) + reply[-2:], start)
        elif kind == "truncate":
            self._reply(reply[:half], start)
        elif kind == "noise":
            self._reply(b"\x00\xff\xfe" + reply, start)
        elif kind == "wrong_id":
            self._reply(with_crc(bytes((reply[0] ^ 0x40,)) + reply[1:-2]), start)
        elif kind == "swapped":
            self._reply(_in_pairs(reply, reply, swap=True), start)
        elif kind == "torn":
            self._reply(_in_pairs(before, reply, swap=False), start)
        elif kind == "merged":
            kept, impairment.kept = impairment.kept, b"" if impairment.kept else reply
            self._last_reply = reply
            self._busy_s = t
            if kept:
                self._reply(kept + reply, start)
        elif kind == "stale":
            self._reply(before or reply, start)
        else:
            self._reply(reply, start)


def _in_pairs(before: bytes, reply: bytes, *, swap: bool) -> bytes:
    """Return a reply to a read with its registers combined anew, in pairs; every other reply unchanged.

    The first register of each pair is that of ``before``, a reply of the same shape; with ``swap`` it is the second
    one.
    """
    head, data = reply[:3], reply[3:-2]
    if reply[1] not in (READ_HOLDING, READ_INPUT) or reply[2] != len(data) or before[:3] != head:
        return reply
    words = [data[at : at + 2] for at in range(0, len(data), 2)]
    for high in range(0, len(words) - 1, 2):
        if swap:
            words[high], words[high + 1] = words[high + 1], words[high]
        else:
            words[high] = before[3 + 2 * high : 5 + 2 * high]
    return with_crc(head + b"".join(words))
