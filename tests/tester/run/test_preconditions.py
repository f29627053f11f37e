"""Records of a real rig required before a run begins."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from drivers.canopen.dictionary import VENDOR_ID
from tester import kinds
from tester.base import clock
from tester.inputs.rig import Rig
from tester.inputs.rig.rig_keys import value_at
from tester.kinds import load_rig, load_rig_text, packaged_text
from tester.machine.commission.commission_step import sections_sha256
from tester.machine.commission.record import DONE, CommissionRecord, record_path
from tester.run.endings import CannotStartError
from tester.run.preconditions import not_measured, unmeasured
from tester.run.session_options import SessionOptions

JOGS = ("jog wheel", "jog belt", "jog press", "jog sideslip", "jog camber")


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """Return the file of a real rig."""
    text = packaged_text().replace("simulated: true", "simulated: false").replace("interface: sim ", "interface: pcan ")
    for port in range(text.count("port: sim")):
        text = text.replace("port: sim", f"port: /dev/ttyUSB{port}", 1)
    path = tmp_path / "rig.yaml"
    path.write_text(text.replace(f"0x{VENDOR_ID:08X}", "0x00000123"), encoding="utf-8")
    return path


def commission(rig: Rig, runs: Path) -> None:
    part: Any = kinds.find(rig.kind).commissions
    record = CommissionRecord(record_path(runs, rig.name), clock.utc_now, "me")
    for step in part().steps:
        record.add(rig.name, "", sections_sha256(rig, step.sections), step.name, DONE, "within 1 %")


def test_a_simulated_rig_needs_no_commissioning(tmp_path: Path) -> None:
    assert unmeasured(load_rig(), tmp_path) == ""


def test_a_real_rig_needs_the_jog_of_every_drive(machine: Path, tmp_path: Path) -> None:
    rig: Any = load_rig(machine)
    missing = unmeasured(rig, tmp_path)
    assert all(f"{step}: to be done" in missing for step in JOGS) and "tester commission" in missing
    by_hand = replace(rig, axes=replace(rig.axes, camber=None))
    assert "jog camber" not in unmeasured(by_hand, tmp_path)
    commission(rig, tmp_path)
    assert unmeasured(rig, tmp_path) == ""


def test_a_scale_that_is_not_the_measured_one_is_named_by_its_step(machine: Path, tmp_path: Path) -> None:
    commission(load_rig(machine), tmp_path)
    before, after = "velocity_increments: 1000       # 0x60FF", "velocity_increments: 100000     # 0x60FF"
    text = machine.read_text(encoding="utf-8")
    assert text.count(before) == 1
    missing = unmeasured(load_rig_text(text.replace(before, after)), tmp_path)
    assert "jog press: to be done again (the rig file has changed under it" in missing and "jog belt" not in missing


def test_a_run_on_a_rig_without_a_record_wants_a_reason(machine: Path, tmp_path: Path) -> None:
    options = SessionOptions("quickstart", rig=str(machine), out=tmp_path)
    with pytest.raises(CannotStartError, match=r"jog press: to be done.*--accept-risk REASON"):
        not_measured(options, load_rig(machine))
    accepted = replace(options, accept_risk="jogged by hand")
    assert "jog press" in not_measured(accepted, load_rig(machine))


def test_an_override_that_tightens_a_limit_leaves_the_record_as_it_is(machine: Path, tmp_path: Path) -> None:
    commission(load_rig(machine), tmp_path)
    overrides = ("limits.load=300 N",)
    options = SessionOptions("quickstart", rig=str(machine), out=tmp_path, overrides=overrides)
    assert not_measured(options, load_rig(machine, overrides)) == ""


@pytest.mark.parametrize(
    ("kind", "rigs"), [("wheel_on_belt", ["sim"]), ("specimen_on_track", ["grosch", "pin-on-disc"])]
)
def test_every_section_that_a_step_depends_on_is_in_a_packaged_rig(kind: str, rigs: list[str]) -> None:
    found: Any = kinds.find(kind).commissions
    loaded = [load_rig(rig) for rig in rigs]
    sections = {section for step in found().steps for section in step.sections}
    unknown = [one for one in sections if all(value_at(rig, tuple(one.split("."))) is None for rig in loaded)]
    assert unknown == []


def test_a_real_track_needs_its_travel() -> None:
    found: Any = kinds.find("specimen_on_track").commissions
    (travel,) = [step for step in found().steps if step.name == "travel"]
    section = tuple(travel.sections[0].split("."))
    assert travel.required and value_at(load_rig("grosch"), section) and not value_at(load_rig("pin-on-disc"), section)
