"""Numbers and durations as people read them."""

from __future__ import annotations

from math import inf, nan

import pytest

from tester.base.words import (
    about,
    conditions_done,
    counted,
    decimal,
    duration,
    harmless,
    listed,
    listed_some,
    percent,
    plain_text,
    rough_duration,
    significant,
)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0:00:00"), (190.0, "0:03:10"), (3599.6, "1:00:00"), (22440.0, "6:14:00"), (360000.0, "100:00:00"),
     (-3.0, "0:00:00"), (None, "—"), (nan, "—"), (inf, "—")],
)  # fmt: skip
def test_a_duration_is_hours_minutes_and_whole_seconds(seconds: float | None, text: str) -> None:
    assert duration(seconds) == text


def test_a_number_that_is_none_is_a_dash_and_no_number_is_minus_nought() -> None:
    assert [decimal(x, 1) for x in (None, nan, -0.04, 0.06)] == ["—", "—", "0.0", "0.1"]
    assert [significant(x) for x in (None, inf, 0.00012345)] == ["—", "—", "0.000123"]
    assert [percent(x) for x in (nan, 0.0205)] == ["—", "2.1\u00a0%"]


def test_one_thing_is_not_several() -> None:
    assert [counted(n, "wheel") for n in (0, 1, 2)] == ["0 wheels", "1 wheel", "2 wheels"]
    assert counted(2, "entry", "entries") == "2 entries"


def test_conditions_done_are_counted_in_words_and_in_short() -> None:
    assert conditions_done(17, 55) == "17 of 55 conditions done"
    assert conditions_done(0, 1) == "0 of 1 condition done"
    assert conditions_done(17, 55, short=True) == "17/55 done"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0 s"), (45.4, "45 s"), (99.0, "99 s"), (240.0, "4 min"), (5340.0, "89 min"), (11_100.0, "3 h 05 min")],
)
def test_a_rough_duration_is_in_everyday_words(seconds: float, text: str) -> None:
    assert rough_duration(seconds) == text


def test_items_are_listed_with_one_word_before_the_last() -> None:
    assert [listed("abc"[:n]) for n in range(4)] == ["", "a", "a and b", "a, b and c"]
    assert listed(["Hz", "rad/s"], "or") == "Hz or rad/s"


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.2, "1 s"), (9.7, "10 s"), (44.0, "40 s"), (94.9, "90 s"), (97.0, "2 min"), (1234.0, "20 min"), (6000.0, "2 h"),
     (180_000.0, "50 h")],
)  # fmt: skip
def test_a_roughly_known_duration_has_one_digit(seconds: float, words: str) -> None:
    assert about(seconds) == f"about {words}"


def test_a_long_list_ends_with_how_many_more_there_are() -> None:
    assert [listed_some([1, 2, 3], n) for n in (2, 3)] == ["1, 2 and 1 more", "1, 2, 3"]


STEERING = ("\x1b[31m", "\x00", "\x7f", "\x9b", "\u202e", "\u2066", "\u200b", "\u2028", "\ud800", "\t", "\n", "\r")


@pytest.mark.parametrize("text", ["", "A. Person", "Ødegård: µ = 0,7 €", "山田太郎", "no-break\u00a0space", "🙂"])
def test_text_on_one_line_is_taken_unchanged(text: str) -> None:
    assert plain_text(text, "operator") == text


@pytest.mark.parametrize("bad", STEERING)
def test_text_that_could_control_a_terminal_is_refused_with_the_character_and_its_place(bad: str) -> None:
    with pytest.raises(ValueError, match=rf"^reason: the character U\+{ord(bad[0]):04X}, number 4, is not accepted"):
        plain_text(f"ab {bad}", "reason")


def test_escaped_text_controls_nothing_and_keeps_its_lines() -> None:
    assert harmless("a\x1b[31m\tb\nc\r") == "a?[31m\tb\nc?"
