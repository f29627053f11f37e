"""The page for users shows the table that runs."""

from __future__ import annotations

import re
from pathlib import Path

from tester.control.describe import interlock_table
from tester.interlocks.table import INTERLOCKS
from tester.rig import RigConfig

PAGE = Path(__file__).parents[3] / "docs" / "safety.md"


def test_the_page_shows_the_table_of_the_program(rig: RigConfig) -> None:
    text = PAGE.read_text(encoding="utf-8")
    shown = text.split("<!-- interlocks: begin -->\n")[1].split("<!-- interlocks: end -->")[0]
    assert shown == interlock_table(rig)


def test_every_key_the_table_names_is_in_the_rig_file(rig: RigConfig) -> None:
    section = rig.tree["interlocks"]
    assert isinstance(section, dict)
    keys = {str(key) for key in section} | {"slip_power", "software_limits"}
    named = {word for row in INTERLOCKS for word in re.findall(r"[a-z]+(?:_[a-z]+)+", row.level)}
    assert named <= keys


def test_the_page_calls_nothing_in_software_by_a_word_it_may_not_use() -> None:
    text = PAGE.read_text(encoding="utf-8")
    allowed = text.split("(\"safety-rated\"")[0] + text.split("\"emergency stop\"). ")[-1]
    assert not re.search(r"safety-rated|fail-safe|\bSIL\b|\bE-stop\b", allowed, re.IGNORECASE)
