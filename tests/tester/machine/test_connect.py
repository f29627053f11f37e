"""Bringing a rig up: in order, and with a reason for every failure."""

from __future__ import annotations

import pytest

from drivers.canopen.objects import MAX_TORQUE
from drivers.cia402 import State
from sim.wires.modbus_wire import Impairment
from tester.kinds.wheel_on_belt.procedures import arming
from tester.machine.connect import TIMEOUT_S, Connector, Stage
from tester.machine.proof import ProofStage
from tester.machine.run import Outcome
from tests.tester.kinds.wheel_on_belt.bench import Simulation


@pytest.fixture
def simulation() -> Simulation:
    return Simulation()


def connect(simulation: Simulation, at_most_s: float = TIMEOUT_S + 1.0) -> Connector:
    """Tick the connection until it ends."""
    connector = simulation.run.connector
    while not connector.finished:
        assert simulation.now < at_most_s
        simulation.world.advance(simulation.now)
        simulation.now = connector.tick(simulation.now)
    return connector


def test_a_rig_in_order_is_ready_within_seconds(simulation: Simulation) -> None:
    assert connect(simulation, 5.0).stage is Stage.READY


def test_every_drive_is_configured_online_and_homed(simulation: Simulation) -> None:
    drives = connect(simulation).devices.drives
    assert len(drives) == 5 and all(drive.online and drive.parameters for drive in drives)
    assert all(drive.homed for drive in drives if drive.config.mode == "position")


def test_the_press_has_its_limit_of_torque_and_reports_it(simulation: Simulation) -> None:
    press = connect(simulation).devices.axes.press
    assert press.parameters[MAX_TORQUE, 0] == press.config.max_torque_per_mille == 230
    assert simulation.world.axes["press"].torque_limit_nm == pytest.approx(0.46)


def test_no_drive_has_power_after_connecting(simulation: Simulation) -> None:
    connect(simulation)
    assert simulation.run.engine.devices.all_off()


def test_every_modbus_device_has_reported(simulation: Simulation) -> None:
    devices = connect(simulation).devices
    assert devices.cell.valid and devices.thermometer.valid and devices.jacket.valid


@pytest.mark.parametrize("stage", [Stage.CONFIGURE, Stage.LIFT, Stage.HOME, Stage.PROVE])
def test_a_bus_that_falls_silent_is_named_as_the_cable_and_no_drive_is(simulation: Simulation, stage: Stage) -> None:
    connector = simulation.run.connector
    while connector.stage is not stage:
        simulation.world.advance(simulation.now)
        simulation.now = connector.tick(simulation.now)
    for axis in simulation.world.axes.values():
        axis.power(False)
    assert connect(simulation).failure.startswith("not armed: CAN silent: CAN cable")


@pytest.mark.parametrize("name", ["wheel", "press", "camber"])
def test_an_absent_node_is_named(simulation: Simulation, name: str) -> None:
    simulation.world.axes[name].power(False)
    connector = connect(simulation)
    assert connector.stage is Stage.FAILED and connector.failure.startswith(f"{name} drive (node ")


@pytest.mark.parametrize(
    "line, unit_id, name",
    [("load_cell", 1, "load cell"), ("heat", 1, "jacket"), ("heat", 2, "thermometer")],
)
def test_a_silent_modbus_device_is_named(simulation: Simulation, line: str, unit_id: int, name: str) -> None:
    simulation.world.lines[line].impair = Impairment("silence", count=-1, unit_id=unit_id)
    connector = connect(simulation)
    assert connector.stage is Stage.FAILED and name in connector.failure


def test_a_second_master_is_refused(simulation: Simulation) -> None:
    simulation.world.advance(0.0)
    simulation.now = simulation.run.connector.tick(0.0)
    simulation.world.can.inject(0x080, b"", 0.005)
    connector = connect(simulation)
    assert connector.stage is Stage.FAILED
    assert connector.failure == "another CANopen master is sending on this bus: SYNC 080#"


def test_a_bus_with_a_second_master_is_left_without_a_word(simulation: Simulation) -> None:
    simulation.world.advance(0.0)
    simulation.now = simulation.run.connector.tick(0.0)
    simulation.world.can.inject(0x080, b"", 0.005)
    simulation.world.advance(0.009)
    before_s = simulation.world.can.occupied_s
    connect(simulation)
    simulation.world.advance(simulation.now)
    assert simulation.world.can.occupied_s == before_s


def test_nothing_is_sent_before_the_first_tick(simulation: Simulation) -> None:
    assert simulation.world.can.occupied_s == 0.0


def creeping(simulation: Simulation) -> Simulation:
    """Tick until the belt creeps in the proof."""
    axis = simulation.world.axes["belt"].axis

    def creeps(_: Simulation) -> bool:
        proof = simulation.run.connector._proof  # pyright: ignore[reportPrivateUsage]
        if not isinstance(proof, arming.Proof) or proof.stage is not ProofStage.MOVE:
            return False
        return proof.bump is arming.Bump.BELT and axis.value > 0.04

    return simulation.until(creeps, TIMEOUT_S)


@pytest.mark.parametrize("line", ["load_cell", "heat"])
def test_a_line_that_is_lost_while_the_belt_creeps_leaves_no_drive_turning_or_with_power(
    simulation: Simulation, line: str
) -> None:
    creeping(simulation).world.lines[line].disconnect()
    simulation.to_the_end(TIMEOUT_S)
    axes = simulation.world.axes
    assert axes["belt"].axis.value == axes["wheel"].axis.value == 0.0
    assert all(axis.state is State.SWITCH_ON_DISABLED for axis in axes.values())


def test_a_drive_that_obeys_nothing_loses_its_power_when_the_connection_is_given_up(simulation: Simulation) -> None:
    creeping(simulation)
    world, drive = simulation.world, simulation.world.axes["belt"]
    world.relay = None  # it would take the torque off a belt that turns beside a wheel at rest
    gone_s, stops = simulation.now + 5.0, False
    while simulation.now < gone_s and not simulation.run.finished:
        stops = stops or drive.state is State.QUICK_STOP_ACTIVE  # by itself, without our heartbeat: it never slows down
        if stops and drive.energised:
            drive.axis.aim(0.3)
        world.advance(simulation.now)
        simulation.now = simulation.run.tick(simulation.now)
    assert simulation.run.outcome is Outcome.UNREACHABLE and not drive.energised


def test_a_line_that_is_lost_while_connecting_makes_the_rig_unreachable(simulation: Simulation) -> None:
    creeping(simulation).world.lines["load_cell"].disconnect()
    simulation.to_the_end(TIMEOUT_S)
    assert simulation.run.outcome is Outcome.UNREACHABLE and simulation.run.reason.startswith("line lost")


def test_a_line_that_is_lost_before_anything_is_sent_ends_at_once(simulation: Simulation) -> None:
    simulation.tick()
    simulation.world.lines["load_cell"].disconnect()
    simulation.to_the_end(0.1)
    assert simulation.run.outcome is Outcome.UNREACHABLE and simulation.world.can.occupied_s == 0.0


def test_an_adapter_that_goes_after_the_line_ends_at_once(simulation: Simulation) -> None:
    creeping(simulation).world.lines["load_cell"].disconnect()
    simulation.tick()
    assert not simulation.run.finished
    simulation.world.can.disconnect()
    simulation.to_the_end(simulation.now + 0.1)
    assert simulation.run.outcome is Outcome.UNREACHABLE and simulation.run.reason.startswith("line lost")
