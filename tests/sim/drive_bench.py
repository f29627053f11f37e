"""A bench for the simulated drive: frames in and out as bytes, in virtual time."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any

from drivers.axis import AxisConfig
from sim.nodes.cia402_slave import Axis, Cia402Slave
from sim.wires.can_wire import CanWire

NODE = 5
PC = 127

WHEEL = AxisConfig(
    name="wheel",
    node_id=NODE,
    mode="velocity",
    unit="rad/s",
    velocity_increments=1000.0,
    position_increments=0.0,
    feedback="velocity",
    rated_torque_nm=20.0,
    max_speed=30.0,
    acceleration=10.0,
    deceleration=10.0,
    quick_stop_deceleration=40.0,
)
PRESS = replace(
    WHEEL, name="press", unit="mm/s", position_increments=1000.0, feedback="position", digital_io=True
)
YAW = replace(
    WHEEL,
    name="sideslip",
    mode="position",
    unit="deg",
    velocity_increments=100.0,
    position_increments=100.0,
    feedback="position",
    acceleration=20.0,
    deceleration=20.0,
)

# Statusword states under the mask 0x6F (0x4F for those without the quick stop bit).
DISABLED, READY, SWITCHED_ON, ENABLED, QUICK_STOP = 0x40, 0x21, 0x23, 0x27, 0x07
REACTION, FAULT = 0x0F, 0x08


class SdoRefusedError(Exception):
    """The drive answered with an abort; ``code`` is its abort code."""

    def __init__(self, code: int) -> None:
        super().__init__(f"0x{code:08X}")
        self.code = code


class DriveBench:
    """One simulated drive, the wire, and a computer that speaks bytes."""

    def __init__(self, config: AxisConfig = WHEEL, axis: Axis | None = None, **options: Any) -> None:
        self.config = config
        self.wire = CanWire()
        self.drive = Cia402Slave(config, self.wire, axis, **options)
        self.now = 0.0
        self.heard: list[tuple[float, int, bytes]] = []
        self.tpdo = b""

    # time and frames

    def run(self, seconds: float, dt: float = 0.005) -> None:
        """Let time pass in ticks of ``dt``, collecting what the drive sends."""
        for _ in range(round(seconds / dt)):
            self.drive.advance(self.now, self.now + dt)
            self.now += dt
            self.collect()

    def collect(self) -> None:
        for t, can_id, data in self.wire.receive(self.now):
            self.heard.append((t, can_id, data))
            if can_id == 0x180 + NODE:
                self.tpdo = data

    def send(self, can_id: int, data: bytes) -> None:
        self.wire.send(can_id, data, self.now)

    def frames(self, can_id: int) -> list[bytes]:
        return [data for _, heard_id, data in self.heard if heard_id == can_id]

    def times(self, can_id: int) -> list[float]:
        return [t for t, heard_id, _ in self.heard if heard_id == can_id]

    @property
    def emergencies(self) -> list[tuple[int, int]]:
        """(error code, error register) of every EMCY so far."""
        return [(data[0] | data[1] << 8, data[2]) for data in self.frames(0x80 + NODE)]

    def boot(self) -> DriveBench:
        self.run(0.3)
        return self

    def nmt(self, command: int) -> None:
        self.send(0x000, bytes((command, NODE)))

    def heartbeat(self) -> None:
        self.send(0x700 + PC, b"\x05")

    # SDO

    def sdo(self, request: bytes) -> bytes:
        """Send eight bytes to the SDO server and return its answer."""
        count = len(self.frames(0x580 + NODE))
        self.send(0x600 + NODE, request)
        self.run(0.005, 0.001)
        answers = self.frames(0x580 + NODE)
        assert len(answers) == count + 1, "no answer"
        return answers[-1]

    def raw(self, request: str) -> str:
        return self.sdo(bytes.fromhex(request)).hex(" ")

    def read(self, index: int, sub: int = 0, signed: bool = False) -> int:
        answer = self.sdo(struct.pack("<BHBI", 0x40, index, sub, 0))
        if answer[0] == 0x80:
            raise SdoRefusedError(int.from_bytes(answer[4:], "little"))
        size = 4 - (answer[0] >> 2 & 3)
        return int.from_bytes(answer[4 : 4 + size], "little", signed=signed)

    def write(self, index: int, sub: int, value: int, size: int) -> None:
        data = value.to_bytes(size, "little", signed=value < 0).ljust(4, b"\0")
        answer = self.sdo(struct.pack("<BHB", 0x23 | (4 - size) << 2, index, sub) + data)
        if answer[0] == 0x80:
            raise SdoRefusedError(int.from_bytes(answer[4:], "little"))

    def refusal(self, index: int, sub: int, value: int, size: int) -> int:
        """Return the abort code of a write that must be refused."""
        try:
            self.write(index, sub, value, size)
        except SdoRefusedError as refused:
            return refused.code
        raise AssertionError("accepted")

    def refused_read(self, index: int, sub: int = 0) -> int:
        try:
            self.read(index, sub)
        except SdoRefusedError as refused:
            return refused.code
        raise AssertionError("accepted")

    # process data

    def sync(self) -> None:
        self.send(0x080, b"")

    def cycle(self, controlword: int, target: int = 0, seconds: float = 0.01) -> None:
        """RPDO1, SYNC, and time until the TPDO is there."""
        self.send(0x200 + NODE, struct.pack("<Hi", controlword, target))
        self.sync()
        self.run(seconds, min(seconds, 0.005))

    @property
    def statusword(self) -> int:
        return self.drive.statusword

    @property
    def state(self) -> int:
        """State bits of the statusword, quick stop bit masked where it does not count."""
        word = self.drive.statusword & 0x6F
        return word & 0x4F if not word & 0x20 or word & 0x48 else word

    def sample(self) -> tuple[int, int, int]:
        """(statusword, 32-bit field, torque) of the last TPDO1."""
        status, value, torque = struct.unpack("<Hih", self.tpdo)
        return status, value, torque

    # usual preparations

    def configured(self, mode: int = 3) -> DriveBench:
        """Boot, choose the mode, set the ramps of the configuration, start the node."""
        self.boot()
        per = self.config.velocity_increments
        self.write(0x6060, 0, mode, 1)
        self.write(0x6083, 0, round(self.config.acceleration * per), 4)
        self.write(0x6084, 0, round(self.config.deceleration * per), 4)
        self.write(0x6085, 0, round(self.config.quick_stop_deceleration * per), 4)
        if self.config.mode == "position":
            self.write(0x6081, 0, round(self.config.max_speed * per), 4)
            self.map(0x1400, 0x1600, 0x200 + NODE, 1, (0x60400010, 0x607A0020))
        if self.config.feedback == "position":
            self.map(0x1800, 0x1A00, 0x40000180 + NODE, 1, (0x60410010, 0x60640020, 0x60770010))
        self.nmt(1)
        self.run(0.01)
        return self

    def enabled(self, mode: int = 3) -> DriveBench:
        """As ``configured``, then up to OPERATION ENABLED with target 0."""
        self.configured(mode)
        for controlword in (0x06, 0x07, 0x0F):
            self.cycle(controlword)
        return self

    def map(self, communication: int, mapping: int, cob_id: int, kind: int, entries: tuple[int, ...]) -> None:
        """Change a PDO in the order CiA 301 asks for."""
        self.write(communication, 1, 0x80000000 | cob_id, 4)
        self.write(mapping, 0, 0, 1)
        for sub, entry in enumerate(entries, start=1):
            self.write(mapping, sub, entry, 4)
        self.write(mapping, 0, len(entries), 1)
        self.write(communication, 2, kind, 1)
        self.write(communication, 1, cob_id, 4)
