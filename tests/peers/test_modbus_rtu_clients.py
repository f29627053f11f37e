"""Our Modbus slaves with third-party clients: minimalmodbus and pymodbus, on a pseudo-terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from threading import Thread

import pytest

from drivers.crc16 import crc16
from drivers.profiles import load_profile
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave
from tests.drivers.modbus_rig import Quantities

if sys.platform == "win32":
    pytest.skip("this system has no pseudo-terminals", allow_module_level=True)

import os
import tty
from select import select

import minimalmodbus
from pymodbus.client import ModbusSerialClient
from serial import Serial

PATIENCE_S = 10.0
"""Time a client waits for an answer: bounds every test."""


class Terminal:
    """A pseudo-terminal with slaves at its far end, served by a thread."""

    def __init__(self, *slaves: ModbusSlave) -> None:
        self.slaves = slaves
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.name = os.ttyname(self._slave)
        self._wake_read, self._wake_write = os.pipe()
        self._thread = Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        buffer = b""
        t = 0.0
        while True:
            ready, _, _ = select([self.master, self._wake_read], [], [])
            if self._wake_read in ready:
                return
            buffer += os.read(self.master, 300)
            if len(buffer) < 8 or crc16(buffer) != 0:
                continue
            t += 0.01
            for slave in self.slaves:
                reply = slave.answer(buffer, t)
                if reply is not None:
                    os.write(self.master, reply)
            buffer = b""

    def close(self) -> None:
        os.write(self._wake_write, b"x")
        self._thread.join(PATIENCE_S)
        for descriptor in (self.master, self._slave, self._wake_read, self._wake_write):
            os.close(descriptor)


@pytest.fixture
def connect() -> Iterator[Callable[..., Terminal]]:
    """Yield a function that puts slaves on a pseudo-terminal."""
    opened: list[Terminal] = []

    def make(*slaves: ModbusSlave) -> Terminal:
        opened.append(Terminal(*slaves))
        return opened[-1]

    yield make
    for terminal in opened:
        terminal.close()


def instrument(terminal: Terminal, unit_id: int) -> minimalmodbus.Instrument:
    """Return minimalmodbus's view of a slave."""
    port = Serial(terminal.name, 115200, timeout=PATIENCE_S)
    return minimalmodbus.Instrument(port, unit_id)


def test_minimalmodbus_reads_forces(connect: Callable[..., Terminal]) -> None:
    terminal = connect(CellSlave(load_profile("four_axis_transmitter"), 1, Quantities()))
    device = instrument(terminal, 1)
    assert device.read_long(2, signed=True) == pytest.approx(-400, abs=1)
    assert len(device.read_registers(0, 9)) == 9


def test_minimalmodbus_writes_the_emissivity_and_reads_it_back(connect: Callable[..., Terminal]) -> None:
    slave = IrSlave(load_profile("calex_pyrominibus"), 2, Quantities())
    device = instrument(connect(slave), 2)
    device.write_register(0x17, 0.95, 4)
    device.write_register(0x17, 9300, functioncode=6)
    assert device.read_register(0x17, 4) == pytest.approx(0.93)
    assert device.read_register(0x0E, 1, functioncode=4, signed=True) == pytest.approx(40.0, abs=0.11)


def test_minimalmodbus_understands_the_exceptions(connect: Callable[..., Terminal]) -> None:
    device = instrument(connect(ControllerSlave(load_profile("simulated_jacket"), 1, Quantities())), 1)
    device.serial.timeout = 0.5  # it waits for a reply of full length, which a refusal is not
    with pytest.raises(minimalmodbus.IllegalRequestError):
        device.read_register(3000)
    with pytest.raises(minimalmodbus.IllegalRequestError):
        device.write_register(199, 7, functioncode=6)


def test_minimalmodbus_gets_no_reply_from_an_absent_address(connect: Callable[..., Terminal]) -> None:
    terminal = connect(CellSlave(load_profile("four_axis_transmitter"), 1, Quantities()))
    device = instrument(terminal, 9)
    device.serial.timeout = 0.1
    with pytest.raises(minimalmodbus.NoResponseError):
        device.read_register(0)


def test_pymodbus_commands_and_reads_the_controller(connect: Callable[..., Terminal]) -> None:
    slave = ControllerSlave(load_profile("simulated_jacket"), 1, Quantities())
    terminal = connect(slave)
    with ModbusSerialClient(terminal.name, baudrate=115200, timeout=PATIENCE_S, retries=0) as client:
        assert not client.write_register(26, 800, device_id=1).isError()
        assert not client.write_registers(199, [0], device_id=1).isError()
        assert client.read_holding_registers(5, count=1, device_id=1).registers == [800]
        assert client.read_input_registers(199, count=1, device_id=1).registers == [0]
        assert client.read_holding_registers(3000, count=1, device_id=1).exception_code == 2
    assert slave.running
