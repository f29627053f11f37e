"""A Modbus device of the simulated rig on its line, with the driver under test on the other end."""

from __future__ import annotations

from drivers.modbus import ModbusLink
from sim.nodes.modbus_slave import ModbusSlave
from sim.wires.modbus_wire import ModbusWire


class Quantities:
    """The values at the sensors; tests set them."""

    def __init__(self) -> None:
        self.forces = (100.0, -20.0, 200.0, 0.5)
        self.surface_c = 40.0
        self.hub_c = 45.0
        self.asked: list[float] = []

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        self.asked.append(t)
        return self.forces

    def surface_measured_c(self, t: float) -> float:
        self.asked.append(t)
        return self.surface_c

    def controller_measured_c(self, t: float) -> float:
        self.asked.append(t)
        return self.hub_c


class Log:
    """A watcher that keeps every frame."""

    def __init__(self) -> None:
        self.frames: list[tuple[float, bytes, bool]] = []

    def frame(self, t: float, data: bytes, from_pc: bool) -> None:
        self.frames.append((t, data, from_pc))

    def requests(self, head: str) -> list[tuple[float, bytes]]:
        """Return the requests that begin with these bytes."""
        start = bytes.fromhex(head)
        return [(t, data) for t, data, from_pc in self.frames if from_pc and data.startswith(start)]


class Rig:
    """Link and wire in scans of ``period_s``; the link's deadlines are kept in between.

    ``sparing``: serve the link and read the wire only when they report work to do.
    """

    def __init__(self, baud: int, *slaves: ModbusSlave, period_s: float = 0.01, sparing: bool = False) -> None:
        self.link = ModbusLink("rtu", baud)
        self.wire = ModbusWire(baud, "N", slaves)
        self.slaves = slaves
        self.log = Log()
        self.wire.watch(self.log.frame)
        self.period_s = period_s
        self.sparing = sparing
        self.now = 0.0

    def run(self, seconds: float, every_scan: object = None) -> None:
        """Let time pass; ``every_scan`` is called in each scan."""
        end = self.now + seconds
        scan_s = self.now
        while self.now < end - 1e-9:
            scan = self.now >= scan_s - 1e-9
            for slave in self.slaves:
                if slave.due_s <= self.now:
                    slave.advance(self.now, self.now)
            if not self.sparing or self.wire.arrives_s <= self.now:
                self.link.feed(self.wire.read(self.now), self.now)
            if scan:
                scan_s += self.period_s
                if callable(every_scan):
                    every_scan()
            if not self.sparing or self.now >= self.link.wants_s:
                self.link.service(self.wire, self.now, scan=scan)
            self.now = min(scan_s, max(self.link.deadline, self.now + 2e-4))
