"""`tester doctor`, `tester bus sdo` and `tester bus params` as typed."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from tester.base.lock import FOLDER_VARIABLE, ExclusiveUse
from tester.cli.main import invoke
from tester.kinds import load_rig
from tester.run.preconditions import buses_of
from tests.tester.run.reached import reached_over_tcp

QUICK = ("--quick", "--seconds", "1")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def answer(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(text))


def test_the_doctor_prints_a_line_a_finding_and_ends_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["doctor", *QUICK]) == 0
    out = capsys.readouterr().out
    assert "ok      CAN bus: 500000 bit/s, nodes 1, 2, 3, 4, 5" in out
    assert "ok      load cell: " in out


def test_findings_come_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["doctor", *QUICK, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["rig"] == "simulated rubber friction tester"
    assert {"heading", "severity", "subject", "found", "todo"} == set(found["findings"][0])


def test_a_full_disk_ends_with_1(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("tester.doctor.system.Computer.free_bytes", lambda _self, _folder: 0)
    assert invoke(["doctor", *QUICK]) == 1
    assert "fault   run folder: the disk is full" in capsys.readouterr().out


def test_a_bundle_has_everything_for_remote_support(tmp_path: Path) -> None:
    (tmp_path / "runs" / "2026-01-01T00-00-00-one").mkdir(parents=True)
    (tmp_path / "runs" / "2026-01-01T00-00-00-one" / "can.log").write_text("x", encoding="utf-8")
    assert invoke(["doctor", *QUICK, "--bundle", "help.zip"]) == 0
    with ZipFile("help.zip") as archive:
        texts = {name: archive.read(name).decode() for name in archive.namelist()}
    assert set(texts) == {"findings.txt", "findings.json", "rig.yaml", "versions.json", "parameters.json", "runs.txt"}
    assert "can.log 1 bytes" in texts["runs.txt"]
    assert 'kind: "wheel_on_belt"' in texts["rig.yaml"]
    assert json.loads(texts["parameters.json"])["devices"]["belt"]["0x1018:04"]["value"] == "2"


@pytest.mark.parametrize("command", [["doctor", *QUICK, "--rig"], ["bus", "params", "dump"]])
def test_a_rig_in_use_is_left_alone(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path))
    rig = load_rig("sim")
    doors = {name: ("127.0.0.1", port) for port, name in enumerate(rig.lines, 2)}
    real = reached_over_tcp(rig, ("127.0.0.1", 1), doors)
    path = tmp_path / "rig.yaml"
    path.write_text(real.text, encoding="utf-8")
    with ExclusiveUse() as use:
        use.lock(buses_of(real), "a run")
        assert invoke([*command, str(path)]) == 4
    assert "is in use" in capsys.readouterr().err


def test_an_object_is_read_by_the_name_of_its_axis(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "sdo", "press", "0x6076"]) == 0
    assert capsys.readouterr().out == "0x6076:00 (motor rated torque (mN m)): 2000 (0x7D0)\n"


def test_an_object_that_is_not_there_ends_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "sdo", "1", "2FFF:3"]) == 1
    assert "object does not exist" in capsys.readouterr().err


@pytest.mark.parametrize("typed", [("conveyor", "1000"), ("1", "10000"), ("128", "1000")])
def test_an_argument_that_names_no_object_is_a_usage_error(typed: tuple[str, str]) -> None:
    assert invoke(["bus", "sdo", *typed]) == 2


def test_a_value_is_written_after_a_yes_and_read_back(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answer(monkeypatch, "y\n")
    assert invoke(["bus", "sdo", "belt", "0x6072", "--write", "1000"]) == 0
    shown = capsys.readouterr()
    assert "3000; write 1000?" in shown.err
    assert shown.out == "0x6072:00 (max torque (per mille of rated)): 1000 (0x3E8)\n"


def test_nothing_is_written_without_a_yes(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    answer(monkeypatch, "n\n")
    assert invoke(["bus", "sdo", "belt", "0x6072", "--write", "1000"]) == 130
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("name", ["0x6040", "0x60FE:1", "0x60FF", "0x607A"])
def test_a_command_is_not_written(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "sdo", "press", name, "--write", "0"]) == 1
    assert "only a run sends it" in capsys.readouterr().err


@pytest.mark.parametrize("value", ["3e3", "", "70000"])
def test_a_value_that_does_not_fit_is_a_usage_error(value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    answer(monkeypatch, "y\n")
    assert invoke(["bus", "sdo", "belt", "0x6072", "--write", value]) == 2


def test_an_object_of_unknown_type_asks_for_its_type(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "sdo", "belt", "0x2345", "--write", "1"]) == 2
    assert "--type" in capsys.readouterr().err


def test_a_dump_compared_with_itself_does_not_differ(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "params", "dump", "sim", "-o", "was.json"]) == 0
    assert invoke(["bus", "params", "compare", "sim", "was.json"]) == 0
    assert capsys.readouterr().out == "was.json\n"


def test_a_difference_is_reported_and_ends_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "params", "dump", "sim", "-o", "was.json"]) == 0
    path = tmp_path / "was.json"
    path.write_text(path.read_text(encoding="utf-8").replace('"value": "2000"', '"value": "1900"', 1), encoding="utf-8")
    capsys.readouterr()
    assert invoke(["bus", "params", "compare", "sim", "was.json"]) == 1
    assert capsys.readouterr().out == "press 0x6076:00 (motor rated torque (mN m)): was 1900, is 2000\n"
    assert invoke(["bus", "params", "compare", "sim", "was.json", "--json"]) == 1
    (one,) = json.loads(capsys.readouterr().out)["differences"]
    assert (one["device"], one["was"], one["is"], one["written_at_connect"]) == ("press", "1900", "2000", False)


def test_without_a_run_there_is_nothing_to_compare_with(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "params", "compare", "sim"]) == 2
    assert "no run" in capsys.readouterr().err
