"""Open the wires to a real rig: a CAN adapter and Modbus lines, each with its own clock origin."""

from __future__ import annotations

from collections.abc import Callable

from drivers.edges.can_bus import open_can
from drivers.edges.serial_line import open_serial_line
from drivers.edges.tcp_line import open_tcp_line
from drivers.ports import CanPort, LinePort
from tester import clock
from tester.bus_log import BusLog, TappedCan, TappedLine
from tester.engine.build import Ports
from tester.rig import LineConfig, RigConfig


def run_clock() -> Callable[[], float]:
    """Return a clock that starts now: arrival times are seconds of the run."""
    origin = clock.monotonic()
    return lambda: clock.monotonic() - origin


def hardware_ports(rig: RigConfig, log: BusLog | None) -> Ports:
    """Open every wire of a rig file; raises BusLost for the first that cannot be opened."""
    now = run_clock()
    can: CanPort = open_can(rig.can.interface, rig.can.channel, rig.can.bitrate, now)
    lines: dict[str, LinePort] = {name: _line(line) for name, line in rig.lines.items()}
    if log is not None:
        can = TappedCan(can, log.can)
        lines = {name: TappedLine(line, log.lines[name]) for name, line in lines.items()}
    return Ports(can, lines)


def _line(config: LineConfig) -> LinePort:
    if config.framing == "socket":
        host, _, port = config.port.rpartition(":")
        return open_tcp_line(host, int(port))
    return open_serial_line(config.port, config.baud, config.parity)
