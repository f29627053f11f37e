"""Keys: their meaning, and the terminal's state afterwards."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator

import pytest

from tester.cli.command_keys import Keys, keys_of


@pytest.fixture
def terminal() -> Iterator[tuple[int, io.TextIOWrapper]]:
    """The far end of a pseudo-terminal, and the stream at its near end."""
    pty = pytest.importorskip("pty")
    far, near = pty.openpty()
    stream = os.fdopen(near, "r", encoding="utf-8")
    yield far, stream
    stream.close()
    os.close(far)


def test_a_stream_that_is_no_terminal_has_no_keys() -> None:
    assert type(keys_of(io.StringIO("h"))) is Keys


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")
def test_a_key_is_there_without_enter_and_nothing_is_waited_for(terminal: tuple[int, io.TextIOWrapper]) -> None:
    far, stream = terminal
    keys = keys_of(stream)
    keys.begin()
    assert keys.pressed() == ""
    os.write(far, b"h\x18")
    assert keys.pressed() == "h\x18"
    keys.end()


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")
def test_the_terminal_is_given_back_as_it_was(terminal: tuple[int, io.TextIOWrapper]) -> None:
    import termios

    _, stream = terminal
    before = termios.tcgetattr(stream.fileno())
    keys = keys_of(stream)
    keys.begin()
    assert termios.tcgetattr(stream.fileno()) != before
    keys.end()
    assert termios.tcgetattr(stream.fileno()) == before
