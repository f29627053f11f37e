"""Records frames of live wires in the format of a run's own bus log, so that a test can replay them to the drivers."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from drivers.modbus.tap import LineTap
from drivers.transports.can_bus import open_can
from drivers.transports.serial_line import SerialLine, open_serial_line
from tester.base import clock
from tester.run.bus_log import CanLog, LineLog

LOOK_S = 0.002
"""Period for reading the wires, s: the resolution of the time stamps [A]."""
_MASTER_FUNCTIONS = frozenset((0x000, 0x200, 0x300, 0x400, 0x500, 0x600))
"""Function codes of a master's frames, besides SYNC: NMT, RPDOs, SDO requests (CiA 301, 7.3.3)."""
_SYNC, _HEARTBEAT = 0x080, 0x700


@dataclass(frozen=True, slots=True)
class LineTapped:
    """A serial port to record: its name in the record, and its settings (bit/s)."""

    name: str
    port: str
    baud: int


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """The wires to record, and for how long (s)."""

    folder: Path
    seconds: float
    can: tuple[str, str] | None = None
    bitrate: int = 500_000
    master: int = 127
    """Node id of the master, whose heartbeats count as a master's frames."""
    lines: tuple[LineTapped, ...] = ()


@dataclass(slots=True)
class Recorded:
    """The number of recorded frames on each wire, and the number of bytes outside any frame."""

    frames: dict[str, int] = field(default_factory=dict[str, int])
    garbage: int = 0


def from_master(can_id: int, master: int) -> bool:
    """Return whether the master sends this frame."""
    return can_id == _SYNC or can_id == _HEARTBEAT + master or can_id & 0x780 in _MASTER_FUNCTIONS


def record(options: RecordOptions, stopped: Callable[[], bool]) -> Recorded:
    """Record until the time is over, or ``stopped`` returns True; return the counts. Raises BusLost and OSError.

    Sends nothing, but a CAN adapter acknowledges frames as any node does.
    """
    counts = Recorded()
    with ExitStack() as opened:
        begin = clock.monotonic()
        options.folder.mkdir(parents=True, exist_ok=True)
        bus = None
        if options.can is not None:
            bus = open_can(*options.can, options.bitrate, lambda: clock.monotonic() - begin)
            opened.callback(bus.close)
            counts.frames["can"] = 0
        lines: list[tuple[LineTapped, SerialLine, LineTap]] = []
        for line in options.lines:
            port = open_serial_line(line.port, line.baud)
            opened.callback(port.close)
            lines.append((line, port, LineTap()))
            counts.frames[line.name] = 0
        can_log = CanLog(options.folder / "can.log") if bus is not None else None
        if can_log is not None:
            opened.callback(can_log.close)
        logs: dict[str, LineLog] = {}
        for line in options.lines:
            logs[line.name] = LineLog(options.folder / f"modbus-{line.name}.log")
            opened.callback(logs[line.name].close)
        now = 0.0
        while now < options.seconds and not stopped():
            clock.sleep_until(clock.monotonic() + LOOK_S)
            now = clock.monotonic() - begin
            if bus is not None and can_log is not None:
                for t, can_id, data in bus.receive(now):
                    can_log.frame(t, can_id, data, from_master(can_id, options.master))
                    counts.frames["can"] += 1
            for line, port, tap in lines:
                for t, data in port.read(now):
                    for frame, sent in tap.feed(data):
                        logs[line.name].frame(t, frame, sent)
                        counts.frames[line.name] += 1
        counts.garbage = sum(tap.garbage for _, _, tap in lines)
    return counts

