"""Silent devices, in words."""

from __future__ import annotations

from drivers.modbus import ModbusLink
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from tester.kinds import load_rig
from tester.machine.modbus_health import FieldDevice
from tester.machine.silence import SPREAD_S, name_of, refusals, silent_lines, unheard
from tests.drivers.modbus_bench import Bench


def drives(*stamps_s: float) -> list[ServoDrive]:
    found = [ServoDrive(config) for config in list(load_rig().drives().values())[: len(stamps_s)]]
    for drive, stamp_s in zip(found, stamps_s, strict=True):
        drive.stamp_s = stamp_s
    return found


def test_a_drive_behind_the_others_is_named_and_a_bus_silent_as_a_whole_is_not() -> None:
    assert unheard(drives(1.0, 1.0, 1.0 - 0.9 * SPREAD_S)) == ""
    assert unheard(drives(1.0, 1.0, 0.9)) == "press drive (node 3) not heard"
    assert unheard(drives(0.5, 0.5, 0.5)) == ""


def two_on_a_line() -> tuple[ModbusLink, list[FieldDevice]]:
    link = Bench().link
    sensors = [Sensor(load_profile("hygrometer_sht20"), unit, link) for unit in (1, 2)]
    return link, [FieldDevice(f"s{i}", f"sensor {i}", "climate", one) for i, one in enumerate(sensors, 1)]


def test_a_line_is_silent_where_one_is_lost_and_no_other_has_answered_since() -> None:
    link, there = two_on_a_line()
    lines = [(Bench().line, link)]
    assert silent_lines(lines, there) == ""
    there[0].driver.station.is_lost = True
    assert silent_lines(lines, there) == ""
    for one in there:
        one.driver.station.misses = 1
    assert silent_lines(lines, there) == "no answer on line climate: sensor 1, sensor 2"


def test_a_line_has_the_name_of_the_rig_file_and_its_devices() -> None:
    link, there = two_on_a_line()
    assert name_of(link, there) == "climate (sensor 1, sensor 2)"
    assert name_of(Bench().link, there) == "unnamed"


def test_all_refusals_are_reported_each_with_its_device() -> None:
    _, there = two_on_a_line()
    wheel, belt = drives(0.0, 0.0)
    belt.refused, there[1].driver.station.refused = "0x6076:00: read 1", "exception 2"
    assert refusals([wheel, belt], [], there) == ["belt drive (node 2): 0x6076:00: read 1", "sensor 2: exception 2"]
