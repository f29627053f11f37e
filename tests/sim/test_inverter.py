"""Our CAN master and a simulated frequency inverter: frames in velocity mode, both ways."""

from __future__ import annotations

import math
import struct
from dataclasses import replace
from pathlib import Path

import pytest

from drivers.cia402 import Goal, State
from drivers.drives.reader import read_drive_profile
from drivers.profiles.model import ProfileError
from tests.sim.drive_bench import DISABLED, ENABLED, WHEEL, DriveBench, SdoRefusedError
from tests.sim.test_master_meets_drives import Bus

GEAR = 10.0
COUNTS = 30.0 / math.pi * GEAR
"""r/min of the motor per rad/s of the shaft."""
INVERTER = replace(WHEEL, profile="cia402_inverter", gear=GEAR, velocity_increments=COUNTS)


@pytest.fixture
def bus() -> Bus:
    return Bus((INVERTER,)).connect()


def test_an_inverter_connects_in_velocity_mode_with_its_ramps_read_back(bus: Bus) -> None:
    drive = bus.drives[0]
    assert (drive.refused, drive.online) == (None, True)
    read = drive.parameters
    assert (read[0x6061, 0], read[0x604C, 1], read[0x604C, 2]) == (2, 1, 1)
    assert [read[index, sub] for index in (0x6048, 0x6049, 0x604A) for sub in (1, 2)] == [955, 1, 955, 1, 3820, 1]
    assert (read[0x6046, 1], read[0x6046, 2]) == (0, 2865)
    assert [read[0x1600, sub] for sub in (0, 1, 2)] == [2, 0x60400010, 0x60420010]
    assert [read[0x1A00, sub] for sub in (0, 1, 2, 3)] == [3, 0x60410010, 0x60440010, 0x60770010]


def test_it_turns_at_whole_r_min_of_its_motor(bus: Bus) -> None:
    drive, node = bus.enable().drives[0], bus.nodes[0]
    drive.target = 8.0
    bus.tick(120)
    assert drive.emit(True) == struct.pack("<Hh", 0x007F, 764)
    assert node.axis.value == drive.actual == 764 / COUNTS


def test_it_ramps_by_its_own_objects_and_reports_no_bit_12(bus: Bus) -> None:
    drive = bus.enable().drives[0]
    drive.target = 20.0
    bus.tick(100)
    assert drive.actual == pytest.approx(10.0, abs=0.3)
    drive.goal = Goal.QUICK_STOP
    bus.tick(60)
    assert (drive.actual, drive.state, drive.statusword & 0x3000) == (0.0, State.SWITCH_ON_DISABLED, 0)


def test_the_torque_of_its_shaft_arrives(bus: Bus) -> None:
    bus.enable().nodes[0].load(5.0, 0.0)
    bus.tick(3)
    assert bus.drives[0].torque_nm == 5.0


def test_without_our_heartbeat_it_stops_by_itself(bus: Bus) -> None:
    drive = bus.enable().drives[0]
    drive.target = 8.0
    bus.tick(120)
    bus.master.withhold_heartbeat = True
    bus.tick(60)
    assert (bus.nodes[0].axis.value, drive.state) == (0.0, State.SWITCH_ON_DISABLED)


def running(bits: int, bench: DriveBench | None = None) -> DriveBench:
    bench = bench or DriveBench(INVERTER).boot()
    if bench.drive.mode_display != 2:
        bench.write(0x6060, 0, 2, 1)
        for word in (0x06, 0x07, 0x0F):
            bench.write(0x6040, 0, word, 2)
    bench.write(0x6042, 0, 764, 2)
    bench.write(0x6040, 0, 0x0F | bits, 2)
    bench.run(2.0)
    return bench


@pytest.mark.parametrize("bits", [0x00, 0x10, 0x20, 0x30, 0x40, 0x50, 0x60])
def test_no_speed_begins_without_all_three_bits_of_the_ramp(bits: int) -> None:
    bench = running(bits)
    assert (bench.drive.statusword & 0x6F, bench.drive.axis.value) == (ENABLED, 0.0)


def test_a_locked_ramp_holds_its_speed_and_the_others_end_it() -> None:
    bench = running(0x70)
    bench.write(0x6040, 0, 0x5F, 2)
    bench.write(0x6042, 0, 300, 2)
    bench.run(2.0)
    assert bench.read(0x6044, 0) == 764
    bench.write(0x6040, 0, 0x7F, 2)
    bench.run(2.0)
    assert bench.read(0x6044, 0) == 300
    assert running(0x30, bench).drive.axis.value == 0.0


def test_the_greatest_speed_is_that_of_0x6046() -> None:
    bench = DriveBench(INVERTER).boot()
    bench.write(0x6046, 2, 500, 4)
    assert running(0x70, bench).read(0x6044, 0) == 500


@pytest.mark.parametrize("index", [0x60FF, 0x606C, 0x6083, 0x607A, 0x6064])
def test_it_has_no_object_of_another_mode(index: int) -> None:
    with pytest.raises(SdoRefusedError, match="0x06020000"):
        DriveBench(INVERTER).boot().read(index, 0)


def test_it_refuses_another_mode_and_a_ramp_of_no_time() -> None:
    bench = DriveBench(INVERTER).boot()
    for index, sub, value, size in ((0x6060, 0, 3, 1), (0x6048, 2, 0, 2), (0x604A, 1, 0, 4)):
        with pytest.raises(SdoRefusedError):
            bench.write(index, sub, value, size)
    assert bench.drive.statusword & 0x4F == DISABLED


def written(folder: Path, text: str) -> str:
    """Write a profile of velocity mode; return its path."""
    path = folder / "inverter.toml"
    path.write_text(f'title = "Inverter"\nchecked = "here"\nvelocity_mode = "vl"\n{text}\n', encoding="utf-8")
    return str(path)


def without(folder: Path, *missing: str) -> str:
    """Write a profile that lacks objects; return its path."""
    return written(folder, f"[objects]\nmissing = {list(missing)}")


def test_without_a_torque_there_are_two_fields_and_no_number(tmp_path: Path) -> None:
    bus = Bus((replace(INVERTER, profile=without(tmp_path, "6077", "6076")),)).connect().enable()
    drive = bus.drives[0]
    drive.target = 8.0
    bus.tick(120)
    assert (drive.refused, len(drive.tpdo1_data)) == (None, 4)
    assert drive.actual == 764 / COUNTS
    assert math.isnan(drive.torque_nm)
    assert "no 0x6077:00 (torque actual value (per mille of rated)): the drive does not report its torque" in (
        drive.plan.without
    )


@pytest.mark.parametrize("index", ["6048", "6049", "604A", "6042", "6044", "6007", "605A", "605E"])
def test_an_inverter_without_its_essential_objects_is_refused_by_name(tmp_path: Path, index: str) -> None:
    drive = Bus((replace(INVERTER, profile=without(tmp_path, index)),)).connect().drives[0]
    assert f"0x{index}:0" in (drive.refused or "")


def test_a_unit_of_a_tenth_is_written_as_the_dimension_factor(tmp_path: Path) -> None:
    tenths = written(tmp_path, "[units]\ntarget_rpm = 0.1")
    read = Bus((replace(INVERTER, profile=tenths, velocity_increments=10.0 * COUNTS),)).connect().drives[0].parameters
    assert (read[0x604C, 1], read[0x604C, 2]) == (1, 10)


def test_whether_there_is_a_torque_is_not_asked_for_at_connect() -> None:
    text = 'title = "Inverter"\nchecked = "here"\nvelocity_mode = "vl"\n[objects]\noptional = ["6077"]\n'
    with pytest.raises(ProfileError, match="whether these drives lack it"):
        read_drive_profile("inverter", text)
