"""The comparison with an earlier tree: keys of files, keys that a schema allows, rows, losses."""

from __future__ import annotations

from pathlib import Path

from tests.campaigns.against import keys_of, missing, properties, rows_of, words_of

SCHEMA = {
    "properties": {"load": {"$ref": "#/$defs/Axis"}, "next": {"anyOf": [{"$ref": "#/$defs/Loop"}, {"type": "null"}]}},
    "$defs": {
        "Axis": {"properties": {"values": {"type": "array"}}},
        "Loop": {"properties": {"again": {"$ref": "#/$defs/Loop"}}},
    },
}


def test_keys_are_dotted_through_lists() -> None:
    assert list(keys_of({"axes": [{"name": 1}, {"node": 2}]})) == ["axes", "axes.name", "axes.node"]


def test_a_schema_is_followed_through_references_and_a_loop_ends() -> None:
    assert sorted(properties(SCHEMA, SCHEMA)) == ["load", "load.values", "next", "next.again"]


def test_rows_are_those_of_the_pages_tables(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    table = "| interlock | cause |\n|---|---|\n| overload | force |\n| hot | heat |\n"
    page = f"Before.\n<!-- interlocks: begin -->\n{table}<!-- interlocks: end -->\n"
    (tmp_path / "docs" / "safety.md").write_text(page, encoding="utf-8")
    assert list(rows_of(tmp_path)) == ["row track overload", "row track hot"]


def test_a_removed_line_is_lost_unless_it_was_reworded() -> None:
    before = {"command sdo", "command sdo --type", "command eds", "key rig sim can"}
    now = {"command bus sdo", "command bus sdo --type", "key rig sim can"}
    assert missing(before, now) == ["command eds"]


def test_words_are_pairs_by_a_tab(tmp_path: Path) -> None:
    path = tmp_path / "words"
    path.write_text("cut short\tended early\n\n", encoding="utf-8")
    assert words_of(path) == [("cut short", "ended early")]
    assert words_of(None) == []
