"""A person's terminal: tmux, its keys, and pictures of what it shows."""

from __future__ import annotations

import asyncio
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from io import StringIO
from pathlib import Path

from rich.console import Console
from rich.text import Text

from tester.base import clock
from tests.campaigns.screens.seat import NotSeenError, Seat, installed

LARGE, SMALL = (120, 40), (80, 24)
BETWEEN_S = 0.3
"""A person's pace, s."""
SETTLE_S = 0.7
"""Time to draw a screen of another size, s."""
LOOK_S = 0.1


def available() -> bool:
    """Return whether tmux is installed."""
    return shutil.which("tmux") is not None


class Tmux:
    """A tmux server of its own with one window. ``captures``: where pictures go."""

    def __init__(self, seat: Seat, captures: Path) -> None:
        """Nothing is open yet."""
        self.seat, self.captures, self.count = seat, captures, 0
        self._socket = str(seat.folder / "tmux")

    def _do(self, *words: str) -> str:
        return subprocess.run(
            ["tmux", "-S", self._socket, "-f", "/dev/null", *words], cwd=self.seat.folder, env=self.seat.environment,
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip

    def open(self, words: Sequence[str]) -> None:
        """Start `tester WORDS` in a window of the large size."""
        command = shlex.join([*installed(), *words])
        width, height = map(str, LARGE)
        self._do("new-session", "-d", "-x", width, "-y", height, command, ";", "set", "-g", "status", "off")
        self._resize(LARGE)

    def _resize(self, size: tuple[int, int]) -> None:
        self._do("resize-window", "-x", str(size[0]), "-y", str(size[1]))

    async def press(self, *keys: str) -> None:
        """Press keys, by tmux's names."""
        for key in keys:
            self._do("send-keys", key)
            await asyncio.sleep(BETWEEN_S)

    @property
    def screen(self) -> str:
        """Return the text on the screen."""
        return self._do("capture-pane", "-p")

    async def see(self, text: str, within_s: float = 30.0) -> float:
        """Wait until a text is on the screen; return the duration, s; raises NotSeenError."""
        began_s = clock.monotonic()
        while text not in (seen := self.screen):
            if clock.monotonic() > began_s + within_s:
                raise NotSeenError(f"{text!r} is not seen within {within_s:g} s:\n{seen}")
            await asyncio.sleep(LOOK_S)
        return clock.monotonic() - began_s

    async def keep(self, name: str) -> None:
        """Keep pictures of the screen as it is, and of the same screen in a small terminal."""
        self.count += 1
        for size in (LARGE, SMALL):
            if size is SMALL:
                self._resize(size)
                await asyncio.sleep(SETTLE_S)
            file = self.captures / f"{self.count:02d}-{name.replace(' ', '-')}-{size[0]}x{size[1]}"
            draw(self._do("capture-pane", "-e", "-p"), file, size, name)
        self._resize(LARGE)
        await asyncio.sleep(SETTLE_S)

    def close(self) -> None:
        """End the server and its programs."""
        subprocess.run(["tmux", "-S", self._socket, "kill-server"], check=False, capture_output=True)


def draw(seen: str, file: Path, size: tuple[int, int], title: str) -> None:
    """Write a capture as it came (.ansi) and as a picture (.svg)."""
    file.with_suffix(".ansi").write_text(seen, encoding="utf-8")
    console = Console(width=size[0], height=size[1], record=True, file=StringIO(), force_terminal=True,
                      color_system="truecolor", legacy_windows=False)  # fmt: skip
    for line in Text.from_ansi(seen.rstrip("\n")).split("\n"):  # whole: a colour may continue on the next line
        console.print(line, no_wrap=True, overflow="crop", crop=True)
    console.save_svg(str(file.with_suffix(".svg")), title=title)
