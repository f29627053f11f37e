"""The simulated rig's doors with third-party programs: python-can, pyModbusTCP, pymodbus."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event, Thread

import can
import canopen
import pytest
from can.interfaces.socketcand import SocketCanDaemonBus
from pymodbus.client import ModbusTcpClient
from pyModbusTCP.client import ModbusClient

from sim.machines.wheel_on_belt.rig import WheelRig
from sim.servers.server import RigServer
from tester.base import clock
from tester.kinds import load_rig
from tester.run.simulated import simulated_ports
from tests.sim.servers.addresses import can_address, line_addresses

CELL_REGISTERS = 9
HUB, SURFACE = 1, 0x0E


@pytest.fixture
def server() -> Iterator[RigServer]:
    """Let a rig live in a thread until the test is over."""
    _, rig, _ = simulated_ports(load_rig("sim", ("sim.noise=0",)), 1, None)
    assert isinstance(rig, WheelRig)
    server = RigServer(rig, "127.0.0.1", 0)
    stop, origin = Event(), clock.monotonic()
    thread = Thread(target=server.serve, args=(lambda: clock.monotonic() - origin, stop.is_set))
    thread.start()
    yield server
    stop.set()
    thread.join()
    server.close()


@pytest.fixture
def bus(server: RigServer) -> Iterator[can.BusABC]:
    host, port = can_address(server)
    with SocketCanDaemonBus("vcan0", host, port) as bus:
        yield bus


def answer(bus: can.BusABC, can_id: int, frames: int = 200) -> can.Message:
    """Return the next frame with an identifier."""
    for _ in range(frames):
        message = bus.recv(2.0)
        assert message is not None, f"no frame {can_id:03X}"
        if message.arbitration_id == can_id:
            return message
    raise AssertionError(f"no frame {can_id:03X} among {frames}")


def test_python_can_reads_an_object_of_a_drive(bus: can.BusABC) -> None:
    answer(bus, 0x701)  # it has booted
    bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
    reply = answer(bus, 0x581)
    assert bytes(reply.data) == bytes.fromhex("4300100092010200")
    assert not reply.is_extended_id


def test_python_can_gets_heartbeats_with_the_rigs_time(bus: can.BusABC) -> None:
    answer(bus, 0x702)
    bus.send(can.Message(arbitration_id=0x602, data=bytes.fromhex("2B17100014000000"), is_extended_id=False))
    answer(bus, 0x582)
    first, second = answer(bus, 0x702), answer(bus, 0x702)
    assert second.timestamp - first.timestamp == pytest.approx(0.02, abs=1e-3)


def test_python_can_sends_a_sync_without_data(bus: can.BusABC) -> None:
    answer(bus, 0x703)
    bus.send(can.Message(arbitration_id=0x000, data=b"\x01\x03", is_extended_id=False))
    bus.send(can.Message(arbitration_id=0x080, data=b"", is_extended_id=False))
    bus.send(can.Message(arbitration_id=0x603, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
    assert bytes(answer(bus, 0x583).data)[:4] == b"\x43\x00\x10\x00"  # the server has not lost its place


def test_a_second_python_can_is_turned_away(server: RigServer, bus: can.BusABC) -> None:
    host, port = can_address(server)
    with pytest.raises(can.CanError, match="another program"):
        SocketCanDaemonBus("vcan0", host, port)


def test_canopen_talks_to_every_drive(server: RigServer) -> None:
    host, port = can_address(server)
    network = canopen.Network()
    network.connect(interface="socketcand", channel="vcan0", host=host, port=port)
    try:
        identities = []
        for number in range(1, 6):
            node = network.add_node(number, canopen.ObjectDictionary())
            node.nmt.wait_for_bootup(2.0) if number == 1 else None
            identities.append(int.from_bytes(node.sdo.upload(0x1018, 2), "little"))
        assert identities == [0x0402] * 5
    finally:
        network.disconnect()


def test_pymodbustcp_reads_the_load_cell(server: RigServer) -> None:
    host, port = line_addresses(server)["load_cell"]
    client = ModbusClient(host, port, unit_id=1, timeout=2.0)
    registers = client.read_holding_registers(0, CELL_REGISTERS)
    client.close()
    assert registers is not None and len(registers) == CELL_REGISTERS


def test_pymodbus_reads_jacket_and_thermometer_on_one_line(server: RigServer) -> None:
    host, port = line_addresses(server)["heat"]
    with ModbusTcpClient(host, port=port, timeout=2.0) as client:
        hub = client.read_holding_registers(HUB, count=1, device_id=1)
        surface = client.read_holding_registers(SURFACE, count=1, device_id=2)
    assert (hub.registers[0] / 10, surface.registers[0] / 10) == pytest.approx((23.0, 23.0), abs=0.3)


def test_pymodbus_writes_a_setpoint_and_reads_it_back(server: RigServer) -> None:
    host, port = line_addresses(server)["heat"]
    with ModbusTcpClient(host, port=port, timeout=2.0) as client:
        assert not client.write_register(26, 900, device_id=1).isError()
        assert client.read_holding_registers(26, count=1, device_id=1).registers == [900]
        assert client.read_holding_registers(0x4000, count=1, device_id=1).exception_code == 2
