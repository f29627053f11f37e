"""The simulated rig behind sockets: real loopback connections, a clock set by hand."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from sim.rig import SimRig
from sim.servers.server import RigServer
from sim.servers.tcp_doors import MOST_CLIENTS, GatewayDoor
from tester.kinds import load_rig
from tester.run.simulated import simulated_ports
from tests.sim.servers.addresses import can_address, line_addresses

HEARTBEAT = b"< send 77F 1 5 >"
READ_CELL = bytes.fromhex("0001 0000 0006 01 03 0000 0001")


class Bench:
    """A server whose clock is at ``t`` (s) and advances only on command."""

    def __init__(self, server: RigServer, rig: WheelRig) -> None:
        self.server, self.rig = server, rig
        self.t = 0.0

    def run(self, seconds: float, each: Callable[[float], None] | None = None) -> None:
        """Turn the loop for some seconds of rig time, in steps of 1 ms; ``each`` is called before every turn."""
        end = self.t + seconds
        while self.t < end:
            self.t += 0.001
            if each is not None:
                each(self.t)
            self.server.turn(self.now)

    def now(self) -> float:
        """Return the time."""
        return self.t


@pytest.fixture
def bench() -> Iterator[Bench]:
    _, rig, hands = simulated_ports(load_rig("sim", ("sim.noise=0",)), 1, None)
    hands.install(0, 0, "1#", new_specimen=True)
    assert isinstance(rig, WheelRig)
    server = RigServer(rig, "127.0.0.1", 0)
    yield Bench(server, rig)
    server.close()


@pytest.fixture
def connect() -> Iterator[Callable[[tuple[str, int]], socket.socket]]:
    with ExitStack() as stack:

        def to(address: tuple[str, int]) -> socket.socket:
            client = stack.enter_context(socket.create_connection(address, 2.0))
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return client

        yield to


Connect = Callable[[tuple[str, int]], socket.socket]


class Client:
    """A program on the CAN bus, past its handshake."""

    def __init__(self, bench: Bench, connection: socket.socket) -> None:
        self.bench, self.socket = bench, connection
        self.text = b""
        bench.run(0.002)
        self.send(b"< open vcan0 >< rawmode >")
        bench.run(0.1)
        self.look()

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def look(self) -> bytes:
        """Return the frames since the last call."""
        self.socket.setblocking(False)
        found = b""
        try:
            while data := self.socket.recv(65536):
                found += data
        except BlockingIOError:
            pass
        self.socket.setblocking(True)
        self.text += found
        return found

    def write(self, node: int, index: int, sub: int, value: int, length: int) -> None:
        """Write an object of a node by SDO."""
        command = {1: 0x2F, 2: 0x2B, 4: 0x23}[length]
        data = bytes((command, index & 0xFF, index >> 8, sub)) + value.to_bytes(4, "little")
        self.send(f"< send {0x600 + node:03X} 8 {data.hex(' ')} >".encode())
        self.bench.run(0.01)
        assert f"< frame {0x580 + node:03X}".encode() in self.look()


def test_a_client_is_greeted_and_receives_the_nodes_boot_up(bench: Bench, connect: Connect) -> None:
    client = Client(bench, connect(can_address(bench.server)))
    bench.run(0.4)
    assert client.text.startswith(b"< hi >< ok >< ok >")
    heard = client.look()
    assert all(f"< frame 70{node} 0.2".encode() in heard for node in range(1, 6))


def test_an_answer_leaves_when_its_time_on_the_wire_is_over(bench: Bench, connect: Connect) -> None:
    client = Client(bench, connect(can_address(bench.server)))
    bench.run(0.3)
    client.look()
    began = bench.t
    client.send(b"< send 601 8 40 0 10 0 0 0 0 0 >")
    bench.run(0.004)
    [answer] = client.look().split(b"<")[1:]
    arrival = float(answer.split()[2])
    # request and answer of 8 bytes take 270 us each at 500 kbit/s, the drive 500 us between them
    assert arrival - began == pytest.approx(0.001 + 2 * 0.00027 + 0.0005, abs=2e-4)


def test_a_second_client_is_turned_away_with_a_reason(bench: Bench, connect: Connect) -> None:
    Client(bench, connect(can_address(bench.server)))
    second = connect(can_address(bench.server))
    bench.run(0.003)
    assert b"another program" in second.recv(100)
    assert second.recv(100) == b""


def test_a_client_may_come_after_another_has_gone(bench: Bench, connect: Connect) -> None:
    first = Client(bench, connect(can_address(bench.server)))
    first.socket.close()
    second = connect(can_address(bench.server))
    bench.run(0.005)
    assert second.recv(6) == b"< hi >"


def test_a_drive_that_watched_a_client_stops_when_it_is_gone(bench: Bench, connect: Connect) -> None:
    bench.rig.relay = None  # it would take the torque off a wheel that turns beside a belt at rest
    client = Client(bench, connect(can_address(bench.server)))
    bench.run(0.3)
    client.send(HEARTBEAT)
    client.write(1, 0x1016, 1, 127 << 16 | 200, 4)
    client.write(1, 0x6007, 0, 3, 2)
    client.write(1, 0x6060, 0, 3, 1)
    for index in (0x6083, 0x6085):
        client.write(1, index, 0, 42_440, 4)  # 44.44 rad/s2
    client.write(1, 0x60FF, 0, 5000, 4)
    client.send(b"< send 000 2 1 1 >")

    def beat(t: float) -> None:
        if round(1000 * t) % 50 == 0:
            client.send(HEARTBEAT)

    for word in (0x06, 0x07, 0x0F):
        client.send(HEARTBEAT)
        client.write(1, 0x6040, 0, word, 2)
    bench.run(1.0, beat)
    wheel = bench.rig.axes["wheel"]
    assert wheel.axis.value == pytest.approx(5000 / 954.93, rel=1e-3)
    client.socket.close()
    bench.run(0.2 + 5.24 / 44.44 + 0.05)
    assert wheel.axis.value == pytest.approx(0.0, abs=1e-6)
    assert wheel.emergencies.present


def test_a_modbus_client_reads_the_load_cell(bench: Bench, connect: Connect) -> None:
    client = connect(line_addresses(bench.server)["load_cell"])
    client.sendall(READ_CELL)
    bench.run(0.02)
    reply = client.recv(100)
    assert reply[:8] == bytes.fromhex("0001 0000 0005 01 03")


def test_a_modbus_client_that_talks_something_else_is_shut_out(bench: Bench, connect: Connect) -> None:
    client = connect(line_addresses(bench.server)["heat"])
    client.sendall(b"GET / HTTP/1.1\r\n\r\n")
    bench.run(0.005)
    assert client.recv(100) == b""


def test_more_modbus_clients_than_a_line_has_places_for_are_shut_out(bench: Bench, connect: Connect) -> None:
    address = line_addresses(bench.server)["heat"]
    clients = [connect(address) for _ in range(MOST_CLIENTS + 1)]
    bench.run(0.05)
    door = bench.server.lines["heat"]
    assert isinstance(door, GatewayDoor)
    assert len(door.clients) == MOST_CLIENTS
    assert clients[-1].recv(100) == b""


def test_the_observer_sees_the_rig_every_step(connect: Connect) -> None:
    class Seen:
        times: tuple[float, ...] = ()

        def observe(self, rig: SimRig, controlled: bool) -> None:
            assert not controlled
            self.times += (rig.now_s,)

    _, rig, _ = simulated_ports(load_rig("sim"), 1, None)
    assert isinstance(rig, WheelRig)
    seen = Seen()
    server = RigServer(rig, "127.0.0.1", 0, seen)
    Bench(server, rig).run(0.1)
    server.close()
    assert len(seen.times) == pytest.approx(10, abs=1)


def test_ports_that_are_taken_are_refused_and_none_stays_open() -> None:
    _, rig, _ = simulated_ports(load_rig("sim"), 1, None)
    assert isinstance(rig, WheelRig)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(OSError, match="in use"):
            RigServer(rig, "127.0.0.1", port)


def test_a_machine_whose_own_computer_was_late_reports_it_before_its_drives_miss_anything(
    bench: Bench, connect: Callable[[tuple[str, int]], socket.socket]
) -> None:
    client = connect(can_address(bench.server))
    client.sendall(b"< open can0 >< rawmode >")
    bench.run(0.1)
    codes: list[int] = []
    bench.rig.can.watch(
        lambda _t, can_id, data, from_pc: codes.append(int.from_bytes(data[:2], "little"))
        if can_id & 0x780 == 0x080 and len(data) == 8 and not from_pc
        else None
    )
    bench.t += 1.0
    bench.run(0.01)
    assert codes[0] == 0xFF4C
    assert bench.server.starved_s == [pytest.approx(1.0, abs=0.02)]


def test_a_lateness_is_reported_but_not_as_a_fault_of_the_drive(
    bench: Bench, connect: Callable[[tuple[str, int]], socket.socket]
) -> None:
    client = connect(can_address(bench.server))
    client.sendall(b"< open can0 >< rawmode >")
    bench.run(0.1)
    reports: list[bytes] = []
    bench.rig.can.watch(lambda _t, can_id, data, _from_pc: reports.append(data) if can_id & 0x780 == 0x080 else None)
    bench.t += 0.04
    bench.run(0.01)
    emergencies = [data for data in reports if len(data) == 8]
    assert emergencies[0][2:3] == b"\0" and emergencies[0][5:] == b"sim"
    assert bench.server.starved_s == []


def test_a_late_machine_that_no_program_uses_reports_nothing(bench: Bench) -> None:
    bench.run(0.1)
    bench.t += 1.0
    bench.run(0.01)
    assert bench.server.starved_s == []
