"""The tree has no forbidden phrase or name; the finder reads across line breaks and skips code."""

from __future__ import annotations

from pathlib import Path

from tests.campaigns.prose import NEVER, NO_NAMES, PAGES, Place, names, phrases, prose_of, wrong_names, wrong_phrases

SOURCE = '''"""What is
told of a run."""


def report(told: str) -> str:
    # It goes on
    # with the next one.
    said = "nobody "\\
        "minds"
    is_told = said + told
    return is_told
'''


def test_a_phrase_is_found_where_lines_break_and_in_no_code() -> None:
    found = [word for line, text in prose_of(SOURCE) for _, word in phrases(line, text, NEVER)]
    assert found == ["is told", "goes on with", "nobody minds"]


def test_a_phrase_has_the_line_it_begins_in() -> None:
    assert list(phrases(1, "One line.\nIt is told.", NEVER)) == [(2, "is told")]


def test_parameters_and_locals_have_names() -> None:
    assert sorted(names(SOURCE, NO_NAMES)) == [(5, "told"), (8, "said")]


def test_pages_and_packages_are_read(tmp_path: Path) -> None:
    (tmp_path / "docs" / "how-to").mkdir(parents=True)
    (tmp_path / "sim").mkdir()
    (tmp_path / "docs" / "how-to" / "doctor.md").write_text("What is\ntold\n", encoding="utf-8")
    (tmp_path / "sim" / "rig.py").write_text("# is heard\nheard = 1\n", encoding="utf-8")
    assert wrong_phrases(NEVER, tmp_path) == [
        Place("docs/how-to/doctor.md", 1, "is told"),
        Place("sim/rig.py", 1, "is heard"),
    ]
    assert wrong_names(NO_NAMES, tmp_path) == [Place("sim/rig.py", 2, "heard")]


def test_no_page_and_no_text_holds_a_phrase_that_is_never_right() -> None:
    assert "\n".join(map(str, wrong_phrases(NEVER))) == ""


def test_nothing_has_a_name_that_is_never_right() -> None:
    assert "\n".join(map(str, wrong_names())) == ""


def test_every_pattern_of_pages_has_pages() -> None:
    root = Path(__file__).parents[1]
    assert all(list(root.glob(pattern)) for pattern in PAGES)
