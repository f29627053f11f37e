"""One table of keys: the bytes of a terminal, and their description in the pages."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.base.keys import FAST_STOP, MEANINGS, STOP, Meaning, commands_of, pieces_of

DOCS = Path(__file__).parents[3]


def test_keys_mean_commands_and_others_nothing() -> None:
    assert commands_of("sX \x18ar?\x06") == ["hold", "stop", "release", "fast stop"]


def test_function_keys_are_read_whole_and_others_are_no_letters() -> None:
    assert commands_of("\x1b[24~\x1b[20~\x1b[17~\x1bOr\x1b[1;2r") == ["stop", "fast stop"]
    assert [piece for piece, _ in pieces_of("a\x1b[17~b")] == ["a", "\x1b[17~", "b"]


def test_no_key_has_two_meanings() -> None:
    typed = [text for one in MEANINGS for text in one.typed]
    keys = [key for one in MEANINGS for key in one.keys]
    assert len(set(typed)) == len(typed) and len(set(keys)) == len(keys)


@pytest.mark.parametrize("page", ["README.md", "docs/tui.md", "docs/safety.md"])
@pytest.mark.parametrize("meaning", [STOP, FAST_STOP], ids=lambda one: one.command)
def test_every_page_names_the_keys_of_both_stops(page: str, meaning: Meaning) -> None:
    text = (DOCS / page).read_text(encoding="utf-8")
    assert any(meaning.shown in line and meaning.does in line for line in text.splitlines())
