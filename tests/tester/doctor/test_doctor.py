"""The whole check, on the simulated rig in virtual time."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from drivers.canopen import objects as o
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.doctor.examination import Examination
from tester.doctor.finding import Severity
from tester.doctor.open_wires import SimulatedWires
from tester.doctor.probe_table import PROBES, examined
from tester.kinds import load_rig
from tests.campaigns.mistakes.by_doctor import MISTAKES, clean
from tests.campaigns.mistakes.mistake import Mistake
from tests.campaigns.mistakes.written import Case, Written, exits
from tests.tester.doctor.fake_computer import FakeComputer

WATCHED_S = 1.0


def look(wires: SimulatedWires, rig_name: str = "sim", *, everybody: bool = False) -> list[str]:
    examination = Examination(
        load_rig(rig_name), FakeComputer(), wires, Path("runs"), WATCHED_S, everybody=everybody
    )  # fmt: skip
    return [str(entry.finding) for entry in examined(examination)]


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_a_rig_that_matches_its_file_has_no_findings(seed: int) -> None:
    assert clean(seed) == []


@pytest.mark.parametrize("mistake", MISTAKES[1::4], ids=lambda mistake: mistake.name)
def test_a_mistake_is_named(mistake: Mistake) -> None:
    assert any(re.search(mistake.named_by, line) for line in mistake.find(3))
    assert mistake.disagrees(3) == ""


def test_every_bad_finding_has_a_remedy() -> None:
    keys = ("lines.heat.baud=9600", "axes.belt.node_id=12")
    found = Case(Written("several", "", machine=keys, computer={"free_bytes": 0, "missing": True}), 0).findings()
    bad = [finding for finding in found if finding.severity >= Severity.WARNING]
    assert len(bad) >= 4
    assert all(finding.todo for finding in bad)


def test_the_look_writes_nothing_to_any_device_and_sends_no_command() -> None:
    wires = SimulatedWires(load_rig("sim"))
    sent: list[tuple[int, bytes]] = []
    asked: list[bytes] = []
    wires.world.can.watch(lambda _t, can_id, data, from_pc: sent.append((can_id, data)) if from_pc else None)
    for line in wires.world.lines.values():
        line.watch(lambda _t, data, from_pc: asked.append(data) if from_pc else None)
    look(wires, everybody=True)
    uploads = {0x40, 0x60, 0x70, 0x80}  # initiate, segments, abort of a transfer that was not answered
    assert {can_id & 0x780 for can_id, _ in sent} == {o.SDO_REQUEST_BASE}
    assert {data[0] for _, data in sent} <= uploads
    assert {data[1] for data in asked} <= {3, 4}


def test_the_look_moves_nothing_and_enables_no_drive() -> None:
    wires = SimulatedWires(load_rig("sim"))
    look(wires)
    assert isinstance(wires.world, WheelRig)
    assert all(drive.axis.still and not drive.energised for drive in wires.world.axes.values())


def test_another_kind_of_rig_is_also_checked() -> None:
    rig = load_rig("grosch")
    wires = SimulatedWires(rig)
    lines = look(wires, "grosch")
    assert not [line for line in lines if line.startswith("fault")]
    assert any("CAN bus" in line for line in lines)
    assert any(line.split()[1] == "chamber:" and "(the rig file allows 2500 ms)" in line for line in lines)


def test_slow_checks_are_announced_once() -> None:
    wires = SimulatedWires(load_rig("sim"))
    told: list[str] = []
    examination = Examination(
        load_rig("sim"), FakeComputer(), wires, seconds=WATCHED_S, everybody=False, say=told.append
    )  # fmt: skip
    list(examined(examination))
    list(examined(examination))
    assert len(told) == 2 + len(examination.rig.lines)


def test_all_set_up_objects_missing_from_a_profile_are_reported_at_once() -> None:
    wires = SimulatedWires(load_rig("sim"))
    examination = Examination(load_rig("sim"), FakeComputer(), wires, seconds=WATCHED_S, everybody=False)
    objects = {node: dict(answers) for node, answers in examination.can.objects.items()}
    for key in ((o.HALT_OPTION, 0), (o.MAX_TORQUE, 0)):
        objects[1][key] = replace(objects[1][key], data=b"", error="no such object", code=0x0602_0000)
    examination.can.objects = objects
    (line,) = [str(one.finding) for one in examined(examination) if "does not have" in one.finding.found]
    assert "0x605D" in line
    assert "0x6072" in line


def test_the_probes_stand_in_the_table_once() -> None:
    probes = [probe for _, probe in PROBES]
    assert len(set(probes)) == len(probes)


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        ("load cell offset 150 N", "without tare, unloaded it is 20 N at most"),
        ("thermometer offset 40 K", "hub cold at"),
        ("hub sensor noisy 8 K", "hub sensor jump"),
        ("guard opened", "not armed: guard open"),
    ],
)
def test_a_refusal_by_a_run_is_a_fault_in_the_runs_own_words(fault: str, why: str) -> None:
    case = Case(Written(fault, "", faults=(fault,)), 2)
    found = case.findings()
    (run,) = [finding for finding in found if finding.subject == "run"]
    assert why in run.found
    assert exits(found) == 1
    assert case.run() != ""


def test_a_press_that_is_down_is_lifted_by_a_run_before_the_cell_counts() -> None:
    case = Case(Written("down", ""), 2)
    assert isinstance(case.wires.world, WheelRig)
    case.wires.world.axes["press"].axis.position = 10.5
    assert exits(case.findings()) == 0


def test_the_makers_profile_is_named_and_no_value_in_another_makers_unit() -> None:
    beyond = {"axes.wheel.profile": "maxon_epos4", "axes.wheel.vendor_id": 0xFB, "axes.wheel.speed_zero": 0.0}
    found = Case(Written("maxon", "", rig=("axes.wheel.vendor_id=0",), beyond=beyond), 0).findings()
    about = [finding for finding in found if finding.subject == "wheel"]
    assert any("the maker's profile is maxon_epos4" in finding.found for finding in about)
    assert not any("correct axes.wheel.rated_torque" in finding.todo for finding in about)


def test_a_silent_rig_is_not_watched() -> None:
    drives = [f"{name} drive without supply" for name in ("wheel", "belt", "press", "sideslip", "camber")]
    devices = [f"{name} without supply" for name in ("load cell", "thermometer", "jacket")]
    case = Case(Written("dark", "", faults=(*drives, *devices)), 0)
    case.findings()
    assert case.wires.now() < 60.0
