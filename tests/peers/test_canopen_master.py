"""PyPI canopen as the master of our simulated drive: a third-party master must find a CiA 402 drive on the wire.

canopen talks to python-can; the bus below is python-can's interface over the simulated wire. Every frame it sends lets
a few milliseconds of virtual time pass and hands over what the drive sent in them, so nothing waits and no thread runs.
"""

from __future__ import annotations

from collections.abc import Iterator

import can
import canopen
import pytest
from canopen.profiles.p402 import BaseNode402

from drivers.canopen.eds import EDS_PATH
from sim.nodes.cia402_slave import Cia402Slave
from sim.wires.can_wire import CanWire
from tests.sim.drive_bench import NODE, PC, WHEEL, YAW

STEP_S = 0.001
ANSWER_S = 0.003
"""Virtual time after each frame: an SDO exchange takes 0.54 ms of wire and 0.5 ms of the drive."""


class WireBus(can.BusABC):
    """python-can's view of the simulated wire, in virtual time."""

    def __init__(self, wire: CanWire, drive: Cia402Slave) -> None:
        super().__init__(channel="simulated wire")
        self.channel_info = "simulated wire"
        self.wire = wire
        self.drive = drive
        self.now = 0.0
        self.network: canopen.Network | None = None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self.wire.send(msg.arbitration_id, bytes(msg.data), self.now)
        self.run(ANSWER_S)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        return None, False

    def run(self, seconds: float) -> None:
        """Let virtual time pass and hand canopen what arrives."""
        for _ in range(round(seconds / STEP_S)):
            self.drive.advance(self.now, self.now + STEP_S)
            self.now += STEP_S
            for t, can_id, data in self.wire.receive(self.now):
                if self.network is not None:
                    self.network.notify(can_id, bytearray(data), t)


class Master:
    """canopen's network and its 402 node, connected to one simulated drive."""

    def __init__(self, config: object = WHEEL) -> None:
        wire = CanWire()
        self.drive = Cia402Slave(config, wire)  # type: ignore[arg-type]
        self.bus = WireBus(wire, self.drive)
        self.network = canopen.Network(self.bus)
        self.bus.network = self.network
        self.node = BaseNode402(NODE, canopen.import_od(str(EDS_PATH), node_id=NODE))
        self.network.add_node(self.node)
        self.bus.run(0.3)

    def heartbeat(self, seconds: float, every: float = 0.05) -> None:
        for _ in range(round(seconds / every)):
            self.network.send_message(0x700 + PC, b"\x05")
            self.bus.run(every - ANSWER_S)

    def cycle(self) -> None:
        self.network.sync.transmit()
        self.bus.run(0.01)

    def command(self, controlword: int, target: int) -> None:
        self.node.rpdo[1]["controlword"].raw = controlword
        self.node.rpdo[1]["target velocity"].raw = target
        self.node.rpdo[1].transmit()
        self.cycle()


@pytest.fixture
def master() -> Iterator[Master]:
    made = Master()
    yield made
    made.network.disconnect()


@pytest.fixture
def yaw() -> Iterator[Master]:
    made = Master(YAW)
    yield made
    made.network.disconnect()


def test_boot_up_is_noticed(master: Master) -> None:
    assert master.node.nmt.state == "PRE-OPERATIONAL"
    assert master.network.scanner.nodes == [NODE]


def test_identity_is_read(master: Master) -> None:
    sdo = master.node.sdo
    assert sdo[0x1000].raw == 0x00020192
    assert (sdo[0x1018][1].raw, sdo[0x1018][2].raw) == (WHEEL.vendor_id, WHEEL.product_code)


def test_the_name_is_uploaded_in_segments(master: Master) -> None:
    assert "servo" in master.node.sdo[0x1008].raw


def test_every_object_of_the_eds_is_there(master: Master) -> None:
    for entry in master.node.object_dictionary.values():
        members = [entry] if isinstance(entry, canopen.objectdictionary.ODVariable) else list(entry.values())
        for member in members:
            if member.readable:
                value = master.node.sdo.upload(member.index, member.subindex)
                assert not member.fixed_size or len(value) * 8 == len(member)


def test_an_abort_names_its_code(master: Master) -> None:
    with pytest.raises(canopen.SdoAbortedError) as refusal:
        master.node.sdo.upload(0x2FFF, 0)
    assert refusal.value.code == 0x06020000
    with pytest.raises(canopen.SdoAbortedError) as refusal:
        master.node.sdo.download(0x1018, 1, bytes(4))
    assert refusal.value.code == 0x06010002


def test_a_pdo_is_mapped_and_read_back(master: Master) -> None:
    tpdo = master.node.tpdo[1]
    tpdo.read()
    tpdo.clear()
    tpdo.add_variable("statusword")
    tpdo.add_variable("position actual value")
    tpdo.trans_type = 1
    tpdo.enabled = True
    tpdo.save()
    tpdo.clear()
    tpdo.read()
    assert [variable.index for variable in tpdo] == [0x6041, 0x6064]
    master.node.nmt.state = "OPERATIONAL"
    master.cycle()
    assert len(tpdo.data) == 6
    assert tpdo["statusword"].raw & 0x4F == 0x40


def test_the_state_machine_walks_to_operation_enabled(master: Master) -> None:
    node = master.node
    node.op_mode = "PROFILED VELOCITY"
    assert node.op_mode == "PROFILED VELOCITY"
    node.state = "OPERATION ENABLED"
    assert node.state == "OPERATION ENABLED"
    node.state = "SWITCH ON DISABLED"
    assert node.state == "SWITCH ON DISABLED"


def test_an_unsupported_mode_is_not_offered(master: Master) -> None:
    assert not master.node.is_op_mode_supported("PROFILED POSITION")


def ready(master: Master) -> None:
    """Configure by SDO, start, and walk to OPERATION ENABLED by process data."""
    node = master.node
    node.sdo[0x6060].raw = 3
    node.sdo[0x6083].raw = 10_000
    node.sdo[0x6084].raw = 10_000
    node.sdo[0x6085].raw = 40_000
    node.sdo[0x6007].raw = 3
    node.sdo[0x1017].raw = 50
    node.rpdo.read()
    node.tpdo.read()
    node.nmt.state = "OPERATIONAL"
    for controlword in (0x06, 0x07, 0x0F):
        master.command(controlword, 0)


def test_a_target_velocity_is_reached(master: Master) -> None:
    ready(master)
    for _ in range(90):
        master.command(0x0F, 8000)
    status = master.node.tpdo[1]
    assert status["velocity actual value"].raw == 8000
    assert status["statusword"].raw & 0x0427 == 0x0427


def test_the_ramp_is_seen_on_the_wire(master: Master) -> None:
    ready(master)
    seen: list[tuple[float, int]] = []
    for _ in range(50):
        master.command(0x0F, 8000)
        seen.append((master.bus.now, master.node.tpdo[1]["velocity actual value"].raw))
    (t0, v0), (t1, v1) = seen[10], seen[40]
    assert (v1 - v0) / (t1 - t0) == pytest.approx(10_000, rel=0.02)


def test_a_lost_heartbeat_stops_the_drive_and_is_reported(master: Master) -> None:
    ready(master)
    master.node.sdo[0x1016][1].raw = PC << 16 | 200
    for _ in range(20):
        master.command(0x0F, 5000)
        master.heartbeat(0.05)
    assert master.drive.axis.value == 5.0
    assert master.node.emcy.log == []
    master.bus.run(0.6)
    assert [error.code for error in master.node.emcy.active] == [0x8130]
    assert master.node.nmt.state == "PRE-OPERATIONAL"
    assert master.drive.axis.value == 0.0
    assert master.node.sdo[0x1001].raw == 0x11
    master.heartbeat(0.1)
    assert master.node.emcy.active == []


def test_an_emergency_reaches_the_master_and_the_reset_clears_it(master: Master) -> None:
    ready(master)
    master.drive.fault(0x4310)
    master.bus.run(0.1)
    (error,) = master.node.emcy.active
    assert (error.code, error.register) == (0x4310, 0x09)
    assert master.node.state == "FAULT"
    assert master.node.sdo[0x1003][1].raw == 0x4310
    master.command(0x80, 0)
    assert master.node.emcy.active == []
    assert master.node.state == "SWITCH ON DISABLED"


def test_heartbeats_show_the_nmt_state(master: Master) -> None:
    ready(master)
    states: list[int] = []
    master.node.nmt.add_heartbeat_callback(states.append)
    master.bus.run(0.2)
    master.node.nmt.send_command(2)
    master.bus.run(0.2)
    assert states[:3] == [5, 5, 5]
    assert states[-1] == 4


def test_homing_is_understood(yaw: Master) -> None:
    node = yaw.node
    node.sdo[0x6098].raw = 35
    assert node.homing()
    assert yaw.drive.homed


def test_a_position_is_reached_by_the_set_point_handshake(yaw: Master) -> None:
    node = yaw.node
    node.op_mode = "PROFILED POSITION"
    node.sdo[0x6081].raw = 2000
    node.sdo[0x6083].raw = 2000
    node.sdo[0x6084].raw = 2000
    node.state = "OPERATION ENABLED"
    node.sdo[0x607A].raw = 1234
    node.controlword = 0x3F
    yaw.bus.run(0.01)
    assert node.statusword & 0x1000
    node.controlword = 0x0F
    yaw.bus.run(3.0)
    assert node.statusword & 0x1400 == 0x0400
    assert node.sdo[0x6064].raw == 1234
