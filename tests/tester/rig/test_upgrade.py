"""A rig file that lacks keys of interlocks: read with the packaged values, named, completed without another change."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.interlocks.table import PARAMETERS
from tester.rig import load_rig
from tester.rig.template import hardware_text
from tester.rig.upgrade import packaged_keys, upgrade
from tester.source import InvalidSource, load_tree

OLD = ("pushed", "clear", "runaway_window")
"""Keys that the file of these tests does not have."""


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
    assert load_rig(old).interlocks == load_rig("sim").interlocks


def test_missing_keys_are_named_in_the_order_of_the_packaged_file(old: Path) -> None:
    assert packaged_keys(old) == ("interlocks.runaway_window", "interlocks.clear", "interlocks.pushed")


def test_a_key_that_is_set_for_the_command_is_not_missing(old: Path) -> None:
    assert "interlocks.pushed" not in packaged_keys(old, ["interlocks.pushed=0.2 mm"])


def test_the_packaged_rig_lacks_nothing() -> None:
    assert packaged_keys("sim") == ()


def test_upgrade_writes_the_missing_keys_and_says_which(old: Path) -> None:
    before = load_rig(old)
    assert set(upgrade(old)) == set(OLD)
    assert packaged_keys(old) == () and load_rig(old) == before


def test_upgrade_keeps_every_other_line_as_it_is(old: Path) -> None:
    upgrade(old)
    assert without(old.read_text(encoding="utf-8").splitlines()) == old_text().splitlines()


def test_upgrade_gives_the_new_keys_their_comments(old: Path) -> None:
    upgrade(old)
    (line,) = [line for line in old.read_text(encoding="utf-8").splitlines() if line.startswith("  pushed:")]
    assert line.startswith("  pushed: 0.3 mm ") and "# told to lift or to rest" in line


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
    assert lines[1] == "      jump: 4 K  # mine" and lines[-1] == "# the end"
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
def test_upgrade_refuses_what_no_line_can_be_added_to_and_leaves_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidSource):
        upgrade(path)
    assert path.read_text(encoding="utf-8") == text and list(tmp_path.iterdir()) == [path]
