"""A laboratory's sensor, a profile in its own package: polled, recorded, averaged, exported, shown, watched."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import closing
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from sim import machines
from sim.faults.common import SILENCES
from sim.machines.wheel_on_belt.faults.catalogue import CATALOGUE
from sim.nodes.sensor_slave import SensorSlave
from tester.base.screen import Value
from tester.cli.main import invoke
from tester.inputs.rig.further_sensors import quantities_on
from tester.kinds import load_rig, packaged_text
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.run.kind_lookup import served_kind
from tester.run.simulated import spec_of
from tester.service.values import ValueView, unknown_values
from tester.store.run_reader import RunReader
from tester.tui.playback import load
from tests.extension.installing import installed
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

RIG = """
  hygrometer:
    profile: hygrometer
    line: heat
    unit_id: 7
    simulated: {humidity_percent: 45.5, air_c: surface_c}
"""
CHANNELS = ["humidity_percent", "air_c"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's folder: its package is installed, its rig file names the sensor."""
    before, heading, after = packaged_text().partition("\ndevices:")
    (tmp_path / "my-rig.yaml").write_text(before + heading + RIG + after, encoding="utf-8")
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with installed("sensor", tmp_path / "site", monkeypatch):
        yield tmp_path


def simulation(*overrides: str) -> Simulation:
    """Return a run on the laboratory's rig, connected."""
    run = Simulation(config=load_rig("my-rig.yaml", ("sim.noise=0", "sim.scatter=0", *overrides)))
    return run.until(lambda s: s.run.engine.scans > 40)


def shown(run: Simulation) -> dict[str, Value]:
    engine = run.run.engine
    values = ValueView(engine, served_kind(run.ctx.rig).panel(engine)).values()
    return {value.key: value for value in values}


def slave(run: Simulation) -> SensorSlave:
    return run.world.sensors["hygrometer"]


def go_on(run: Simulation, seconds: float) -> None:
    end = run.now + seconds
    run.until(lambda s: s.now > end)


def test_the_runs_table_has_its_channels_behind_those_of_the_machine() -> None:
    rig = load_rig("my-rig.yaml")
    table = quantities_on(rig)
    assert list(table.names[-5:]) == [*CHANNELS, "gate", "burst", "repeat_key"]
    assert [one.name for one in table.averaged][-2:] == CHANNELS
    humidity, air = (table[name] for name in CHANNELS)
    assert (humidity.label, humidity.read_as, humidity.decimals) == ("Humidity", "%", 1)
    assert (air.label, air.read_as) == ("Air", "°C")
    assert quantities_on(load_rig()) is load_rig().quantities


def test_a_run_records_exports_and_replays_them(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "short.yaml", "--rig", "my-rig.yaml", "--yes"]) == 0
    (run,) = (path for path in (folder / "runs").iterdir() if (path / "run.db").exists())
    with closing(RunReader(run)) as reader:
        assert [one.name for one in reader.quantities().further] == CHANNELS
        humidity = np.concatenate([block.columns["humidity_percent"] for block in reader.sample_blocks()])
    assert np.nanmax(abs(humidity - 45.5)) < 0.11 and not np.isnan(humidity[-10:]).any()
    with (run / "conditions.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["measured_humidity_percent"]) == pytest.approx(45.5, abs=0.051)
    surface_c = pytest.approx(float(row["measured_surface_c"]), abs=2.0)  # the thermometer is off
    assert float(row["measured_air_c"]) == surface_c
    capfd.readouterr()
    assert invoke(["export", str(run), "--format", "samples"]) == 0
    header, first, *_ = capfd.readouterr().out.splitlines()
    assert set(CHANNELS) <= set(header.split(",")) and len(first.split(",")) == len(header.split(","))
    assert invoke(["verify", str(run)]) == 0
    replay = load(run)
    assert [spec.label for spec in replay.specs][-2:] == ["Humidity", "Air"]


def test_its_faults_are_those_of_a_script_by_its_key(folder: Path) -> None:
    script = '["t=10 s: hygrometer shows humidity_percent 80 for 5 s", "t=20 s: hygrometer silent for 5 s"]'
    faulty = ["--set", f"sim.faults={script}", "--set", "sim.noise=0"]
    assert invoke(["run", "short.yaml", "--rig", "my-rig.yaml", "--yes", *faulty]) == 0
    (run,) = (path for path in (folder / "runs").iterdir() if (path / "run.db").exists())
    with closing(RunReader(run)) as reader:
        blocks = [block.columns for block in reader.sample_blocks()]
    time_s, humidity = (np.concatenate([block[name] for block in blocks]) for name in ("time_s", "humidity_percent"))

    def during(begin_s: float, end_s: float) -> np.ndarray:
        return humidity[(time_s > begin_s) & (time_s < end_s)]

    assert during(12.5, 15.0) == pytest.approx(80.0, abs=0.11)
    assert during(17.5, 20.0) == pytest.approx(45.5, abs=0.11)
    assert during(24.0, 25.0).size and np.isnan(during(24.0, 25.0)).all()
    assert during(30.0, 40.0) == pytest.approx(45.5, abs=0.11)


def test_a_further_sensor_does_not_replace_a_fault_of_the_machine() -> None:
    rig = load_rig("my-rig.yaml")
    found = machines.find("wheel_on_belt").language(spec_of(rig)).catalogue
    assert {name for name in found if "hygrometer" in name} == {
        f"hygrometer {fault}" for fault in (*SILENCES, "shows humidity_percent", "shows air_c")
    }
    assert all(found[name] is row for name, row in CATALOGUE.items())


def test_its_values_stand_on_the_screen_with_unit_and_range() -> None:
    rig = load_rig("my-rig.yaml")
    unknown = {value.key: value for value in unknown_values(quantities_on(rig), rig)}
    assert (unknown["humidity_percent"].value, unknown["humidity_percent"].quality) == (None, "none")
    value = shown(simulation())["humidity_percent"]
    assert value.value == pytest.approx(45.5) and value.quality == "good"
    assert (value.unit, value.scale_low, value.scale_high) == ("%", 0.0, 100.0)


def test_a_sensor_that_falls_silent_is_stale_on_the_screen_and_missing_in_the_record() -> None:
    run = simulation()
    slave(run).powered = False
    go_on(run, 3.0)
    assert shown(run)["humidity_percent"].quality in ("stale", "bad")
    assert isnan(run.ctx.readings.channels[0])
    go_on(run, 1.0)
    assert isnan(run.ctx.sample[quantities_on(run.ctx.rig).index("humidity_percent")])
    slave(run).powered = True
    go_on(run, 5.0)
    assert shown(run)["humidity_percent"].quality == "good"


def test_a_reading_that_its_status_speaks_against_is_bad_and_missing() -> None:
    run = simulation()
    slave(run).status_bits = 1
    go_on(run, 1.0)
    assert shown(run)["humidity_percent"].quality == "bad"
    assert isnan(run.ctx.readings.channels[0])


def test_a_channel_called_as_one_of_the_machine_is_refused(capfd: pytest.CaptureFixture[str]) -> None:
    taken = "devices.hygrometer.channels={air_c: force_x_n}"
    assert invoke(["check", "short.yaml", "--rig", "my-rig.yaml", "--set", taken]) == 3
    assert "channel force_x_n is one of the machine's own: rename it by `channels`" in capfd.readouterr().err


def test_a_channel_called_as_another_column_of_the_record_is_refused(capfd: pytest.CaptureFixture[str]) -> None:
    taken = "devices.hygrometer.channels={air_c: attempt}"
    rig = ["--rig", "my-rig.yaml", "--set", taken, "--set", "devices.hygrometer.simulated={}"]
    assert invoke(["run", "short.yaml", *rig, "--yes"]) != 0
    assert "channel attempt: a repeat has another column of this name" in capfd.readouterr().err


def test_an_interlock_s_channel_that_no_sensor_measures_is_a_problem_of_the_rig_file(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(RigConfig, "watched", ("humidity_percent", "room_c"))
    assert invoke(["check", "short.yaml", "--rig", "my-rig.yaml"]) == 3
    told = "an interlock looks at the channel room_c, which no further sensor measures"
    assert f"{told} (expected a device or a node with it; there are humidity_percent, air_c)" in capfd.readouterr().err


def test_an_interlock_reads_a_further_channel_by_its_name() -> None:
    run = simulation()
    view, channels = run.run.engine.control.view, run.ctx.readings.channels
    assert view.further(channels, "humidity_percent") == pytest.approx(45.5, abs=0.1)
    assert isnan(view.further(channels, "room_c"))
