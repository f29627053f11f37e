"""The simulated nodes on a bus of python-can: its virtual one, within this process."""

from __future__ import annotations

from collections.abc import Iterator

import can
import pytest

from sim.servers.adapter_door import AdapterDoor
from sim.servers.doors import Doors
from sim.servers.server import RigServer
from tester.kinds import load_rig
from tester.run.simulated import simulated_ports


@pytest.fixture
def bus() -> Iterator[can.BusABC]:
    with can.Bus(interface="virtual", channel="adapter door") as bus:
        yield bus


@pytest.fixture
def server() -> Iterator[RigServer]:
    _, rig, _ = simulated_ports(load_rig("sim"), 1, None)
    server = RigServer(rig, "", 0, doors=Doors("virtual:adapter door"))
    yield server
    server.close()


def turn(server: RigServer, from_s: float, to_s: float) -> None:
    for ms in range(round(1000 * from_s), round(1000 * to_s)):
        server.turn(lambda at=ms: at / 1000.0)


def heard(bus: can.BusABC) -> set[int]:
    return {message.arbitration_id for message in iter(lambda: bus.recv(0.0), None)}


def test_nodes_boot_and_answer_on_the_interface(server: RigServer, bus: can.BusABC) -> None:
    turn(server, 0.0, 0.4)
    assert heard(bus) >= {0x700 + node for node in range(1, 6)}
    assert not server.can.taken
    bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
    turn(server, 0.4, 0.42)
    assert 0x581 in heard(bus)
    assert server.can.taken
    turn(server, 0.42, 1.1)
    assert not server.can.taken, "nobody has sent for half a second"


@pytest.mark.parametrize("special", [{"is_extended_id": True}, {"is_remote_frame": True, "is_extended_id": False}])
def test_frames_that_the_simulated_bus_does_not_carry_are_counted(
    server: RigServer, bus: can.BusABC, special: dict[str, bool]
) -> None:
    bus.send(can.Message(arbitration_id=0x601, **special))
    turn(server, 0.0, 0.01)
    assert isinstance(server.can, AdapterDoor)
    assert server.can.ignored == 1


def test_an_interface_that_is_not_there_is_named() -> None:
    _, rig, _ = simulated_ports(load_rig("sim"), 1, None)
    with pytest.raises(OSError, match="nosuch can7"):
        RigServer(rig, "", 0, doors=Doors("nosuch:can7"))
