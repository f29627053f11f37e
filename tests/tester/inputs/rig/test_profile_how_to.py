"""The page "How to write a profile" is followed word by word: its sensor is polled, recorded and watched on a rig."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import isnan
from pathlib import Path

import pytest

from drivers.sensor import Sensor
from sim.nodes.sensor_slave import SensorSlave
from tester.base.source import InvalidSource
from tester.inputs.rig.further_sensors import FurtherChannel, further_channels
from tester.kinds import load_rig, load_rig_text, packaged_text
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.run.provenance import calibration_of
from tester.run.simulated import simulated_ports
from tester.service.buses import BusWatch
from tests.tester.kinds.wheel_on_belt.bench import Simulation

PAGE = Path(__file__).parents[4] / "docs" / "how-to" / "a-profile-for-your-load-cell.md"
FILE = re.compile(r"<!-- file (?P<name>\S+) -->\n```toml\n(?P<text>.*?)```", re.DOTALL)
PART = re.compile(r"<!-- part of the rig file -->\n```yaml\ndevices:\n(?P<text>.*?)```", re.DOTALL)
SECOND = "devices.second={profile: torque.toml, line: load_cell, unit_id: 9, channels: {torque_nm: second_nm}}"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder for following the page."""
    page = PAGE.read_text(encoding="utf-8")
    profile, part = FILE.search(page), PART.search(page)
    assert profile is not None and part is not None
    (tmp_path / profile["name"]).write_text(profile["text"], encoding="utf-8")
    before, heading, after = packaged_text().partition("\ndevices:\n")
    (tmp_path / "my-rig.yaml").write_text(before + heading + part["text"] + after, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def simulation(*overrides: str) -> Simulation:
    """Return a run on the page's rig."""
    config = load_rig("my-rig.yaml", ("sim.noise=0", "sim.scatter=0", *overrides))
    return Simulation(config=config)


def connected(run: Simulation) -> Simulation:
    """Continue to the first scans of the run."""
    run.until(lambda s: s.run.engine.scans > 40)
    return run


def sensor_of(run: Simulation, number: int = 0) -> tuple[Sensor, SensorSlave]:
    slave = list(run.world.sensors.values())[number]
    return run.run.engine.devices.sensors[number], slave


def test_the_rig_file_with_the_sensor_reads_back_as_the_same() -> None:
    rig = load_rig("my-rig.yaml")
    assert load_rig_text(rig.text) == rig
    assert further_channels(rig) == (FurtherChannel("torque_nm", "N m", "devices.torque", -50.0, 50.0, 3),)


def test_its_channel_is_in_the_process_image_and_follows_the_plant() -> None:
    run = connected(simulation())
    (torque_nm,) = run.ctx.readings.channels
    assert torque_nm == pytest.approx(run.world.plant.drive_torque_nm, abs=0.05)
    assert not isnan(torque_nm)


def test_its_parameter_is_written_when_it_is_connected() -> None:
    sensor, slave = sensor_of(connected(simulation()))
    assert slave.get(20) == 200 and sensor.ready


def test_a_second_one_of_the_same_make_has_channels_of_its_own_on_another_line() -> None:
    run = connected(simulation(SECOND, "devices.second.simulated={torque_nm: 12.5}"))
    assert [channel.name for channel in further_channels(run.ctx.rig)] == ["torque_nm", "second_nm"]
    assert run.ctx.readings.channels[1] == pytest.approx(12.5, abs=0.001)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda slave: setattr(slave, "powered", False),
        lambda slave: setattr(slave, "status_bits", 1),
    ],
    ids=["silent", "invalid"],
)
def test_a_sensor_that_cannot_be_believed_reads_as_missing(spoil: Callable[[SensorSlave], None]) -> None:
    run = connected(simulation())
    spoil(sensor_of(run)[1])
    end = run.now + 2.0
    run.until(lambda s: s.now > end)
    assert isnan(run.ctx.readings.channels[0])


def test_a_run_does_not_begin_before_it_has_answered() -> None:
    run = simulation()
    sensor_of(run)[1].powered = False
    run.to_the_end(100.0)
    assert run.run.connector.failure == "not up after 90 s: torque"


def test_another_device_at_its_address_is_refused_by_name() -> None:
    run = simulation()
    sensor_of(run)[1].put(10, b"\x00\x07")
    run.to_the_end(100.0)
    assert run.run.connector.failure.startswith("torque: device type: register holds 7, expected 50")


def test_it_is_on_the_list_of_devices_and_in_the_record() -> None:
    run = connected(simulation())
    rig = run.ctx.rig
    views = {view.name: view for view in BusWatch(run.run.engine.devices, rig).device_views(run.now)}
    assert (views["torque"].bus, views["torque"].state) == ("heat", "ready")
    recorded = [(one.quantity, one.value, one.unit) for one in calibration_of(rig) if one.device == "torque"]
    assert recorded == [
        ("profile", str(Path("torque.toml").resolve()), ""),
        ("scale of torque_nm", "0.001", "N m"),
        ("filter_hz", "20.0", "Hz"),
    ]


def problems(*overrides: str) -> str:
    with pytest.raises(InvalidSource) as found:
        load_rig("my-rig.yaml", overrides)
    return "\n".join(map(str, found.value.problems))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("devices.torque.filter_hz=60", "60 is beyond Torque transducer TQ-50 (expected 0.5 to 50)"),
        ("devices.torque.fitler_hz=20", 'unknown key "fitler_hz", did you mean filter_hz?'),
        ("devices.torque.unit_id=2", "2 on line heat is"),
        ("devices.torque.profile=simulated_jacket", "a profile of kind jacket (expected sensor)"),
        ("devices.torque.channels={nm: x}", "no such channel (the profile has torque_nm)"),
        ("devices.torque.channels={torque_nm: Torque}", "expected small letters"),
        ("devices.second={profile: torque.toml, line: heat, unit_id: 8}", "channel torque_nm is one of torque already"),
        ("devices.load_cell.simulated={fx: 1}", "are for further sensors"),
    ],
)
def test_a_mistake_in_the_rig_file_is_reported(override: str, message: str) -> None:
    assert message in problems(override)


def test_a_quantity_that_the_plant_lacks_is_reported() -> None:
    rig: RigConfig = load_rig("my-rig.yaml", ["devices.torque.simulated={torque_nm: torque}"])
    with pytest.raises(InvalidSource, match='no quantity "torque"'):
        simulated_ports(rig, 0, None)
