"""A hand-written drive for the drivers' tests: bytes in, bytes out, as simple as it can be."""

from __future__ import annotations

import struct
from collections.abc import Callable

from drivers.axis import AxisConfig
from drivers.canopen.master import CanMaster
from drivers.ports import CanFrame, FrameByFrame
from drivers.servo import ServoDrive

NODE = 5

# Sizes in bytes of the objects a bring-up touches, from CiA 301/402, not from our dictionary.
SIZES = {
    0x1000: 4, 0x1001: 1, 0x1003: 4, 0x1006: 4, 0x1016: 4, 0x1017: 2, 0x1018: 4, 0x1029: 1, 0x1400: 4, 0x1401: 4,
    0x1600: 4, 0x1601: 4, 0x1800: 4, 0x1801: 4, 0x1A00: 4, 0x1A01: 4, 0x6007: 2, 0x603F: 2, 0x6040: 2, 0x6041: 2,
    0x605A: 2, 0x605B: 2, 0x605C: 2, 0x605D: 2, 0x605E: 2,
    0x6060: 1, 0x6061: 1, 0x6064: 4, 0x6067: 4, 0x606C: 4, 0x6072: 2,
    0x6076: 4, 0x607A: 4, 0x607C: 4, 0x607D: 4, 0x6080: 4, 0x6081: 4, 0x6083: 4, 0x6084: 4, 0x6085: 4, 0x6098: 1,
    0x6099: 4, 0x609A: 4, 0x60FD: 4, 0x60FE: 4, 0x60FF: 4, 0x6502: 4,
}
RECORDS = {0x1003, 0x1016, 0x1018, 0x1029, 0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1801, 0x1A00, 0x1A01, 0x607D,
           0x6099, 0x60FE}
FACTS = {
    (0x1000, 0): 0x00020192, (0x1018, 0): 4, (0x1018, 1): 0x000F71C7, (0x1018, 2): 0x402, (0x1018, 3): 1,
    (0x1018, 4): 77, (0x6502, 0): 0x25, (0x6041, 0): 0x0240, (0x6076, 0): 10_000,
}


def wheel(**changes: object) -> AxisConfig:
    """Return the configuration of a velocity axis: 1000 counts per rad/s, 10 N m rated."""
    fields: dict[str, object] = {
        "name": "wheel", "node_id": NODE, "mode": "velocity", "unit": "rad/s", "velocity_increments": 1000.0,
        "position_increments": 0.0, "feedback": "velocity", "rated_torque_nm": 10.0, "max_speed": 50.0,
        "acceleration": 20.0, "deceleration": 20.0, "quick_stop_deceleration": 60.0,
    }
    return AxisConfig(**{**fields, **changes})  # type: ignore[arg-type]


def yaw(**changes: object) -> AxisConfig:
    """Return the configuration of a position axis: 100 counts per degree, -30..30 deg."""
    fields: dict[str, object] = {
        "name": "sideslip", "node_id": NODE, "mode": "position", "unit": "deg", "velocity_increments": 100.0,
        "position_increments": 100.0, "feedback": "position", "rated_torque_nm": 10.0, "max_speed": 10.0,
        "acceleration": 20.0, "deceleration": 20.0, "quick_stop_deceleration": 60.0,
        "software_limits": (-30.0, 30.0),
    }
    return AxisConfig(**{**fields, **changes})  # type: ignore[arg-type]


def tpdo1(statusword: int, value: int, torque: int) -> bytes:
    """Return the bytes of a TPDO1."""
    return struct.pack("<Hih", statusword, value, torque)


def joined(config: AxisConfig, statusword: int = 0x0240, raw: int = 0) -> ServoDrive:
    """Return a drive as it is after a successful connect, without the conversation."""
    drive = ServoDrive(config)
    drive.on_heartbeat(0.0, 5)
    drive.finish_connect(statusword, raw, inputs=0)
    return drive


class BenchDrive(FrameByFrame):
    """A CanPort with one drive behind it: boot-up, NMT, heartbeat on request and an expedited SDO server.

    ``objects`` are its values by (index, sub); ``aborts`` gives abort codes by ("read" or "write", index, sub);
    ``on_write`` may replace what a write stores. ``sent`` is every frame the PC sent: (time, identifier, data).
    Replies arrive one millisecond after the request.
    """

    def __init__(self, node: int = NODE) -> None:
        self.node = node
        self.objects: dict[tuple[int, int], int] = dict(FACTS)
        self.aborts: dict[tuple[str, int, int], int] = {}
        self.on_write: Callable[[int, int, int], int] | None = None
        self.sent: list[CanFrame] = []
        self.boots = True
        self.answers = True
        self.starts = True
        self.nmt_state = 127
        self.writes: list[tuple[int, int, int]] = []
        self._waiting: list[CanFrame] = []

    def send(self, can_id: int, data: bytes, now: float) -> None:
        self.sent.append((now, can_id, data))
        if can_id == 0 and data[1] == self.node:
            self._on_nmt(data[0], now + 0.001)
        elif can_id == 0x600 + self.node and self.answers:
            reply = self._sdo(data)
            if reply is not None:
                self.reply(0x580 + self.node, reply, now + 0.001)

    def receive(self, now: float) -> list[CanFrame]:
        taken = [frame for frame in self._waiting if frame[0] <= now]
        self._waiting = [frame for frame in self._waiting if frame[0] > now]
        return taken

    def reply(self, can_id: int, data: bytes, t: float) -> None:
        self._waiting.append((t, can_id, data))

    def heartbeat(self, t: float) -> None:
        if self.objects.get((0x1017, 0)):
            self.reply(0x700 + self.node, bytes([self.nmt_state]), t)

    def _on_nmt(self, command: int, t: float) -> None:
        if command == 130 and self.boots:
            self.nmt_state = 127
            self.reply(0x700 + self.node, b"\0", t)
        elif command == 1 and self.starts:
            self.nmt_state = 5
        elif command == 128:
            self.nmt_state = 127

    def _sdo(self, request: bytes) -> bytes | None:
        command = request[0]
        index, sub = struct.unpack_from("<HB", request, 1)
        if command == 0x80:
            return None
        kind = "read" if command == 0x40 else "write"
        abort = self.aborts.get((kind, index, sub))
        if abort is not None:
            return struct.pack("<BHBI", 0x80, index, sub, abort)
        size = 1 if sub == 0 and index in RECORDS else SIZES[index]
        if (index, sub) in {(c, s) for c in (0x1400, 0x1401, 0x1800, 0x1801) for s in (2, 3, 5)}:
            size = 1 if sub == 2 else 2
        if kind == "read":
            value = self.objects.get((index, sub), 0)
            data = (value & (1 << 8 * size) - 1).to_bytes(size, "little")
            return struct.pack("<BHB", 0x43 | (4 - size) << 2, index, sub) + data.ljust(4, b"\0")
        assert command == 0x23 | (4 - size) << 2, f"0x{index:04X}:{sub} written with {command:#x}"
        value = int.from_bytes(request[4:4 + size], "little")
        self.writes.append((index, sub, value))
        stored = self.on_write(index, sub, value) if self.on_write else value
        self.objects[index, sub] = stored
        if index == 0x6060:
            self.objects[0x6061, 0] = stored
        return struct.pack("<BHB", 0x60, index, sub) + bytes(4)


def converse(master: CanMaster, drive: ServoDrive, bench: BenchDrive, seconds: float, start: float = 0.0,
             each: Callable[[float], None] | None = None) -> float:
    """Serve the master every millisecond until the conversation has ended or ``seconds`` have passed."""
    now = start
    for tick in range(round(seconds * 1000)):
        now = start + tick / 1000
        if tick % 50 == 0:
            bench.heartbeat(now)
        master.feed(bench.receive(now), now)
        if each is not None:
            each(now)
        master.service(bench, now)
        if not master.busy(drive):
            return now
    return now
