"""Pages made from the rows are up to date and agree with the rows."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

from tester.base.source import load_tree
from tester.inputs.rig.parameter import WIDTH, key_line
from tester.kinds import find
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS, TABLE
from tester.machine.wires import LATE_WARN_S

DOCS = Path(__file__).parents[5] / "docs"
PAGE = DOCS / "kinds" / "wheel-on-belt.md"
SHEET = find("wheel_on_belt").interlocks()
OTHER_KEYS = {"slip_power", "software_limits"}
"""Words of the table that are keys of other sections."""


def test_page_and_packaged_rig_file_are_made_from_the_rows() -> None:
    """``python docs/interlocks.py`` writes them."""
    outdated = runpy.run_path(str(DOCS / "interlocks.py"))["outdated"]
    assert [path.name for path, _ in outdated()] == []


def test_the_page_shows_every_row() -> None:
    shown = PAGE.read_text(encoding="utf-8").split("<!-- interlocks: begin -->\n")[1]
    assert shown.startswith(SHEET.table()) and all(f"| {row.name} |" in shown for row in TABLE.rows)


def test_every_key_the_table_names_is_a_parameter() -> None:
    named = {word for row in TABLE.rows for word in re.findall(r"[a-z]+(?:_[a-z]+)+", row.watch.level)}
    assert named <= {one.key for one in PARAMETERS} | OTHER_KEYS


def test_a_section_of_a_rig_file_has_every_parameter_once() -> None:
    tree = load_tree(SHEET.section())
    assert isinstance(tree.data, dict) and isinstance(tree.data["interlocks"], dict)
    assert list(tree.data["interlocks"]) == [one.key for one in PARAMETERS]


def test_a_line_of_a_rig_file_is_key_value_and_comment() -> None:
    line = key_line(LATE_WARN_S)
    assert line[:WIDTH].split() == ["late_warn:", "50", "ms"] and line[WIDTH:] == "# a scan this late is a warning ..."


def test_lines_of_a_rig_file_are_no_longer_than_those_of_the_packaged_one() -> None:
    assert max(map(len, SHEET.section().splitlines())) <= 120


def test_the_page_calls_nothing_in_software_by_a_word_it_may_not_use() -> None:
    text = PAGE.read_text(encoding="utf-8")
    allowed = text.split("(\"safety-rated\"")[0] + text.split("\"emergency stop\"). ")[-1]
    assert not re.search(r"safety-rated|fail-safe|\bSIL\b|\bE-stop\b", allowed, re.IGNORECASE)
