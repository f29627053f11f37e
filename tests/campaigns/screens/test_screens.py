"""The checks of the operator's screen as a campaign, in their short form; their readers are always tested."""

from __future__ import annotations

import pytest

from tests.campaigns.screens import __main__ as screens
from tests.campaigns.screens.seat import median
from tests.campaigns.screens.terminal import HAS_PTY, KEYS, strip
from tests.campaigns.screens.topics import TOPICS


def test_what_is_drawn_is_read_without_colours_places_and_titles() -> None:
    drawn = b"\x1b[2;1H\x1b[38;2;1;2;3mRUN\x1b[0m \x1b]0;title\x07\xe2\x97\x8f\x1b7"
    assert strip(drawn) == "RUN \N{BLACK CIRCLE}"


def test_the_middle_of_nothing_keeps_no_limit() -> None:
    assert not median([]) <= 1.0 and median([3.0, 1.0, 2.0]) == 2.0


def test_the_keys_of_stop_are_those_that_a_terminal_sends() -> None:
    assert (KEYS["F12"], KEYS["Ctrl+X"]) == (b"\x1b[24~", b"\x18")


def test_an_unknown_topic_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        screens.main(["nothing"])
    assert "no topic nothing" in capsys.readouterr().err


@pytest.mark.campaign
@pytest.mark.skipif(not HAS_PTY, reason="needs pseudo-terminals")
@pytest.mark.parametrize("name", TOPICS)
def test_the_screen_keeps_what_is_asked(name: str) -> None:
    assert screens.main([name, "--sample"]) == 0
