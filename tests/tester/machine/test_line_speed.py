"""A line too slow for the ages that the rig file allows is refused at connect, with a remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.doctor.examination import Examination
from tester.doctor.finding import Severity
from tester.doctor.open_wires import SimulatedWires
from tester.doctor.probe_table import examined
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.machine import line_speed
from tester.machine.connect import Connector, Stage
from tester.machine.devices import DeviceList
from tester.run.simulated import simulated_ports
from tests.tester.doctor.fake_computer import FakeComputer


def connected(held: str) -> tuple[Connector, DeviceList]:
    """Connect to the simulated rig until its devices answer, or the connection fails."""
    rig = load_rig("sim", (f"sim.latency_timer={held}",))
    ports, world, _ = simulated_ports(rig, 0, None)
    devices = Devices(rig, ports)
    connector = Connector(devices, rig, WheelArming(devices, rig), rig.arming.listen_s)
    now = 0.0
    while connector.stage in (Stage.LISTEN, Stage.CONFIGURE, Stage.HEAR):
        world.advance(now)
        now = connector.tick(now)
    return connector, devices


def test_a_line_with_the_usual_latency_timer_is_measured_and_taken() -> None:
    connector, devices = connected("16 ms")
    assert (connector.stage, connector.failure) == (Stage.LIFT, "")
    reply = next(one.driver.station.reply for one in devices.modbus if one.name == "load_cell")
    assert reply.least_s == pytest.approx(0.017, abs=1e-4)
    assert reply.measured
    assert "load cell 17.0 to 17.0 ms" in line_speed.described(devices)


def test_time_outs_may_follow_replies_as_far_as_the_age_allows() -> None:
    _, devices = connected("0 ms")
    longest = {one.name: one.driver.station.longest_s for one in devices.modbus}
    assert longest["load_cell"] == pytest.approx(0.025)


def test_a_line_too_slow_is_refused_with_the_key_and_the_remedy() -> None:
    connector, _ = connected("40 ms")
    assert connector.failed
    assert "load cell: line load_cell is too slow for interlocks.stale_cell, 50.0 ms" in connector.failure
    assert "sim.latency_timer" in connector.failure


@pytest.mark.parametrize("held", ["0 ms", "16 ms", "20 ms", "22 ms", "24 ms", "30 ms", "40 ms"])
def test_the_doctor_finds_a_fault_exactly_where_a_run_refuses_the_line(held: str) -> None:
    connector, _ = connected(held)
    rig = load_rig("sim", (f"sim.latency_timer={held}",))
    examination = Examination(rig, FakeComputer(), SimulatedWires(rig), Path("runs"), 5.0)
    faults = [str(entry.finding) for entry in examined(examination) if entry.finding.severity is Severity.FAULT]
    assert any("a run refuses the line" in fault for fault in faults) == connector.failed
