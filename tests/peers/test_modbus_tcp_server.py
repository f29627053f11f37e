"""Our Modbus drivers with a third-party server: pyModbusTCP, through the TCP edge."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from pyModbusTCP.server import ModbusServer

from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from drivers.transports.tcp_line import open_tcp_line
from tests.peers.exchange import PATIENCE_S, Exchange


@pytest.fixture(scope="module")
def server() -> Iterator[ModbusServer]:
    """Run a server on a port of the kernel's choice."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    made = ModbusServer("127.0.0.1", port, no_block=True)
    made.start()
    yield made
    made.stop()


@pytest.fixture
def exchange(server: ModbusServer) -> Iterator[Exchange]:
    """Connect our link."""
    line = open_tcp_line("127.0.0.1", server.port, PATIENCE_S)
    yield Exchange(line)
    line.close()


def test_the_load_cell_reads_its_block(server: ModbusServer, exchange: Exchange) -> None:
    server.data_bank.set_holding_registers(100, [0x4658])
    server.data_bank.set_holding_registers(0, [0, 2000, 0xFFFF, 0xFE70, 0, 4000, 0, 500, 0])
    cell = Sensor(load_profile("four_axis_transmitter"), 1, exchange.link)
    exchange.until(lambda: cell.valid)
    assert cell.raw == pytest.approx((100.0, -20.0, 200.0, 0.5))


def test_the_thermometer_sets_its_emissivity_and_reads(server: ModbusServer, exchange: Exchange) -> None:
    server.data_bank.set_holding_registers(0, [17])
    server.data_bank.set_holding_registers(0x0E, [412, 411, 250, 0])
    thermometer = Sensor(load_profile("calex_pyrominibus"), 1, exchange.link, parameters={"emissivity": 0.93})
    exchange.until(lambda: thermometer.valid)
    assert thermometer.values[0] == pytest.approx(41.2)
    assert server.data_bank.get_holding_registers(0x17) == [9300]


def test_the_jacket_is_set_up_commanded_and_read(server: ModbusServer, exchange: Exchange) -> None:
    server.data_bank.set_holding_registers(1, [853, 0, 0, 425, 900])
    jacket = TemperatureController("jacket", load_profile("simulated_jacket"), 1, exchange.link)
    jacket.enable(True)
    jacket.set_setpoint(90.0)
    exchange.until(lambda: jacket.valid and server.data_bank.get_holding_registers(199) == [0])
    assert (jacket.measured_c, jacket.output_percent) == pytest.approx((85.3, 42.5))
    assert server.data_bank.get_holding_registers(26) == [900]
    assert server.data_bank.get_holding_registers(276) == [1]
    assert server.data_bank.get_holding_registers(5000) == [20]


def test_the_servers_exception_latches_as_a_wrong_configuration(server: ModbusServer, exchange: Exchange) -> None:
    server.data_bank.set_holding_registers(100, [0x4658])
    cell = Sensor(load_profile("four_axis_transmitter"), 1, exchange.link)
    request = exchange.link.read(cell.station, 3, 0xFFFF, 2)
    exchange.link.enable(request)
    exchange.until(lambda: cell.refused is not None)
    assert cell.station.counters.exceptions == {2: 1}
