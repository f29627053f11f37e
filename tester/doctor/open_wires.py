"""The doctor's wires to a rig, real or simulated: opened one at a time, with other settings if needed."""

from __future__ import annotations

from drivers.ports import CanPort, LinePort
from drivers.transports.can_bus import PythonCanPort, open_can
from drivers.transports.open_line import open_line
from drivers.transports.serial_line import SerialLine
from drivers.transports.tcp_line import TcpLine
from sim.rig import SimRig
from sim.wires.mistuned import MistunedCan, MistunedLine
from tester.base.clock import Pace
from tester.inputs.rig import LineConfig, Rig
from tester.run.simulated import simulated_ports

BITRATES = (1_000_000, 800_000, 500_000, 250_000, 125_000)
"""Bit rates of CANopen that a rig file can state, bit/s (CiA 301, 5.1)."""
OUTSIDE = ("socketcan", "socketcand")
"""Interfaces whose bit rate the system sets, not the program that opens the interface."""


class HardwareWires:
    """The wires of a rig file, through the computer's adapters."""

    real = True
    """Whether time passes by itself, so that the computer's lateness can be measured."""

    def __init__(self, rig: Rig) -> None:
        """Open nothing yet."""
        self._rig = rig
        self._pace = Pace()
        self._can: PythonCanPort | None = None
        self._lines: dict[str, SerialLine | TcpLine] = {}
        self.bitrates = () if rig.can.interface in OUTSIDE else BITRATES
        """Bit rates at which ``can`` can open the bus, besides the rig file's."""

    def now(self) -> float:
        """Return the seconds since the examination began."""
        return self._pace.now()

    def wait_until(self, due_s: float) -> None:
        """Wait until ``due_s`` (s)."""
        self._pace.wait_until(due_s)

    def can(self, bitrate: int) -> CanPort:
        """Open the CAN bus at a bit rate (bit/s), reopening it if needed; raises BusLost."""
        if self._can is not None:
            self._can.close()
            self._can = None
        self._can = open_can(self._rig.can.interface, self._rig.can.channel, bitrate, self._pace.now)
        return self._can

    def line(self, name: str, config: LineConfig) -> LinePort:
        """Open a Modbus line, reopening it if needed; raises BusLost."""
        before = self._lines.pop(name, None)
        if before is not None:
            before.close()
        line = open_line(config)
        self._lines[name] = line
        return line

    def close(self) -> None:
        """Close every wire."""
        if self._can is not None:
            self._can.close()
        for line in self._lines.values():
            line.close()


class SimulatedWires:
    """The wires of a simulated rig in this process, whose time passes only during waits.

    ``built``: the rig as simulated, which may differ from the rig file.
    """

    real = False
    bitrates = BITRATES

    def __init__(self, built: Rig, seed: int = 0) -> None:
        """Switch the simulated rig on at time 0. Raises InvalidSource as ``simulated_ports`` does."""
        self._built = built
        ports, world, _ = simulated_ports(built, seed, None)
        self._ports = ports
        self.world: SimRig = world
        self._now_s = 0.0

    def now(self) -> float:
        """Return the simulated seconds since the rig was switched on."""
        return self._now_s

    def wait_until(self, due_s: float) -> None:
        """Advance the rig to ``due_s`` (s)."""
        if due_s > self._now_s:
            self._now_s = due_s
            self.world.advance(due_s)

    def can(self, bitrate: int) -> CanPort:
        """Return the bus; at another bit rate, a port that receives as an adapter with the wrong setting does."""
        return self._ports.can if bitrate == self._built.can.bitrate else MistunedCan()

    def line(self, name: str, config: LineConfig) -> LinePort:
        """Return the line; with other settings, a port that receives as one with the wrong settings does."""
        built = self._built.lines[name]
        same = (config.baud, config.parity) == (built.baud, built.parity)
        return self._ports.lines[name] if same else MistunedLine()

    def close(self) -> None:
        """Do nothing: the rig is freed with the last reference to it."""


Wires = HardwareWires | SimulatedWires


def wires_of(rig: Rig, seed: int = 0) -> Wires:
    """Return the wires of a rig, simulated in this process or real; real wires are not open yet."""
    return SimulatedWires(rig, seed) if rig.can.interface == "sim" else HardwareWires(rig)
