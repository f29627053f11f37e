"""A measuring CANopen node in the rig file: connected, received, recorded under the master of the drives."""

from __future__ import annotations

from math import isnan

import pytest

from tester.base.source import InvalidSource
from tester.inputs.rig.further_sensors import further_channels
from tester.kinds import load_rig, load_rig_text
from tester.service.buses import BusWatch
from tests.tester.kinds.wheel_on_belt.bench import QUIET, Simulation

NODE = (
    "can.nodes.climate={node_id: 20, vendor_id: 7, channels: {humidity_percent:"
    " {byte: 0, type: u16, scale: 0.1, unit: '%', simulated: 45.5},"
    " air_c: {byte: 2, type: i16, scale: 0.01, unit: degC, simulated: -3.25}}}"
)


def simulation() -> Simulation:
    return Simulation(overrides=(*QUIET, NODE))


@pytest.fixture
def running() -> Simulation:
    return simulation().until(lambda s: s.run.engine.scans > 20)


def test_the_rig_file_with_the_node_reads_back_as_the_same() -> None:
    rig = load_rig("sim", [NODE])
    assert load_rig_text(rig.text) == rig
    assert [(one.name, one.unit) for one in further_channels(rig)] == [("humidity_percent", "%"), ("air_c", "degC")]


def test_its_channels_are_in_the_process_image(running: Simulation) -> None:
    assert running.ctx.readings.channels == pytest.approx([45.5, -3.25])


def test_it_is_on_the_list_of_devices(running: Simulation) -> None:
    views = {one.name: one for one in BusWatch(running.run.engine.devices, running.ctx.rig).device_views(running.now)}
    assert (views["climate"].address, views["climate"].state, views["climate"].online) == (20, "operational", True)


def test_a_node_that_falls_silent_reads_as_missing_and_leaves_the_drives_alone(running: Simulation) -> None:
    running.world.nodes[0].power(False)
    end = running.now + 2.0
    running.until(lambda s: s.now > end)
    assert all(isnan(value) for value in running.ctx.readings.channels)
    assert running.run.engine.devices.nodes[0].lost and running.ctx.readings.drive_fault == ""


def test_a_run_does_not_begin_without_it() -> None:
    run = simulation()
    run.world.nodes[0].power(False)
    run.to_the_end(100.0)
    assert "climate (node 20)" in run.run.connector.failure


def test_another_device_under_its_node_id_is_refused() -> None:
    run = simulation()
    run.world.nodes[0].store.readers[0x1018, 1] = lambda: 8
    run.to_the_end(100.0)
    assert "read 0x00000008, the configuration has 0x00000007: another device" in run.run.connector.failure


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("can.nodes.climate.node_id=3", "node 3 is press already"),
        ("can.nodes.climate.node_id=127", "node 127 is the PC already"),
        ("can.nodes.climate.channels.air_c.byte=7", "i16 does not fit into the 8 bytes"),
        ("can.nodes.climate.channels.Air={byte: 4, type: u8, scale: 1, unit: ''}", "expected small letters"),
        ("can.nodes.climate.period=0.1 ms", "loads the CAN bus"),
    ],
)
def test_a_mistake_in_the_rig_file_is_reported(override: str, message: str) -> None:
    with pytest.raises(InvalidSource) as found:
        load_rig("sim", [NODE, override])
    assert message in "\n".join(map(str, found.value.problems))
