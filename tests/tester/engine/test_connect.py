"""Bringing a rig up: in its order, and with a reason where it does not come up."""

from __future__ import annotations

import pytest

from sim.modbus_wire import Impairment
from tester.engine.connect import TIMEOUT_S, Connector, Stage
from tests.tester.engine.bench import Simulation


@pytest.fixture
def simulation() -> Simulation:
    return Simulation()


def connect(simulation: Simulation, at_most_s: float = TIMEOUT_S + 1.0) -> Connector:
    """Tick the connection to its end."""
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


def test_no_drive_has_power_after_connecting(simulation: Simulation) -> None:
    connect(simulation)
    assert simulation.run.engine.devices.all_off()


def test_every_modbus_device_has_reported(simulation: Simulation) -> None:
    devices = connect(simulation).devices
    assert devices.cell.valid and devices.thermometer.valid and devices.jacket.valid


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


def test_nothing_is_sent_before_the_first_tick(simulation: Simulation) -> None:
    assert simulation.world.can.occupied_s == 0.0
