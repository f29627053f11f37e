"""A slave that answers according to a maker's table: modbus_tk's, at the end of a serial line or on a TCP port."""

from __future__ import annotations

import logging
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock, Timer

from modbus_tk import defines, modbus, modbus_rtu, modbus_tcp

from drivers.ports import WatchedLine
from tester.base import clock
from tests.campaigns.makers.table import SIZES, Area, Register, State, Table
from tests.peers.exchange import PATIENCE_S

UNIT = 1
AREAS: dict[Area, int] = {
    "coil": defines.COILS,
    "discrete": defines.DISCRETE_INPUTS,
    "holding": defines.HOLDING_REGISTERS,
    "input": defines.ANALOG_INPUTS,
}
CODES = {"u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}
WRITES_ONE, WRITES_MANY = 6, 16
SLACK = 1e-6
"""Tolerance of a float at its bound, as a share: 1.1 is not an f32."""


class MakersSlave(modbus.Slave):
    """Holds the registers of a table. It has only the table's addresses; all others raise exception 2."""

    def __init__(self, table: Table) -> None:
        """Power the device up."""
        memory: dict[int, list[object]] = {number: [] for number in AREAS.values()}
        if table.one_area:
            memory[defines.ANALOG_INPUTS] = memory[defines.HOLDING_REGISTERS]
        super().__init__(UNIT, memory=memory)
        self.table = table
        self.kept: dict[str, float] = {}
        """Internal state that the device does not show."""
        self.journal: list[tuple[str, float]] = []
        """Registers that were written, and their values, the oldest first."""
        self.silent = False
        self.raises: dict[int, int] = {}
        """Exceptions by function, in place of an answer."""
        self._lock = RLock()
        self._reacting = False
        for area, start, size in _spans(table):
            self.add_block(f"{area} {start}", AREAS[area], start, size)
        self.power_up()

    def power_up(self) -> None:
        """Set the start values; the device forgets all writes."""
        with self._lock:
            self.kept.clear()
            self.journal.clear()
            self.raises.clear()
            self.silent = False
            for register in self.table.registers:
                self._store(register, register.at_start)
            for register in self.table.registers:
                self._react(register.name)

    def get(self, name: str) -> float:
        """Return the value of a register."""
        register = self.table[name]
        if register.area == "inside":
            return self.kept[name]
        size = SIZES[register.type]
        block, offset = self._get_block_and_offset(AREAS[register.area], register.addresses[0], size)
        return self._number(register, list(block[offset : offset + size]))

    def put(self, name: str, value: float) -> None:
        """Set a register, as the device does when it measures."""
        with self._lock:
            self._store(self.table[name], value)
            self._react(name)

    def show(self, state: State) -> None:
        """Bring the device into a state."""
        for name, value in state.values.items():
            self.put(name, value)

    def handle_request(self, request_pdu: bytes, broadcast: bool = False) -> bytes:
        """Answer a request, or refuse it with the maker's exception."""
        function = request_pdu[0]
        code = self.raises.get(function, 0 if function in self.table.functions else 1)
        if code:
            return bytes((function | 0x80, code))
        if function not in (WRITES_ONE, WRITES_MANY):
            asked = struct.unpack(">HH", request_pdu[1:5])
            if any(register.access == "w" for register in self._among(*asked)):
                return bytes((function | 0x80, 2))
            return bytes(super().handle_request(request_pdu))  # type: ignore[arg-type]
        with self._lock:
            return self._write(function, request_pdu)

    def _write(self, function: int, request_pdu: bytes) -> bytes:
        """Write where the table allows it."""
        address, count, data = struct.unpack(">H", request_pdu[1:3])[0], 1, request_pdu[3:]
        if function == WRITES_MANY:
            count, data = struct.unpack(">H", request_pdu[3:5])[0], request_pdu[6:]
        if function == WRITES_ONE and address in self.table.commands:
            before = self.kept.get("command", 0.0)
            self.kept["command"] = struct.unpack(">H", data)[0]
            code = self.table.forbids(self, "command")
            if code:
                self.kept["command"] = before
                return bytes((function | 0x80, code))
            self._react("command")
            return request_pdu
        touched = self._among(address, count)
        for register in touched:
            code = self.table.forbids(self, register.name)
            if code:
                return bytes((function | 0x80, code))
        if any(register.access == "r" for register in touched):
            return bytes((function | 0x80, self.table.protected))
        for register in touched:
            at, size = register.addresses[0] - address, SIZES[register.type]
            if at < 0 or at + size > count:
                return bytes((function | 0x80, 3))  # half a number
            value = self._number(register, list(struct.unpack(f">{size}H", data[2 * at : 2 * (at + size)])))
            slack = SLACK * abs(register.greatest) if register.type == "f32" and register.greatest < 1e30 else 0.0
            if not register.least - slack <= value <= register.greatest + slack:
                if self.table.out_of_range is not None:
                    return bytes((function | 0x80, self.table.out_of_range))
                return request_pdu[:5]
        answer = bytes(super().handle_request(request_pdu))  # type: ignore[arg-type]
        if answer[0] == function:
            for register in touched:
                self.journal.append((register.name, self.get(register.name)))
                self._react(register.name)
        return answer

    def _among(self, address: int, count: int) -> list[Register]:
        """Return the holding registers in a range of addresses."""
        return [
            register
            for register in self.table.registers
            if register.area == "holding"
            and any(at < address + count and address < at + SIZES[register.type] for at in register.addresses)
        ]

    def _react(self, written: str) -> None:
        if not self._reacting:
            self._reacting = True
            self.table.react(self, written)
            self._reacting = False

    def _store(self, register: Register, value: float) -> None:
        if register.area == "inside":
            self.kept[register.name] = value if register.type == "f32" else int(value)
            return
        if register.type in ("bit", "bits8"):
            words = [int(value) >> bit & 1 for bit in range(SIZES[register.type])]
        else:
            whole = value if register.type == "f32" else int(value)
            data = struct.pack(">" + CODES[register.type], whole)
            words = [int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2)]
            words = words[::-1] if self.table.low_word_first else words
        for address in register.addresses:
            block, offset = self._get_block_and_offset(AREAS[register.area], address, len(words))
            block[offset : offset + len(words)] = words

    def _number(self, register: Register, words: list[int]) -> float:
        if register.type in ("bit", "bits8"):
            return sum(bit << place for place, bit in enumerate(words))
        words = words[::-1] if self.table.low_word_first else words
        return struct.unpack(">" + CODES[register.type], struct.pack(f">{len(words)}H", *words))[0]


class _Bank(modbus.Databank):
    """The one slave at the line; none while it is silent."""

    def __init__(self, slave: MakersSlave) -> None:
        super().__init__()
        self.slave = slave

    def get_slave(self, slave_id: int) -> MakersSlave:
        """Return the slave. Raises MissingKeyError, upon which the server sends nothing."""
        if self.slave.silent or slave_id != UNIT:
            raise modbus.MissingKeyError("silent")
        return self.slave


class SerialEnd(WatchedLine):
    """A serial line without noise, with a slave at its end; modbus_tk's RTU frames."""

    def __init__(self, slave: MakersSlave) -> None:
        """Take the slave."""
        super().__init__()
        self._bank, self._answers = _Bank(slave), b""

    def write(self, data: bytes, now: float) -> None:
        """Send a request: the slave answers at once."""
        self._answers = bytes(self._bank.handle_request(modbus_rtu.RtuQuery(), data) or b"")  # type: ignore[arg-type]

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return the answer."""
        answer, self._answers = self._answers, b""
        return [(now, answer)] if answer else []

    def close(self) -> None:
        """Do nothing: it has no descriptor."""


def _spans(table: Table) -> Iterator[tuple[Area, int, int]]:
    """Yield the runs of addresses that the table names: area, start, size."""
    taken = {
        (register.area, address + place)
        for register in table.registers
        for address in register.addresses
        for place in range(SIZES[register.type])
    }
    for area in AREAS:
        for address in sorted(place for where, place in taken if where == area and (where, place - 1) not in taken):
            size = 1
            while (area, address + size) in taken:
                size += 1
            yield area, address, size


logging.getLogger("modbus_tk").setLevel(logging.CRITICAL + 1)  # it reports each request that a silent slave ignores


@contextmanager
def served(slave: MakersSlave) -> Iterator[int]:
    """Serve a slave; yields its TCP port."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = int(free.getsockname()[1])
    server = modbus_tcp.TcpServer(port=port, address="127.0.0.1", databank=_Bank(slave))
    server.start()
    end_s = clock.monotonic() + PATIENCE_S
    while not _listens(port):
        assert clock.monotonic() < end_s, f"no server at port {port}"
        clock.sleep_until(clock.monotonic() + 0.02)
    try:
        yield port
    finally:
        Timer(0.02, _listens, [port]).start()  # its thread checks for the end after a request, or a second
        server.stop()


def _listens(port: int) -> bool:
    """Return whether the server's thread has begun to listen."""
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0
