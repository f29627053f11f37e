"""One of our drivers at a maker's slave: virtual time, every answer awaited."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from select import select

import numpy as np

from drivers.modbus import ModbusLink
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from drivers.transports.tcp_line import TcpLine, open_tcp_line
from tester.base import clock
from tests.campaigns.makers.slave import MakersSlave, SerialEnd, served
from tests.campaigns.makers.table import Table
from tests.peers.exchange import PATIENCE_S

SCAN_S = 0.01
"""Time between two services of the link, s."""
LOOK_S = 0.05
"""Longest time between two looks for an answer over TCP, s of the wall: a new connection may not be open yet."""
NAMED = (1, 2, 3)
"""Exceptions that a driver reports by their number: the device does not match the profile."""
PASSING = (4, 6)
"""Exceptions of a device that fails or is busy temporarily."""
READS, WRITES = (1, 2, 3, 4), (5, 6, 15, 16)
Driver = Sensor | TemperatureController
Build = Callable[[ModbusLink], Driver]


@dataclass
class Tally:
    """Counts of cases, and their failures."""

    counts: Counter[str] = field(default_factory=Counter[str])
    wrong: list[str] = field(default_factory=list[str])

    def judge(self, kind: str, right: bool, text: str) -> None:
        """Count a case of ``kind``; ``text``: its failure."""
        self.counts[kind] += 1
        if not right:
            self.wrong.append(f"{kind}: {text}")


class Seat:
    """A driver on a connection to a slave."""

    def __init__(self, slave: MakersSlave, line: TcpLine | SerialEnd, build: Build, link: ModbusLink) -> None:
        """Build the driver on its link. Raises the constructor's exceptions."""
        self.slave, self.line, self.link = slave, line, link
        self.driver = build(link)
        self.now = 0.0
        self.each: Callable[[], None] = lambda: None
        """Called at every scan."""

    def run(self, seconds: float) -> None:
        """Serve the link for a time."""
        counters, end_s = self.driver.station.counters, self.now + seconds
        while self.now < end_s:
            self.each()
            before = counters.requests
            self.link.service(self.line, self.now)
            self.now += 0.5 * SCAN_S
            chunks = self.line.read(self.now)
            patient_s = clock.monotonic() + PATIENCE_S
            while not chunks and counters.requests > before and not self.slave.silent:
                assert clock.monotonic() < patient_s, "the server is silent"
                if isinstance(self.line, TcpLine):
                    select([self.line], [], [], LOOK_S)
                chunks = self.line.read(self.now)
            self.link.feed(chunks, self.now)
            self.now += 0.5 * SCAN_S


@dataclass
class Place:
    """A table's slave, with everything that a campaign's cases need."""

    table: Table
    slave: MakersSlave
    port: int
    """TCP port; 0 = serial line."""

    @contextmanager
    def seat(self, build: Build) -> Iterator[Seat]:
        """Connect a driver to the slave, over a new connection."""
        line = open_tcp_line("127.0.0.1", self.port, PATIENCE_S) if self.port else SerialEnd(self.slave)
        settings = load_profile(self.table.profile).line
        link = ModbusLink(self.table.framing, settings.baud, settings.parity, settings.stop_bits)
        try:
            yield Seat(self.slave, line, build, link)
        finally:
            line.close()

    def measure(
        self, source: random.Random, within: Callable[[str], tuple[float, float]], inside: bool = False
    ) -> None:
        """Let the device measure numbers drawn over their ranges, the ends among them.

        ``within``: the profile's bounds of a channel in its own unit; half of the draws, or all with ``inside``, are
        between them.
        """
        for channel, (name, factor) in self.table.shown.items():
            register = self.table[name]
            if not register.measured:
                continue
            least, greatest = register.least, register.greatest
            if inside or source.random() < 0.5:
                low, high = within(channel)
                least, greatest = max(least, low / factor), min(greatest, high / factor)
            drawn = source.choice([least, greatest, *(source.uniform(least, greatest) for _ in range(6))])
            self.slave.put(name, float(np.float32(drawn)))

    def truth(self, channel: str) -> tuple[float, float]:
        """Return the device's number in the channel's unit, and a step of an f32, or half a count."""
        name, factor = self.table.shown[channel]
        value = self.slave.get(name)
        step = float(np.spacing(np.float32(abs(value)))) if self.table[name].type == "f32" else 0.5
        return value * factor, step * factor


@contextmanager
def placed(table: Table) -> Iterator[Place]:
    """Make the slave of a table, and serve it if it speaks Modbus TCP."""
    slave = MakersSlave(table)
    if table.framing == "rtu":
        yield Place(table, slave, 0)
        return
    with served(slave) as port:
        yield Place(table, slave, port)


def narrowed(table: Table, name: str, greatest: float) -> Table:
    """Return the table of a device that accepts less in a register than its maker's table states."""
    return replace(
        table,
        registers=tuple(
            replace(register, greatest=greatest) if register.name == name else register for register in table.registers
        ),
    )
