"""One Modbus transaction on a pseudo-terminal: raw bytes, our driver, pymodbus' and minimalmodbus' clients.

The far end is a process of its own that answers from memory, and both are pinned to one core, so that a transaction is
the work of both, without waking another core. A round trip is the median of many, in elapsed time; this process's own
CPU time is listed beside it. Our driver's time runs faster than the clock, so that the silence between two frames costs
nothing; the libraries really wait for it, so their CPU time is compared.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from statistics import median
from typing import Any

from bench.child import ROOT
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most, ratio, unavailable
from bench.modbus_far_end import PROFILE, READY, UNIT_ID
from bench.stopwatch import cpu_ns, wall_ns
from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.transports.serial_line import open_serial_line

LIMIT = 3.0
"""Limit of a transaction through our driver relative to the raw one."""
BAUD = 115200
REGISTERS = 9
REPLY_BYTES = 5 + 2 * REGISTERS
STEP_S = 0.006
REPLY_S = 0.002
"""Driver's time between two transactions, and from request to reply, s."""
PATIENCE_S = 5.0

Transact = Callable[[], None]
Open = Callable[[str], tuple[Transact, Callable[[], None]]]


def measure(effort: Effort) -> list[Figure]:
    """Return round trips and own CPU time of the four ways, and their ratios."""
    if sys.platform == "win32":
        return [unavailable("transaction", "us", "this system has no pseudo-terminals")]
    ways: dict[str, tuple[Open, int]] = {
        "raw write/read": (_raw, effort.pick(5000, 500)),
        "our driver": (_ours, effort.pick(5000, 500)),
        "pymodbus": (_pymodbus, effort.pick(300, 50)),
        "minimalmodbus": (_minimalmodbus, effort.pick(300, 50)),
    }
    trips: dict[str, list[float]] = {name: [] for name in ways}
    costs: dict[str, list[float]] = {name: [] for name in ways}
    absent: set[str] = set()
    with one_core() as pinned, far_end() as terminal:
        for _ in range(effort.runs):
            for name, (opening, count) in ways.items():
                if name in absent:
                    continue
                try:
                    transact, close = opening(terminal)
                except ImportError:
                    absent.add(name)
                    continue
                trip_us, cpu_us = _timed(transact, count)
                close()
                trips[name].append(trip_us)
                costs[name].append(cpu_us)
    return _figures(trips, costs, absent, pinned)


def _figures(
    trips: dict[str, list[float]], costs: dict[str, list[float]], absent: set[str], pinned: bool
) -> list[Figure]:
    raw, ours = "raw write/read", "our driver"
    note = "both ends on one core" if pinned else "not pinned: not available here"
    figures: list[Figure] = []
    for name in trips:
        if name in absent:
            figures.append(unavailable(f"{name}: round trip", "us", f"{name} is not installed"))
            continue
        figures.append(Figure(f"{name}: round trip", "us", tuple(trips[name]), note=note))
        figures.append(Figure(f"{name}: own CPU", "us CPU", tuple(costs[name])))
    figures.append(ratio(f"{ours} / {raw}: round trip", trips[ours], trips[raw], at_most(LIMIT)))
    figures.append(ratio(f"{ours} / {raw}: own CPU", costs[ours], costs[raw]))
    for name in ("pymodbus", "minimalmodbus"):
        if name not in absent:
            figures.append(ratio(f"{ours} / {name}: own CPU", costs[ours], costs[name]))
    return figures


def _timed(transact: Transact, count: int) -> tuple[float, float]:
    """Return the median round trip and the CPU time of one transaction, us."""
    for _ in range(10):
        transact()
    spans: list[int] = []
    used = cpu_ns()
    for _ in range(count):
        begun = wall_ns()
        transact()
        spans.append(wall_ns() - begun)
    return median(spans) * 1e-3, (cpu_ns() - used) * 1e-3 / count


# The line ------------------------------------------------------------------------------------------------------


@contextmanager
def one_core() -> Generator[bool, None, None]:
    """Keep this process and its children on one core if the system allows it; yield whether it does."""
    if sys.platform != "linux":
        yield False
        return
    before = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {max(before)})
        yield True
    finally:
        os.sched_setaffinity(0, before)


@contextmanager
def far_end() -> Generator[str, None, None]:
    """Start the far end of a pseudo-terminal; yield the name of the near one."""
    import tty

    master, near = os.openpty()
    tty.setraw(near)
    process = subprocess.Popen(
        [sys.executable, "-m", "bench.modbus_far_end", str(master)], pass_fds=(master,), cwd=ROOT
    )
    try:
        if os.read(near, 1) != READY:
            raise TopicFailedError("the far end of the line says something else")
        yield os.ttyname(near)
    finally:
        process.kill()
        process.wait()
        os.close(near)
        os.close(master)


# Four ways to ask ----------------------------------------------------------------------------------------------


def _raw(terminal: str) -> tuple[Transact, Callable[[], None]]:
    """Send our driver's request bytes, and read as many bytes as the answer has."""
    port = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
    request = with_crc(bytes((UNIT_ID, 3, 0, 0, 0, REGISTERS)))

    def transact() -> None:
        os.write(port, request)
        missing = REPLY_BYTES
        while missing > 0:
            missing -= len(os.read(port, 256))

    return transact, lambda: os.close(port)


def _ours(terminal: str) -> tuple[Transact, Callable[[], None]]:
    """Ask through link, load cell and serial port; waits for the answer with ``select``."""
    from select import select

    line = open_serial_line(terminal, BAUD)
    link = ModbusLink("rtu", BAUD)
    cell = Sensor(load_profile(PROFILE), UNIT_ID, link)
    descriptor = os.open(terminal, os.O_RDWR | os.O_NOCTTY)  # to wait on
    cell.period_s = 0.0
    waiting = [descriptor]
    now = 0.0

    def transact() -> None:
        nonlocal now
        stamp = cell.stamp_s
        while cell.stamp_s == stamp:  # once; more often while it is identified, or for a reply in pieces
            now += STEP_S
            link.service(line, now)
            if not select(waiting, (), (), PATIENCE_S)[0]:
                raise TopicFailedError(f"the load cell does not answer our driver: {cell.refused}")
            chunks = line.read(now + REPLY_S)
            if chunks:
                link.feed(chunks, now + REPLY_S)

    def close() -> None:
        os.close(descriptor)
        line.close()

    return transact, close


def _pymodbus(terminal: str) -> tuple[Transact, Callable[[], None]]:
    """Ask with pymodbus' blocking client."""
    client: Any = importlib.import_module("pymodbus.client").ModbusSerialClient(
        terminal, baudrate=BAUD, timeout=PATIENCE_S, retries=0
    )
    if not client.connect():
        raise TopicFailedError("pymodbus cannot open the terminal")

    def transact() -> None:
        if len(client.read_holding_registers(0, count=REGISTERS, device_id=UNIT_ID).registers) != REGISTERS:
            raise TopicFailedError("pymodbus reads something else")

    return transact, client.close


def _minimalmodbus(terminal: str) -> tuple[Transact, Callable[[], None]]:
    """Ask with minimalmodbus."""
    minimalmodbus: Any = importlib.import_module("minimalmodbus")
    serial: Any = importlib.import_module("serial").Serial(terminal, BAUD, timeout=PATIENCE_S)
    instrument = minimalmodbus.Instrument(serial, UNIT_ID)

    def transact() -> None:
        if len(instrument.read_registers(0, REGISTERS)) != REGISTERS:
            raise TopicFailedError("minimalmodbus reads something else")

    def close() -> None:
        with suppress(OSError):
            serial.close()

    return transact, close
