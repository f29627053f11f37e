"""Single keys from a terminal, without waiting for them: POSIX terminals and the Windows console behind one door.

Tried on Linux; the Windows side follows its documentation and was not tried.
"""

from __future__ import annotations

import sys
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import TextIO


class Keys:
    """A keyboard read key by key between ``begin`` and ``end``. This class has no terminal and reports no keys."""

    def begin(self) -> None:
        """Take single keys from now on; pressing one shows nothing."""

    def end(self) -> None:
        """Give the terminal back as it was."""

    def pressed(self) -> str:
        """Return the keys pressed since the last call, "" for none; never waits."""
        return ""


def keys_of(stream: TextIO | None) -> Keys:
    """Return the keys of a stream: none unless it is a terminal."""
    if stream is None or not stream.isatty():
        return Keys()
    if sys.platform == "win32":
        return _console_keys()
    return _terminal_keys(stream.fileno())


if sys.platform == "win32":

    def _console_keys() -> Keys:
        import msvcrt

        class ConsoleKeys(Keys):
            """The Windows console gives single keys as they are."""

            def pressed(self) -> str:
                found = ""
                while msvcrt.kbhit():
                    found += msvcrt.getwch()
                return found

        return ConsoleKeys()

else:

    def _terminal_keys(descriptor: int) -> Keys:
        import os
        import select
        import termios

        @contextmanager
        def as_os_error() -> Generator[None]:
            """Raise an error of termios, such as a lost terminal, as an OSError."""
            try:
                yield
            except termios.error as error:
                raise OSError(*error.args) from error

        class TerminalKeys(Keys):
            """A POSIX terminal without line mode and echo; Ctrl+C stays a signal."""

            def __init__(self) -> None:
                self.before: list[int | list[bytes | int]] | None = None

            def begin(self) -> None:
                if self.before is not None:
                    return
                with as_os_error():
                    self.before = termios.tcgetattr(descriptor)
                    changed = termios.tcgetattr(descriptor)
                    changed[3] = int(changed[3]) & ~(termios.ICANON | termios.ECHO)  # pyright: ignore[reportArgumentType]
                    termios.tcsetattr(descriptor, termios.TCSADRAIN, changed)

            def end(self) -> None:
                if self.before is not None:
                    before, self.before = self.before, None
                    with as_os_error():
                        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)

            def pressed(self) -> str:
                if self.before is None or not select.select([descriptor], [], [], 0.0)[0]:
                    return ""
                with suppress(OSError):  # the shell has the terminal: this process was put into the background
                    return os.read(descriptor, 64).decode("utf-8", "replace")
                return ""

        return TerminalKeys()
