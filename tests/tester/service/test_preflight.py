"""The pre-flight list: faults are reported as faults, and unknown states never as good."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tester.kinds.wheel_on_belt.rig.sections import CertificatesConfig
from tester.kinds.wheel_on_belt.served.left_on_rig import HeatHistory, WheelLeft
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.service.preflight import (
    Past,
    alarms_check,
    calibration_check,
    known_checks,
    last_run_check,
    past_of,
)
from tester.service.state_view import DiskView
from tester.store.records import PieceInfo
from tests.tester.service.views import state, with_alarm
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer

NOW = "2026-03-01T12:00:00.000Z"
WHEEL = PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 89.4, 812.0)
PAST = Past("done", "", WheelLeft("run", WHEEL, "2026-03-01T09:30:00.000Z"))
HISTORY = HeatHistory(NO_HISTORY)


def test_every_matter_has_a_line_once() -> None:
    disk = DiskView(5 * 10**9, 0, False)
    names = [check.name for check in known_checks(load_rig("sim"), disk, (), PAST, "", NOW, HISTORY)]
    assert names[:4] == ["disk space", "alarms", "last run", "calibration"]
    assert names[4:] == ["wheel", "zero of the load cell", "heat balance"]


def test_a_disk_that_is_low_is_wrong() -> None:
    assert known_checks(load_rig("sim"), DiskView(10**8, 0, True), (), None, "", NOW)[0].ok is False


def test_standing_alarms_are_wrong_and_named() -> None:
    found = alarms_check(with_alarm(state()).alarms)
    assert (found.ok, found.text) == (False, "1 in the list: overload") and alarms_check(()).ok


@pytest.mark.parametrize(
    ("status", "reason", "latched", "ok", "words"),
    [
        ("done", "", "", True, "done"),
        ("stopped", "stop by ada", "", None, "stopped: stop by ada"),
        ("tripped", "overload", "overload", False, "tripped: overload; not acknowledged"),
        ("tripped", "overload", "", None, "tripped: overload"),
        ("interrupted", "", "", None, "was cut off: r resumes it"),
        ("running", "", "", None, "running"),
        ("incomplete", "", "", None, "incomplete"),
    ],
)
def test_the_end_of_the_last_run_is_reported(
    status: str, reason: str, latched: str, ok: bool | None, words: str
) -> None:
    found = last_run_check(replace(PAST, status=status, reason=reason), latched)
    assert (found.ok, found.text) == (ok, words)


def test_without_a_run_nothing_is_claimed_of_it() -> None:
    assert last_run_check(None, "").ok is None and last_run_check(None, "rig lost").ok is False


def ending(load_cell: str, thermometer: str, jacket: str) -> CertificatesConfig:
    """Return certificates that end on these days."""
    return CertificatesConfig(load_cell=load_cell, thermometer=thermometer, jacket=jacket)


@pytest.mark.parametrize(
    ("calibration", "ok", "words"),
    [
        (
            ending("2027-01-31", "2027-02-28", "2027-03-31"),
            True,
            "in date until 2027-01-31",
        ),
        (
            ending("2026-02-28", "2027-02-28", "2027-03-31"),
            False,
            "load cell ended 2026-02-28",
        ),
        (
            ending("2026-03-20", "2027-02-28", "2027-03-31"),
            True,
            "load cell ends 2026-03-20",
        ),
        (CertificatesConfig(load_cell="2027-01-31"), None, "not in the rig file: thermometer, jacket"),
        (
            ending("2026-03-01", "2027-02-28", "2027-03-31"),
            True,
            "load cell ends 2026-03-01",
        ),
    ],
)
def test_a_certificate_is_held_against_the_date(calibration: CertificatesConfig, ok: bool | None, words: str) -> None:
    found = calibration_check(calibration, NOW, simulated=False)
    assert (found.ok, found.text) == (ok, words)


def test_a_simulated_rig_needs_no_certificate() -> None:
    assert calibration_check(CertificatesConfig(), NOW, simulated=True).ok


def test_an_invalid_date_in_the_rig_file_is_refused_with_its_position() -> None:
    with pytest.raises(InvalidSource, match="expected a date such as 2027-01-31"):
        load_rig("sim", ('calibration.load_cell="31.1.2027"',))


def test_the_newest_run_is_looked_at_with_its_wheel_and_zero(tmp_path: Path) -> None:
    for name in ("2024-01-01T00-00-00-old", "2024-02-21T14-05-09-new"):
        folder = tmp_path / name
        folder.mkdir()
        writer = open_writer(folder)
        writer.begin_run(RUN, SPECIMENS, [CONDITION])
        writer.piece_mounted(WHEEL)
        writer.tare(70.0, "reference", {"force_z_n": 1.0}, 0)
        writer.event(71.0, "step", "pre-grind")
        writer.finish("stopped", f"in the {name[-3:]} one", rig_seconds=80.0)
        writer.close()
    (tmp_path / "2025-not-a-run").mkdir()
    past = past_of(tmp_path, SERVED)
    assert past is not None and (past.status, past.reason) == ("stopped", "in the new one")
    left = past.left
    assert isinstance(left, WheelLeft) and left.wheel is not None and left.wheel.compound == "1#"
    assert left.tare_utc == "2024-02-21T14:06:00.000Z"


def test_a_record_that_cannot_be_read_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "run.db").write_bytes(b"no database")
    assert past_of(tmp_path, SERVED) is None and past_of(tmp_path / "nowhere", SERVED) is None
