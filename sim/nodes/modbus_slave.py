"""A Modbus RTU slave: a register file with a device's answers, exceptions and silences.

Independent of the drivers' library: frames are decoded and composed here.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from struct import Struct
from typing import Final

from drivers.crc16 import crc16, with_crc

READ_COILS: Final = 1
READ_DISCRETE: Final = 2
READ_HOLDING: Final = 3
READ_INPUT: Final = 4
WRITE_COIL: Final = 5
WRITE_ONE: Final = 6
WRITE_COILS: Final = 15
WRITE_MANY: Final = 16

ILLEGAL_FUNCTION: Final = 1
ILLEGAL_ADDRESS: Final = 2
ILLEGAL_VALUE: Final = 3
DEVICE_FAILURE: Final = 4
ENDURANCE: Final = 100_000
"""Number of writes that a device's non-volatile memory endures (Eurotherm HA028651)."""
BROADCAST: Final = 0
PATTERN: Final = (0.0, 0.5, 1.0, 0.5)
"""Additions to a value in counts, reading by reading, before it is rounded down: the last bit of a digital sensor. A
value at rest then changes by exactly one count within four readings, like that of a real converter, and their mean is
within a quarter of a count."""

_MOST_READ: Final = 125
_MOST_WRITTEN: Final = 123
_MOST_BITS: Final = 2000
"""Registers, and bits, in one request (Modbus application protocol V1.1b3, 6.1, 6.3 and 6.12)."""
_REMEMBERED: Final = 64
"""Number of decoded requests of each kind that are kept."""

_WORD: Final = Struct(">H")
_REQUEST: Final = Struct(">BBHH")


class RegisterWindow:
    """Registers without a gap. ``data`` holds them as they go over the wire."""

    def __init__(self, start: int, count: int) -> None:
        """Take ``count`` registers from ``start``, all zero."""
        self.start = start
        self.count = count
        self.data = bytearray(2 * count)


class _Read:
    """A decoded read request with its last reply; ``block`` is the device's number of exactly these registers.

    ``served`` counts its replies.
    """

    def __init__(self, window: RegisterWindow, address: int, count: int, head: bytes, block: int) -> None:
        self.window = window
        self.block = block
        self.start = 2 * (address - window.start)
        self.last = self.start + 2 * count
        self.head = head
        self.payload = b""
        self.reply = b""
        self.served = 0


class ModbusSlave:
    """A device on a line. ``turnaround_s`` is the time from the end of a request to the start of its reply."""

    def __init__(
        self, unit_id: int, turnaround_s: float, registers: Iterable[tuple[int, int]], functions: frozenset[int]
    ) -> None:
        """Set device address ``unit_id`` and registers at (address, count), which may touch or overlap."""
        self.unit_id = unit_id
        self.turnaround_s = turnaround_s
        self.functions = functions
        self.powered = True
        self.due_s = inf
        """Time of the next cycle of a device with a control loop, s."""
        self.windows = _windows(registers)
        self._reads: dict[bytes, _Read] = {}
        self._writes: dict[bytes, tuple[bytes, int, tuple[int, ...]]] = {}
        self.stored: frozenset[int] = frozenset()
        """Registers kept without supply: a change writes them to memory [A], a limited number of times (``wear``)."""
        self.wear: dict[int, int] = {}
        self.endurance = ENDURANCE
        self.bits: dict[int, int] = {}
        """Coils and discrete inputs by address, 0 or 1; a request for any other is refused."""
        self.blocks: dict[tuple[int, int], int] = {}
        """Block numbers by (address, count) of usual read requests: ``sample`` is called for these."""

    # leaps -----------------------------------------------------------------------------------------------------

    def served(self) -> dict[int, int]:
        """Return how many replies each of ``blocks`` has had."""
        return {read.block: read.served for read in self._reads.values() if read.block >= 0}

    def draw(self, block: int, count: int, t: float) -> None:
        """Use up the noise of ``count`` readings of a block at ``t`` s, as if the requests had come."""

    # hooks for a device ----------------------------------------------------------------------------------------

    def advance(self, t0: float, t1: float) -> None:
        """Advance from ``t0`` to ``t1`` s: run the cycles that are due (``due_s``)."""

    def leap(self, until_s: float, now: float) -> None:
        """Run the cycles due by ``until_s`` at the moment ``now`` of the wires: leases do not age in a leap."""

    def power(self, on: bool) -> None:
        """Switch the supply; a device without supply is silent."""
        self.powered = on

    def refresh(self, t: float) -> None:
        """Update the registers for a read at ``t`` s."""

    def sample(self, block: int, t: float) -> bytes:
        """Return the registers of one of ``blocks`` at ``t`` s, without a call of ``refresh``."""
        raise KeyError(block)

    def written(self, address: int, value: int, t: float) -> int:
        """Process a write at ``t`` s; return 0, or an exception code for the answer."""
        return 0

    def wrote(self, address: int, count: int, t: float) -> None:
        """Act on registers that one request has written at ``t`` s."""

    def coil_written(self, address: int, value: int, t: float) -> int:
        """Process a write of a coil at ``t`` s; return 0, or an exception code for the answer."""
        return 0

    # registers -------------------------------------------------------------------------------------------------

    def window(self, address: int, count: int = 1) -> RegisterWindow | None:
        """Return the window that holds all of these registers, or None."""
        for window in self.windows:
            if window.start <= address and address + count <= window.start + window.count:
                return window
        return None

    def get(self, address: int) -> int:
        """Return a register. Raises KeyError if there is none."""
        window = self.window(address)
        if window is None:
            raise KeyError(address)
        return int(_WORD.unpack_from(window.data, 2 * (address - window.start))[0])

    def put(self, address: int, data: bytes) -> None:
        """Set the registers from ``address`` to bytes as on the wire. Raises KeyError if there are none."""
        window = self.window(address, len(data) // 2)
        if window is None:
            raise KeyError(address)
        at = 2 * (address - window.start)
        window.data[at : at + len(data)] = data

    # the wire --------------------------------------------------------------------------------------------------

    def answer(self, frame: bytes, t: float) -> bytes | None:
        """Return the reply to a frame that was complete at ``t`` s.

        None, silence: frame for another device, a broadcast (which is executed), a bad CRC, a broken frame, power off.
        """
        if not self.powered:
            return None
        read = self._reads.get(frame)
        if read is not None:
            read.served += 1
            payload = self.sample(read.block, t) if read.block >= 0 else self._look_up(read, t)
            if payload != read.payload:
                read.payload = payload
                reply = read.head + payload
                read.reply = reply + crc16(reply).to_bytes(2, "little")
            return read.reply
        write = self._writes.get(frame)
        if write is not None:
            return self._write(*write, t)
        if len(frame) < 4 or frame[0] not in (self.unit_id, BROADCAST) or crc16(frame) != 0:
            return None
        executed = self._execute(frame[:-2], frame, t)
        return None if frame[0] == BROADCAST else executed

    def exception(self, function: int, code: int) -> bytes:
        """Return the reply that refuses ``function``."""
        return with_crc(bytes((self.unit_id, function | 0x80, code)))

    def _execute(self, request: bytes, frame: bytes, t: float) -> bytes | None:
        function = request[1]
        if function not in self.functions:
            return self.exception(function, ILLEGAL_FUNCTION)
        if len(request) < 6:
            return None
        _, _, address, count = _REQUEST.unpack_from(request)
        if function in (READ_COILS, READ_DISCRETE):
            return self._read_bits(function, address, count, t) if len(request) == 6 else None
        if function == WRITE_COIL:
            if count not in (0, 0xFF00):
                return self.exception(function, ILLEGAL_VALUE)
            return self._write_bits(frame, address, (int(count > 0),), t) if len(request) == 6 else None
        if function == WRITE_COILS:
            if len(request) < 7 or len(request) != 7 + request[6] or request[6] != (count + 7) // 8:
                return self.exception(function, ILLEGAL_VALUE)
            bits = int.from_bytes(request[7:], "little")
            return self._write_bits(frame, address, tuple([bits >> place & 1 for place in range(count)]), t)
        if function == WRITE_ONE:
            return self._new_write(frame, address, (count,), t) if len(request) == 6 else None
        if function == WRITE_MANY:
            if len(request) < 7 or len(request) != 7 + request[6]:
                return None
            values = tuple(_WORD.unpack_from(request, at)[0] for at in range(7, len(request) - 1, 2))
            if not 1 <= count <= _MOST_WRITTEN or request[6] != 2 * count:
                return self.exception(function, ILLEGAL_VALUE)
            return self._new_write(frame, address, values, t)
        if len(request) != 6:
            return None
        return self._new_read(frame, function, address, count, t)

    def _read_bits(self, function: int, address: int, count: int, t: float) -> bytes:
        if not 1 <= count <= _MOST_BITS:
            return self.exception(function, ILLEGAL_VALUE)
        if any(place not in self.bits for place in range(address, address + count)):
            return self.exception(function, ILLEGAL_ADDRESS)
        self.refresh(t)
        bits = sum(self.bits[address + place] << place for place in range(count))
        data = bits.to_bytes((count + 7) // 8, "little")
        return with_crc(bytes((self.unit_id, function, len(data))) + data)

    def _write_bits(self, frame: bytes, address: int, values: tuple[int, ...], t: float) -> bytes:
        for place, value in enumerate(values, address):
            code = ILLEGAL_ADDRESS if place not in self.bits else self.coil_written(place, value, t)
            if code:
                return self.exception(frame[1], code)
            self.bits[place] = value
        return with_crc(frame[:6])

    def _new_read(self, frame: bytes, function: int, address: int, count: int, t: float) -> bytes:
        if not 1 <= count <= _MOST_READ:
            return self.exception(function, ILLEGAL_VALUE)
        window = self.window(address, count)
        if window is None:
            return self.exception(function, ILLEGAL_ADDRESS)
        head = bytes((self.unit_id, function, 2 * count))
        read = _Read(window, address, count, head, self.blocks.get((address, count), -1))
        if frame[0] == self.unit_id and len(self._reads) < _REMEMBERED:
            self._reads[frame] = read
        read.payload = self._look_up(read, t)
        read.reply = with_crc(read.head + read.payload)
        return read.reply

    def _new_write(self, frame: bytes, address: int, values: tuple[int, ...], t: float) -> bytes:
        if self.window(address, len(values)) is None:
            return self.exception(frame[1], ILLEGAL_ADDRESS)
        reply = with_crc(frame[:6])
        if frame[0] == self.unit_id:
            if len(self._writes) >= _REMEMBERED:
                self._writes.clear()
            self._writes[frame] = (reply, address, values)
        return self._write(reply, address, values, t)

    def _look_up(self, read: _Read, t: float) -> bytes:
        """Return registers from the windows."""
        self.refresh(t)
        return bytes(read.window.data[read.start : read.last])

    def _keep(self, address: int, value: int) -> int:
        """Count a write to memory; return 0, or the exception code if the memory is worn out."""
        if value == self.get(address):
            return 0
        worn = self.wear.get(address, 0)
        if worn >= self.endurance:
            return DEVICE_FAILURE
        self.wear[address] = worn + 1
        return 0

    def _write(self, reply: bytes, address: int, values: tuple[int, ...], t: float) -> bytes:
        for place, value in enumerate(values, address):
            code = self._keep(place, value) if place in self.stored else 0
            if not code:
                code = self.written(place, value, t)
            if code:
                return self.exception(reply[1], code)
            self.put(place, value.to_bytes(2, "big"))
        self.wrote(address, len(values), t)
        return reply


def _windows(registers: Iterable[tuple[int, int]]) -> list[RegisterWindow]:
    """Return windows over registers given as (address, count), joined where they touch."""
    joined: list[tuple[int, int]] = []
    for address, count in sorted(registers):
        if joined and address <= joined[-1][0] + joined[-1][1]:
            start, length = joined[-1]
            joined[-1] = (start, max(length, address + count - start))
        else:
            joined.append((address, count))
    return [RegisterWindow(start, count) for start, count in joined]
