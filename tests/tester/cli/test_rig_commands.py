"""`tester rig init`, `tester rig show` and `tester rig upgrade`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.kinds import hardware_text, load_rig


def test_init_writes_a_file_that_is_a_rig(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert invoke(["rig", "init", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    assert not load_rig(path).simulated


def test_init_does_not_replace_a_file(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text("mine", encoding="utf-8")
    assert invoke(["rig", "init", str(path)]) == 2
    assert path.read_text(encoding="utf-8") == "mine"


def test_init_replaces_a_file_on_request(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text("mine", encoding="utf-8")
    assert invoke(["rig", "init", str(path), "--force"]) == 0
    assert "limits:" in path.read_text(encoding="utf-8")


def test_init_into_a_folder_that_is_not_there_is_a_usage_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["rig", "init", str(tmp_path / "none" / "rig.yaml")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_the_output_of_show_reads_back_as_the_same_rig(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["rig", "show", "--set", "sim.noise=0.5"]) == 0
    path = tmp_path / "shown.yaml"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    assert load_rig(path) == load_rig("sim", ["sim.noise=0.5"])


def test_show_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["rig", "show", "--json", "--set", "limits.load=400 N"]) == 0
    assert json.loads(capsys.readouterr().out)["limits"]["load"] == "400 N"


def test_show_of_a_file_that_is_not_there_exits_3(tmp_path: Path) -> None:
    assert invoke(["rig", "show", "--rig", str(tmp_path / "none.yaml")]) == 3


def test_show_lists_the_keys_that_take_the_packaged_value(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text().replace("  pushed: ", "  # pushed: "), encoding="utf-8")
    assert invoke(["rig", "show", "--rig", str(path)]) == 0
    shown = capsys.readouterr()
    assert "pushed: 0.3 mm" in shown.out
    assert "packaged values count for interlocks.pushed\n" in shown.err and f"tester rig upgrade {path}" in shown.err


def test_keys_have_their_class_and_the_reason(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["rig", "keys"]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert any(line.startswith("limits.load: not above 450 N; the press still comes") for line in shown)
    assert "axes.*.rated_torque: held; 0x6076 of the drive, within 2 %" in shown
    assert any(line.startswith("sim.*: free; ") for line in shown)
    assert invoke(["rig", "keys", "--kind", "none"]) == 2


def test_upgrade_writes_the_keys_that_a_file_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text().replace("  pushed: ", "  # pushed: "), encoding="utf-8")
    assert invoke(["rig", "upgrade", str(path)]) == 0
    assert invoke(["rig", "upgrade", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: written: interlocks.pushed\n{path}: has every key\n"


def test_upgrade_of_a_file_that_is_not_there_exits_3(tmp_path: Path) -> None:
    assert invoke(["rig", "upgrade", str(tmp_path / "none.yaml")]) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--kind", "whel_on_belt"], "did you mean wheel_on_belt?"),
        (["--like", "none"], "no packaged rig of the kind wheel_on_belt is called none (expected sim)"),
    ],
)
def test_init_of_a_kind_or_a_packaged_rig_that_is_none_is_a_usage_error(
    options: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["rig", "init", str(tmp_path / "rig.yaml"), *options]) == 2
    assert message in capsys.readouterr().err and not (tmp_path / "rig.yaml").exists()


def test_init_writes_the_kind_into_the_file(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    assert invoke(["rig", "init", str(path), "--kind", "wheel_on_belt", "--like", "sim"]) == 0
    assert load_rig(path).kind == "wheel_on_belt"
