"""Our CAN master and five simulated drives on one wire: bring-up, motion, watchdog, homing, outputs."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest

from drivers.axis import AxisConfig
from drivers.canopen.master import CanMaster
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.safety_io import CONTACTOR, GUARD, REQUEST, SAFETY_CHAIN
from sim.wires.can_wire import CanWire
from tests.sim.drive_bench import PRESS, WHEEL, YAW

AXES = (
    replace(WHEEL, name="wheel", node_id=1),
    replace(
        WHEEL, name="belt", node_id=2, unit="m/s", velocity_increments=1e6, acceleration=2.0, deceleration=2.0
    ),
    replace(PRESS, name="press", node_id=3),
    replace(YAW, name="sideslip", node_id=4, software_limits=(-30.0, 30.0)),
    replace(YAW, name="camber", node_id=5, software_limits=(-10.0, 10.0)),
)
TICK_S = 0.01


class Bus:
    """Master, drives and nodes, scanned every 10 ms."""

    def __init__(self, axes: tuple[AxisConfig, ...] = AXES) -> None:
        self.wire = CanWire()
        self.nodes = [Cia402Slave(config, self.wire, home_position=3.0) for config in axes]
        self.master = CanMaster()
        self.drives = [ServoDrive(config) for config in axes]
        for drive in self.drives:
            self.master.add(drive)
        self.now = 0.0

    def advance(self, until: float) -> None:
        for node in self.nodes:
            node.advance(self.now, until)
        self.now = until
        self.master.feed(self.wire.receive(until), until)

    def tick(self, count: int = 1) -> None:
        """Scan every 10 ms; between the scans serve the master when it asks for it."""
        for _ in range(count):
            end = self.now + TICK_S
            while self.master.deadline < end - 1e-6:
                self.advance(min(max(self.master.deadline, self.now + 0.0005), end))
                self.master.service(self.wire, self.now)
                if self.now >= end - 1e-6:
                    break
            self.advance(end)
            self.master.scan(self.wire, self.now)

    def converse(self) -> None:
        for _ in range(3000):
            if not any(self.master.busy(drive) for drive in self.drives):
                return
            self.tick()
        raise AssertionError("a conversation does not end")

    def connect(self) -> Bus:
        self.tick(30)
        for drive in self.drives:
            self.master.start(drive, drive.connect())
        self.converse()
        return self

    def enable(self) -> Bus:
        for drive in self.drives:
            drive.goal = Goal.ENABLED
        self.tick(30)
        return self


@pytest.fixture(scope="module")
def connected() -> Bus:
    return Bus().connect()


@pytest.fixture
def bus(connected: Bus) -> Bus:
    """A copy of the connected bus: nothing a test does reaches the next one."""
    return copy.deepcopy(connected)


def test_all_drives_connect(bus: Bus) -> None:
    assert [drive.refused for drive in bus.drives] == [None] * 5
    assert all(drive.online for drive in bus.drives)
    assert not bus.master.foreign_master


def test_all_drives_are_enabled_by_their_goal(bus: Bus) -> None:
    bus.enable()
    assert [drive.state for drive in bus.drives] == [State.OPERATION_ENABLED] * 5


def test_speeds_arrive_in_engineering_units(bus: Bus) -> None:
    bus.enable()
    bus.drives[0].target, bus.drives[1].target = 8.0, 0.6
    bus.tick(120)
    assert (bus.nodes[0].axis.value, bus.nodes[1].axis.value) == (8.0, 0.6)
    assert (bus.drives[0].actual, bus.drives[1].actual) == (8.0, 0.6)


def test_torque_arrives_in_newton_metres(bus: Bus) -> None:
    bus.enable()
    bus.nodes[0].load(-7.5, 0.0)
    bus.tick(2)
    assert bus.drives[0].torque_nm == pytest.approx(-7.5, abs=0.011)


def test_axes_home_and_travel(bus: Bus) -> None:
    for drive in bus.drives[3:]:
        bus.master.start(drive, drive.home())
    bus.converse()
    assert [drive.refused for drive in bus.drives] == [None] * 5
    assert all(drive.homed for drive in bus.drives[3:])
    bus.enable()
    bus.drives[3].target, bus.drives[4].target = 20.0, -5.0
    bus.tick(300)
    assert [node.axis.position for node in bus.nodes[3:]] == [pytest.approx(23.0), pytest.approx(-2.0)]
    assert [drive.actual for drive in bus.drives[3:]] == [20.0, -5.0]
    assert all(drive.reached() for drive in bus.drives[3:])


def test_a_withheld_heartbeat_is_noticed_by_every_drive(bus: Bus) -> None:
    bus.enable()
    bus.drives[0].target = 8.0
    bus.tick(120)
    bus.master.withhold_heartbeat = True
    bus.tick(40)
    assert all(drive.emergency is not None and drive.emergency.code == 0x8130 for drive in bus.drives)
    assert bus.nodes[0].axis.value < 0.001
    bus.master.withhold_heartbeat = False
    bus.tick(20)
    assert all(drive.emergency is None for drive in bus.drives)
    assert bus.nodes[0].axis.value == 0.0


def test_a_dead_drive_is_lost(bus: Bus) -> None:
    bus.nodes[1].power(False)
    bus.tick(20)
    assert [drive.lost for drive in bus.drives] == [False, True, False, False, False]


def test_a_rebooted_drive_is_noticed(bus: Bus) -> None:
    bus.nodes[1].power(False)
    bus.tick(5)
    bus.nodes[1].power(True)
    bus.tick(30)
    assert bus.drives[1].rebooted


def test_a_fault_is_reported_and_reset_once_asked(bus: Bus) -> None:
    bus.enable()
    bus.nodes[0].fault(0x7121)
    bus.tick(5)
    assert bus.drives[0].state is State.FAULT
    bus.tick(50)
    assert bus.drives[0].state is State.FAULT
    bus.drives[0].reset_fault()
    bus.tick(5)
    assert bus.drives[0].state is State.SWITCH_ON_DISABLED


def test_the_contactor_answers_its_request(bus: Bus) -> None:
    press = bus.drives[2]
    assert press.inputs == SAFETY_CHAIN | GUARD
    press.outputs = REQUEST
    bus.tick(10)
    assert press.inputs & CONTACTOR
    bus.nodes[2].set_safety_chain(False)
    bus.tick(10)
    assert press.inputs == GUARD


def test_a_foreign_master_is_noticed(bus: Bus) -> None:
    bus.wire.inject(0x000, b"\x80\x00", bus.now)
    bus.tick(2)
    assert bus.master.foreign_master


def test_five_axes_load_the_bus_as_computed(bus: Bus) -> None:
    bus.enable()
    bus.tick(200)
    assert bus.wire.load == pytest.approx(0.26, abs=0.03)


def test_two_copies_of_a_running_bus_do_the_same(bus: Bus) -> None:
    bus.enable()
    other = copy.deepcopy(bus)
    for one in (bus, other):
        one.drives[0].target = 5.0
        one.tick(50)
    assert [node.axis.value for node in bus.nodes] == [node.axis.value for node in other.nodes]
    assert [drive.tpdo1_data for drive in bus.drives] == [drive.tpdo1_data for drive in other.drives]
    assert bus.nodes[0] is not other.nodes[0]
