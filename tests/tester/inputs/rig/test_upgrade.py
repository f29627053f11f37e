"""A rig file that lacks keys: read with the packaged values, named, completed without another change."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tester.base.source import InvalidSource, load_tree
from tester.kinds import hardware_text, load_rig, packaged_keys, upgrade
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS

OLD = ("pushed", "clear", "runaway_window", "rolling_offset", "gauge")
"""Keys that the file of these tests does not have."""
KEYS = (
    "loops.heat.rolling_offset", "interlocks.runaway_window", "interlocks.clear", "interlocks.pushed", "wear.gauge",
)  # fmt: skip
"""The same keys, in the order of the packaged file."""


def without(lines: list[str]) -> list[str]:
    """Return the lines that set none of those keys."""
    return [line for line in lines if not line.strip().startswith(tuple(f"{key}:" for key in OLD))]


def old_text() -> str:
    return "".join(without(hardware_text().splitlines(keepends=True)))


@pytest.fixture
def old(tmp_path: Path) -> Path:
    path = tmp_path / "rig.yaml"
    path.write_text(old_text(), encoding="utf-8")
    return path


def test_a_key_that_is_missing_takes_the_packaged_value(old: Path) -> None:
    mine, packaged = load_rig(old), load_rig("sim")
    assert (mine.interlocks, mine.loops, mine.wear) == (packaged.interlocks, packaged.loops, packaged.wear)


def test_missing_keys_are_named_in_the_order_of_the_packaged_file(old: Path) -> None:
    assert packaged_keys(old) == KEYS


def test_a_key_that_is_set_for_the_command_is_not_missing(old: Path) -> None:
    assert "interlocks.pushed" not in packaged_keys(old, ["interlocks.pushed=0.2 mm"])


def test_the_packaged_rig_lacks_nothing() -> None:
    assert packaged_keys("sim") == ()


def test_upgrade_writes_the_missing_keys_and_lists_them(old: Path) -> None:
    before = load_rig(old)
    assert upgrade(old) == KEYS
    assert packaged_keys(old) == () and load_rig(old) == before


def test_upgrade_keeps_every_other_line_as_it_is(old: Path) -> None:
    upgrade(old)
    assert without(old.read_text(encoding="utf-8").splitlines()) == old_text().splitlines()


def test_upgrade_gives_the_new_keys_their_comments(old: Path) -> None:
    upgrade(old)
    (line,) = [line for line in old.read_text(encoding="utf-8").splitlines() if line.startswith("  pushed:")]
    assert line.startswith("  pushed: 0.3 mm ") and "# ordered to lift or rest" in line


def test_upgrade_of_a_complete_file_leaves_it_alone(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text(), encoding="utf-8")
    written = path.stat().st_mtime_ns
    assert upgrade(path) == () and path.stat().st_mtime_ns == written


def test_upgrade_keeps_line_ends_and_permissions(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_bytes(old_text().replace("\n", "\r\n").encode())
    path.chmod(0o600)
    upgrade(path)
    assert path.read_bytes().count(b"\n") == path.read_bytes().count(b"\r\n")
    assert path.stat().st_mode & 0o777 == 0o600


def test_upgrade_goes_by_the_indentation_of_the_section(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text("interlocks:\n      jump: 4 K  # mine\n# the end", encoding="utf-8")
    upgrade(path)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[1] == "      jump: 4 K  # mine" and "# the end" in lines
    assert lines[2].startswith("      silent_can_scans: 2.5")


@pytest.mark.parametrize("text", ["rig: mine\n", "interlocks:\n", "rig: mine\ninterlocks:   # none yet"])
def test_upgrade_fills_a_section_that_is_empty_or_missing(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    upgrade(path)
    tree = load_tree(path)
    assert isinstance(tree.data, dict) and isinstance(tree.data["interlocks"], dict)
    assert set(tree.data["interlocks"]) == {one.key for one in PARAMETERS}


@pytest.mark.parametrize("text", ["interlocks: {jump: 4 K}\n", "interlocks: 3\n", "- a\n"])
def test_upgrade_refuses_a_file_that_takes_no_line_and_leaves_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidSource):
        upgrade(path)
    assert path.read_text(encoding="utf-8") == text and list(tmp_path.iterdir()) == [path]


def test_upgrade_writes_a_section_that_is_missing_as_the_packaged_file_has_it(tmp_path: Path) -> None:
    text = hardware_text()
    begin, end = text.index("\n# When a sample counts."), text.index("\n# Level and delay of each interlock")
    path = tmp_path / "rig.yaml"
    path.write_text(text[:begin] + text[end:], encoding="utf-8")
    upgrade(path)
    assert path.read_text(encoding="utf-8") == text[:begin] + text[end:] + text[begin:end]


def test_upgrade_writes_a_section_inside_another_with_its_comments(tmp_path: Path) -> None:
    text = hardware_text()
    begin, end = text.index("  heat:      "), text.index("\n# When a sample counts.")
    path = tmp_path / "rig.yaml"
    path.write_text(text[:begin] + text[end:], encoding="utf-8")
    upgrade(path)
    assert path.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    "line",
    [
        "simulated: false", "  load: 440 N ", "  wheel_diameter: 90 mm", "  interface: socketcan", "  bitrate: 500000",
        "    node_id: 4", "    rated_torque: 2 N m", "    port: /dev/ttyUSB0", "    unit_id: 2", "    profile: calex",
        "  ambient: 23 degC", "    outer_diameter: 90 mm",
    ],
)  # fmt: skip
def test_a_key_that_only_the_builders_know_must_be_there(tmp_path: Path, line: str) -> None:
    text = hardware_text()
    assert text.count(f"\n{line}") == 1
    path = tmp_path / "rig.yaml"
    path.write_text(text.replace(f"\n{line}", "\n# "), encoding="utf-8")
    with pytest.raises(InvalidSource) as caught:
        load_rig(path)
    key = line.strip().partition(":")[0]
    assert f"{key} is missing" in str(caught.value) and "no packaged value can replace it" in str(caught.value)
    assert f".{key}" not in "".join(packaged_keys(path))


@pytest.mark.parametrize("axis", ["wheel", "sideslip"])
def test_an_axis_that_is_missing_is_not_taken_from_the_packaged_file(tmp_path: Path, axis: str) -> None:
    content = yaml.safe_load(hardware_text())
    del content["axes"][axis]
    path = tmp_path / "rig.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(InvalidSource, match=f"{axis} is missing"):
        load_rig(path)


def test_an_axis_set_by_hand_takes_no_key(tmp_path: Path) -> None:
    content = yaml.safe_load(hardware_text())
    content["axes"]["camber"] = {"manual": True}
    del content["axes"]["wheel"]["rpdo_deadline"]
    path = tmp_path / "rig.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    assert packaged_keys(path) == ("axes.wheel.rpdo_deadline",)
    rig = load_rig(path)
    assert rig.axes.camber is None and rig.axes.wheel.rpdo_deadline_s == 0.2


def test_a_press_without_a_screw_is_not_given_the_packaged_one(tmp_path: Path) -> None:
    content = yaml.safe_load(hardware_text())
    del content["axes"]["press"]["screw"]
    path = tmp_path / "rig.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    assert load_rig(path).axes.press.screw is None
