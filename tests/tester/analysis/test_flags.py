"""The one list of flags."""

from __future__ import annotations

import pytest

from tester.analysis.flags import DOUBTS, FLAGS, SHORT, TRUNCATED, flags_in, joined, remedy_of


@pytest.mark.parametrize("word", FLAGS)
def test_every_flag_has_a_sentence(word: str) -> None:
    assert FLAGS[word].word == word and FLAGS[word].meaning.endswith(".")


@pytest.mark.parametrize("word", DOUBTS)
def test_every_doubt_has_a_remedy(word: str) -> None:
    assert FLAGS[word].remedy and not FLAGS[word].remedy.endswith(".")


@pytest.mark.parametrize("word", FLAGS)
def test_no_word_holds_the_mark_between_words(word: str) -> None:
    assert flags_in(joined([word, SHORT])) == sorted({word, SHORT})


def test_a_note_needs_no_remedy() -> None:
    assert remedy_of([TRUNCATED]) == ""


def test_the_first_doubt_of_the_list_is_mended_first() -> None:
    assert remedy_of(reversed(DOUBTS)) == FLAGS[DOUBTS[0]].remedy
