"""Device parameters: dumped, read back, compared, kept with a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivers.canopen import objects as o
from tester.doctor.device_parameters import DumpError, ParameterDump, dumped, read_dump
from tester.doctor.examination import Examination
from tester.doctor.open_wires import SimulatedWires
from tester.kinds import load_rig
from tester.run.set_up import DeviceParameter, differences, stored
from tester.store.journal_records import StoredParameter
from tests.tester.doctor.fake_computer import FakeComputer

RIG = load_rig("sim")


def dump(wires: SimulatedWires | None = None) -> ParameterDump:
    return dumped(Examination(RIG, FakeComputer(), wires or SimulatedWires(RIG), everybody=False))


def test_a_dump_has_every_device_with_its_identity() -> None:
    found = dump()
    assert set(found.devices) == {*RIG.drives(), "load cell", "jacket", "infrared thermometer"}
    assert found.devices["belt"]["0x1018:04"] == DeviceParameter("2", "serial number", written=False)
    assert found.devices["belt"]["0x100A:00"].value == "1.0.0"
    assert found.devices["load cell"]["0x0064"].value == str(0x4658)


def test_a_dump_separates_parameters_of_every_connect_from_permanent_ones() -> None:
    belt = dump().devices["belt"]
    assert belt["0x6083:00"].written
    assert not belt["0x6076:00"].written


def test_a_device_that_does_not_answer_is_named() -> None:
    wires = SimulatedWires(RIG)
    wires.world.axes["belt"].power(False)
    wires.world.devices["jacket"].power(False)
    assert dump(wires).silent == ("belt", "jacket")


def test_a_dump_reads_back_as_it_was(tmp_path: Path) -> None:
    found = dump()
    path = tmp_path / "dump.json"
    path.write_text(found.text, encoding="utf-8")
    assert read_dump(path) == found


@pytest.mark.parametrize("text", ["", "{}", '{"format": 9}', "[]", '{"format": 1, "devices": 3}'])
def test_a_file_that_is_no_dump_is_refused_by_its_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DumpError, match=r"other\.json"):
        read_dump(path)


def test_a_changed_parameter_is_reported_by_its_name_with_both_values() -> None:
    before = dump()
    wires = SimulatedWires(RIG)
    wires.world.axes["press"].store.values[o.RATED_TORQUE, 0] = 1500
    (found,) = differences(before.devices, dump(wires).devices)
    assert str(found) == "press 0x6076:00 (motor rated torque (mN m)): was 2000, is 1500"
    assert not found.written


def test_parameters_of_every_connect_are_marked() -> None:
    before = dump()
    wires = SimulatedWires(RIG)
    wires.world.axes["press"].store.values[o.PROFILE_ACCELERATION, 0] = 17
    (found,) = differences(before.devices, dump(wires).devices)
    assert found.written


def test_a_parameter_that_is_gone_is_a_difference() -> None:
    before = {"belt": {"0x607E:00": DeviceParameter("64", "polarity")}}
    (found,) = differences(before, {"belt": {}})
    assert str(found) == "belt 0x607E:00 (polarity): was 64, is missing"


def test_of_a_record_the_last_value_counts_and_commands_are_left_out() -> None:
    rows = [
        StoredParameter(1.0, "belt", "0x6076:00", "", "1"),
        StoredParameter(2.0, "belt", "0x6076:00", "rated torque", "2"),
        StoredParameter(1.0, "belt", "0x6040:00", "", "0"),
        StoredParameter(1.0, "jacket", "profile", "", "eurotherm_3200"),
    ]
    found = stored(RIG, rows)
    assert found["belt"] == {"0x6076:00": DeviceParameter("2", "rated torque", written=False)}
    assert found["jacket"]["profile"].value == "eurotherm_3200"
