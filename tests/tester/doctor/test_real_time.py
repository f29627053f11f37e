"""The whole check in real time, over sockets, on a rig in its own thread; and a mistake on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from sim.wires.can_traffic import Beat
from tester.doctor.examination import Examination
from tester.doctor.finding import Severity
from tester.doctor.open_wires import HardwareWires
from tester.doctor.probe_table import examined
from tests.tester.doctor.fake_computer import FakeComputer
from tests.tester.run.test_rig_wires import Machine

pytestmark = pytest.mark.campaign
"""Some 30 s of wall time: python -m pytest -m campaign -n 0 tests/tester/doctor/test_real_time.py."""

WATCHED_S = 3.0
OF_THE_COMPUTER = ("scan",)
"""Punctuality of the test's computer, and its consequences, are not judged here."""


@pytest.fixture
def machine() -> Iterator[Machine]:
    machine = Machine()
    yield machine
    machine.off()


def bad(machine: Machine, **changes: object) -> list[str]:
    """Return the warnings and faults that are found over the sockets; ``changes``: of the rig file."""
    rig = replace(machine.config, **changes)
    wires = HardwareWires(rig)
    try:
        examination = Examination(rig, FakeComputer(), wires, Path("runs"), WATCHED_S, everybody=False)
        findings = [entry.finding for entry in examined(examination)]
    finally:
        wires.close()
    return [str(one) for one in findings if one.severity >= Severity.WARNING and one.subject not in OF_THE_COMPUTER]


def test_a_rig_behind_sockets_that_matches_its_file_has_no_fault(machine: Machine) -> None:
    assert [line for line in bad(machine) if line.startswith("fault")] == []


def test_a_second_master_is_detected_over_the_socket(machine: Machine) -> None:
    machine.server.rig.can.beat(Beat(0x080, b"", 0.05), 0.0)
    assert any("another master is sending: SYNC" in line for line in bad(machine))


def test_a_device_at_another_unit_id_is_missed(machine: Machine) -> None:
    devices = dict(machine.config.devices)
    devices["jacket"] = replace(devices["jacket"], unit_id=9)
    assert any(
        line.startswith("fault   jacket: nothing answers at unit id 9") for line in bad(machine, devices=devices)
    )
