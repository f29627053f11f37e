from __future__ import annotations

import pytest

from tester.base.plain import harmless, plain_text

STEERING = ("\x1b[31m", "\x00", "\x7f", "\x9b", "\u202e", "\u2066", "\u200b", "\u2028", "\ud800", "\t", "\n", "\r")


@pytest.mark.parametrize("text", ["", "A. Person", "Ødegård: µ = 0,7 €", "山田太郎", "no-break\u00a0space", "🙂"])
def test_what_people_write_in_a_line_is_taken_as_it_is(text: str) -> None:
    assert plain_text(text, "operator") == text


@pytest.mark.parametrize("bad", STEERING)
def test_what_could_steer_a_terminal_is_refused_with_what_and_where(bad: str) -> None:
    with pytest.raises(ValueError, match=rf"^reason: the character U\+{ord(bad[0]):04X}, number 4, is not accepted"):
        plain_text(f"ab {bad}", "reason")


def test_what_is_shown_anyway_steers_nothing_and_keeps_its_lines() -> None:
    assert harmless("a\x1b[31m\tb\nc\r") == "a?[31m\tb\nc?"
