"""`python -m tests.campaigns.registers [--sample] [--cases N] [--seed N]`: does a number change in transit?

Each case draws a profile by seed: type, scale, offset and order of a channel and of a parameter, the write function, a
password before it, a self-test to wait for. Our driver then talks to one of three third-party Modbus TCP servers
(pymodbus, pyModbusTCP, modbus_tk). Numpy and another client read the server's registers: a parameter must be within
half a count of its value (f32: within its precision), and a channel must read as written there. A value that does not
fit must be refused. Prints a line a figure; exit status 1 where a value changed silently.
"""

from __future__ import annotations

import argparse
import asyncio
import logging
import random
import socket
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from threading import Thread

import numpy as np
from modbus_tk import defines, modbus_tcp
from pymodbus.client import ModbusTcpClient
from pymodbus.datastore import ModbusDeviceContext, ModbusSequentialDataBlock, ModbusServerContext
from pymodbus.server import ModbusTcpServer
from pyModbusTCP.server import ModbusServer

from drivers.profiles import ProfileError, read_profile
from drivers.profiles.numbers import LIMITS, MOST_F32
from drivers.sensor import Sensor
from drivers.transports.tcp_line import open_tcp_line
from tester.base import clock
from tests.campaigns.acceptance.figure import Figure, at_least, equal
from tests.peers.exchange import PATIENCE_S, Exchange

CASES, SAMPLE_CASES = 2000, 150
SIZE = 200
"""Registers of each server."""
CHANNEL, PARAMETER, PASSWORD, TEST = 0, 20, 40, 60
"""Addresses."""
NUMPY = {"u16": ">u2", "i16": ">i2", "u32": ">u4", "i32": ">i4", "f32": ">f4"}
SCALES = (1.0, 0.1, 0.01, 0.001, 1e-4, 0.05, 2.5, 1e-6)
OFFSETS = (0.0, 0.0, -40.0, 273.15, -250.0, 0.5)
PROFILE = """
kind = "sensor"
title = "drawn"
functions = [3, 6, 16]
write_function = {function}
word_order = "{words}"
byte_order = "{bytes}"
line = {{ baud = 38400, parity = "N" }}
timing = {{ turnaround_ms = 5.0, reply_max_ms = 60.0, retries = 1 }}
[signals]
channel = {{ address = 0, type = "{type}", scale = {scale!r}, offset = {offset!r}, unit = "K" }}
[[reads]]
signals = ["channel"]
period_ms = 100
[writes]
parameter = {{ address = 20, type = "{type}", scale = {scale!r}, offset = {offset!r} }}
[[setup]]
name = "password"
address = 40
type = "{password_type}"
value = {password!r}
[[setup]]
name = "self-test"
address = 60
value = 3
write = false
within_ms = 60000
"""


@dataclass(frozen=True)
class Case:
    """A drawn profile, and the values to transfer."""

    type: str
    scale: float
    offset: float
    words: str
    bytes: str
    function: int
    password_type: str
    password: float
    parameter: float
    counts: float
    """Counts of the channel."""
    fits: bool
    """Whether the parameter fits into its register."""

    @property
    def text(self) -> str:
        """Return the profile."""
        return PROFILE.format(**vars(self))


def draw(source: random.Random) -> Case:
    """Draw a case; one parameter in eight does not fit."""
    kind, password_type = source.choice([*NUMPY]), source.choice([*NUMPY])
    scale, offset = source.choice(SCALES), source.choice(OFFSETS)
    fits = source.random() > 0.125
    if kind == "f32":
        counts = source.choice([0.0, 1.0, -1e-3, source.uniform(-1e6, 1e6), source.gauss(0.0, 1.0)])
        asked = source.uniform(-1e6, 1e6) if fits else source.choice([2.0, -3.0]) * MOST_F32
    else:
        least, greatest = LIMITS[kind]  # type: ignore[index]
        counts = source.choice([least, greatest, source.randint(least, greatest), source.randint(0, 100)])
        inside = source.choice([least, greatest, source.uniform(least, greatest)])
        asked = inside if fits else source.choice([least - 0.6 - source.expovariate(1.0), greatest + 0.6])
    least, greatest = LIMITS[password_type]  # type: ignore[index]
    return Case(
        kind, scale, offset, source.choice(["high_first", "low_first"]), source.choice(["high_first", "low_first"]),
        source.choice([6, 16]), password_type, float(source.randint(least, greatest)), asked * scale + offset,
        float(counts), fits,
    )  # fmt: skip


def on_wire(value: float, kind: str, case: Case) -> list[int]:
    """Return the registers of a number by numpy, in the case's order."""
    data = np.array([value]).astype(NUMPY[kind])
    if data.itemsize == 2:
        return data.view(">u2").tolist()
    words = data.view(">u2")
    words = words.byteswap() if case.bytes == "low_first" else words
    return (words[::-1] if case.words == "low_first" else words).tolist()


def in_registers(words: list[int], kind: str, case: Case) -> float:
    """Return the number in registers by numpy: the inverse of ``on_wire``."""
    data = np.array(words, dtype=">u2")
    if len(words) == 2:
        data = data[::-1] if case.words == "low_first" else data
        data = data.byteswap() if case.bytes == "low_first" else data
    return float(np.ascontiguousarray(data).view(NUMPY[kind])[0])


class Bench:
    """A server, and another client that reads it."""

    def __init__(self, port: int) -> None:
        """Connect the other client."""
        self.port = port
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=PATIENCE_S)
        end_s = clock.monotonic() + PATIENCE_S
        while not self.client.connect():  # its thread has not begun to listen
            assert clock.monotonic() < end_s, f"no server at port {port}"
            clock.sleep_until(clock.monotonic() + 0.02)

    def put(self, address: int, words: list[int]) -> None:
        """Write registers."""
        assert not self.client.write_registers(address, words, device_id=1).isError()

    def get(self, address: int, count: int) -> list[int]:
        """Read registers."""
        return list(self.client.read_holding_registers(address, count=count, device_id=1).registers)

    def conduct(self, case: Case) -> str:
        """Return what went wrong in a case, "" if nothing did, or "refused"."""
        try:
            profile = read_profile("drawn", case.text)
        except ProfileError as error:
            return f"profile refused: {error}"
        self.put(CHANNEL, on_wire(case.counts, case.type, case))
        self.put(PARAMETER, [0, 0])
        self.put(PASSWORD, [0, 0])
        self.put(TEST, [0])
        line = open_tcp_line("127.0.0.1", self.port, PATIENCE_S)
        exchange = Exchange(line)
        try:
            try:
                sensor = Sensor(profile, 1, exchange.link, parameters={"parameter": case.parameter})
            except ValueError:
                return "refused"
            asks = sensor.station.counters
            exchange.until(lambda: asks.replies >= 6)
            if sensor.ready:
                return "ready before its self-test"
            self.put(TEST, [3])
            exchange.until(lambda: sensor.valid)
            return self._compare(case, sensor)
        finally:
            line.close()

    def _compare(self, case: Case, sensor: Sensor) -> str:
        size = len(on_wire(0.0, case.type, case))
        counts = in_registers(self.get(PARAMETER, size), case.type, case)
        arrived = counts * case.scale + case.offset
        if not abs(arrived - case.parameter) <= tolerance(case, counts, case.parameter):
            return f"parameter {case.parameter!r} arrived as {arrived!r}"
        read, value = sensor.raw[0], np.float32(case.counts) * np.float64(case.scale) + case.offset
        if case.type != "f32":
            value = case.counts * case.scale + case.offset
        if read != value:
            return f"channel {value!r} was read as {read!r}"
        words = self.get(PASSWORD, len(on_wire(0.0, case.password_type, case)))
        password = in_registers(words, case.password_type, case)
        if password != float(np.float32(case.password) if case.password_type == "f32" else case.password):
            return f"password {case.password!r} arrived as {password!r}"
        return ""


def tolerance(case: Case, counts: float, value: float) -> float:
    """Return half a count, or the precision of an f32, plus the rounding of the arithmetic itself."""
    rounding = 4e-16 * (abs(value) + abs(case.offset) + abs(counts * case.scale))
    return rounding + case.scale * (float(np.spacing(np.float32(abs(counts)))) if case.type == "f32" else 0.5)


def free_port() -> int:
    """Return a port chosen by the kernel."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])


@contextmanager
def by_py_modbus_tcp() -> Iterator[Bench]:
    """Run a server of pyModbusTCP."""
    server = ModbusServer("127.0.0.1", free_port(), no_block=True)
    server.start()
    try:
        yield Bench(server.port)
    finally:
        server.stop()


@contextmanager
def by_modbus_tk() -> Iterator[Bench]:
    """Run a server of modbus_tk."""
    logging.getLogger("modbus_tk").setLevel(logging.CRITICAL)  # it reports each connection that our end closes
    server = modbus_tcp.TcpServer(port=(port := free_port()), address="127.0.0.1")
    server.add_slave(1).add_block("0", defines.HOLDING_REGISTERS, 0, SIZE)
    server.start()
    try:
        yield Bench(port)
    finally:
        server.stop()


@contextmanager
def by_pymodbus() -> Iterator[Bench]:
    """Run a server of pymodbus in a thread."""
    loop, port = asyncio.new_event_loop(), free_port()
    store = ModbusServerContext(ModbusDeviceContext(hr=ModbusSequentialDataBlock(1, [0] * SIZE)), single=True)

    async def begin() -> ModbusTcpServer:
        server = ModbusTcpServer(store, address=("127.0.0.1", port))
        await server.serve_forever(background=True)
        return server

    thread = Thread(target=loop.run_forever, daemon=True)
    thread.start()
    server = asyncio.run_coroutine_threadsafe(begin(), loop).result(PATIENCE_S)
    try:
        yield Bench(port)
    finally:
        asyncio.run_coroutine_threadsafe(server.shutdown(), loop).result(PATIENCE_S)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(PATIENCE_S)


SERVERS: dict[str, Callable[[], object]] = {
    "pymodbus": by_pymodbus,
    "pyModbusTCP": by_py_modbus_tcp,
    "modbus_tk": by_modbus_tk,
}


def figures(count: int, seed: int) -> Iterator[Figure]:
    """Conduct ``count`` cases, a third with each server, and yield the figures."""
    source = random.Random(seed)
    ends: Counter[str] = Counter()
    wrong: list[str] = []
    refused_wrongly: list[str] = []
    with ExitStack() as stack:
        benches = [(name, stack.enter_context(server())) for name, server in SERVERS.items()]  # type: ignore[arg-type]
        for number in range(count):
            case = draw(source)
            name, bench = benches[number % len(benches)]
            end = bench.conduct(case)
            ends["carried" if not end else "refused" if end == "refused" else "wrong"] += 1
            if end == "refused" and case.fits:
                refused_wrongly.append(f"{name}: {case}")
            elif (end and end != "refused") or (not end and not case.fits):
                wrong.append(f"{name}: {end or 'carried what does not fit'}: {case}")
    for text in (*wrong[:5], *refused_wrongly[:5]):
        print(f"     {text}")
    yield at_least("values carried", ends["carried"], round(0.8 * count), "", 0)
    yield at_least("values refused", ends["refused"], round(0.05 * count), "", 0)
    yield equal("values that changed silently", len(wrong), 0)
    yield equal("values refused although they fit", len(refused_wrongly), 0)


def main(arguments: list[str] | None = None) -> int:
    """Conduct the cases; return the exit status."""
    description = (__doc__ or "").partition("\n")[2]
    parser = argparse.ArgumentParser("python -m tests.campaigns.registers", description=description)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_CASES} cases instead of {CASES}")
    parser.add_argument("--cases", type=int, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    options = parser.parse_args(arguments)
    missed = 0
    for figure in figures(options.cases or (SAMPLE_CASES if options.sample else CASES), options.seed):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
