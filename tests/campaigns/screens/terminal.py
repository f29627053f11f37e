"""A real terminal of some size with `tester` in it: its keys go in as bytes, and its output is read, or not."""

from __future__ import annotations

import asyncio
import os
import re
import struct
import subprocess
from collections.abc import Sequence

from tester.base import clock
from tests.campaigns.screens.seat import LOOK_S, NotSeenError, Seat, installed

try:
    import fcntl
    import termios
except ImportError:  # no such terminals on this system
    HAS_PTY = False
else:
    HAS_PTY = hasattr(os, "openpty")

KEYS = {
    "F2": b"\x1bOQ", "F3": b"\x1bOR", "F4": b"\x1bOS", "F5": b"\x1b[15~", "F6": b"\x1b[17~", "F12": b"\x1b[24~",
    "Ctrl+X": b"\x18", "Enter": b"\r", "End": b"\x1b[F", "Home": b"\x1b[H", "Tab": b"\t", "Shift+Tab": b"\x1b[Z",
    "Space": b" ",
}  # fmt: skip
"""What an xterm sends."""
_ESCAPE = re.compile(rb"\x1b\[[0-?]*[ -/]*[@-~]|\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)|\x1b[PX^_].*?\x1b\\|\x1b.", re.DOTALL)
BETWEEN_S = 0.15
"""Time between two keys of a practised operator, s."""
READ_AT_ONCE = 65_536


class Terminal:
    """A pseudo-terminal of ``size`` columns and rows. Unread output stays in it until it is full."""

    def __init__(self, seat: Seat, words: Sequence[str], size: tuple[int, int] = (120, 40)) -> None:
        """Start `tester WORDS` in it, and read from the start."""
        self._end, child = os.openpty()
        fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
        self.began_s = clock.monotonic()
        try:
            self.process = subprocess.Popen(
                [*installed(), *words], cwd=seat.folder, env=seat.environment, stdin=child, stdout=child, stderr=child,
                start_new_session=True,
            )  # fmt: skip
        finally:
            os.close(child)
        self._drawn = bytearray()
        self._loop = asyncio.get_running_loop()
        self.reading(on=True)

    def reading(self, *, on: bool) -> None:
        """Start reading its output, or stop."""
        if on:
            self._loop.add_reader(self._end, self._read)
        else:
            self._loop.remove_reader(self._end)

    def _read(self) -> None:
        try:
            data = os.read(self._end, READ_AT_ONCE)
        except OSError:  # its program has ended (EIO)
            data = b""
        if not data:
            self._loop.remove_reader(self._end)
        self._drawn += data

    @property
    def text(self) -> str:
        """Return everything drawn since ``forget``, in drawing order, without colours and positions."""
        return strip(bytes(self._drawn))

    def forget(self) -> None:
        """Forget everything drawn so far."""
        self._drawn.clear()

    async def until(self, text: str, within_s: float = 30.0) -> float:
        """Wait until a text is drawn and return the time; raises NotSeenError."""
        end_s = clock.monotonic() + within_s
        while text not in self.text:
            if clock.monotonic() > end_s:
                raise NotSeenError(f"{text!r} is not drawn within {within_s:g} s: {self.text[-800:]!r}")
            await asyncio.sleep(LOOK_S)
        return clock.monotonic()

    def key(self, name: str) -> float:
        """Press a key and return the time."""
        pressed_s = clock.monotonic()
        os.write(self._end, KEYS[name])
        return pressed_s

    async def press(self, *names: str) -> None:
        """Press keys one after the other, as a person does."""
        for name in names:
            self.key(name)
            await asyncio.sleep(BETWEEN_S)

    def close(self) -> None:
        """Kill its program (SIGKILL), and close it."""
        self.process.kill()
        self.process.wait()
        self.reading(on=False)
        os.close(self._end)


def strip(drawn: bytes) -> str:
    """Return the output as text, without escape sequences (ECMA-48)."""
    return _ESCAPE.sub(b"", drawn).decode(errors="replace")


async def start_mine(screen: Terminal) -> None:
    """Start recipes/mine.yaml with automatic answers: the first of the list, already checked."""
    await screen.press("F2", "Home", "Enter")
    await screen.until("Start a run")
    await screen.press("Shift+Tab", "Space", "Tab")
    await screen.until("itself: yes")
    await screen.press("Enter")
