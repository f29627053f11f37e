"""`tester bus eds`: its report on a data sheet for an axis, and its exit code."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drivers.canopen.eds import EDS_PATH
from tester.cli.main import invoke

SHEETS = Path(__file__).parents[2] / "drivers" / "eds"


def test_a_drive_that_is_fit_ends_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "eds", str(EDS_PATH), "--rig", "sim"]) == 0
    said = capsys.readouterr().out
    assert all(f"{axis} with the profile cia402: would be connected" in said for axis in ("wheel", "press", "camber"))


def test_the_profile_is_the_makers(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["bus", "eds", str(SHEETS / "maxon_epos4.eds")]) == 0
    said = capsys.readouterr().out
    assert "press with the profile maxon_epos4: would be connected" in said
    assert "without: 0x605D:00 (halt option code): how the axis slows down on halt is the drive's own" in said


def test_of_two_profiles_of_a_maker_the_one_that_fits_is_taken(capsys: pytest.CaptureFixture[str]) -> None:
    invoke(["bus", "eds", str(SHEETS / "elmo_simpliq.eds")])
    assert "speed axis with the profile elmo_simpliq: would be connected" in capsys.readouterr().out


def test_every_refusal_is_reported_and_ends_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    sheet = str(SHEETS / "maxon_epos4.eds")
    assert invoke(["bus", "eds", sheet, "--profile", "cia402"]) == 1
    said = capsys.readouterr().out
    for missing in ("0x605D:00", "0x6072:00", "0x1400:05", "0x60FE:02", "0x1801:05"):
        assert f"refused: {missing} (" in said


def test_an_axis_of_a_rig_can_be_meant_alone(capsys: pytest.CaptureFixture[str]) -> None:
    sheet = str(SHEETS / "maxon_epos4.eds")
    arguments = ["bus", "eds", sheet, "--rig", "sim", "--axis", "wheel", "--profile", "maxon_epos4"]
    assert invoke([*arguments, "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert list(data["axes"]) == ["wheel"]
    assert [one.split(" (")[0] for one in data["axes"]["wheel"]["refused"]] == ["0x1018:01", "0x1018:02"]


@pytest.mark.parametrize(("arguments", "message"), [
    (["--axis", "wheel"], "--axis needs --rig"),
    (["--rig", "sim", "--axis", "lift"], "the rig has no drive lift (it has wheel, belt"),
    (["--profile", "epos"], "no drive profile 'epos'"),
])  # fmt: skip
def test_a_wrong_question_is_a_usage_error(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["bus", "eds", str(EDS_PATH), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_file_that_is_no_data_sheet_is_a_usage_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "other.eds"
    path.write_text("hello")
    assert invoke(["bus", "eds", str(path)]) == 2
    assert "other.eds: no data sheet" in capsys.readouterr().err
