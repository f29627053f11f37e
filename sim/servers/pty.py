"""Pseudo-terminals: serial ports that end in this process. POSIX has them, Windows does not."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

MOST_UNSENT = 16 * 1024
"""Bytes kept for a program that does not read; beyond them new bytes are dropped, as by an adapter [A]."""
_CHUNK = 4096
NONE_HERE = "this system has no pseudo-terminals (Windows): use the TCP doors, or a pair of virtual serial ports"


class Pty:
    """The far end of a serial port; ``name`` is the device that a program opens.

    It never blocks. The near end is kept open here: settings survive when a program leaves. Its leaving is
    not noticed, just as an adapter does not notice it. ``dropped`` counts bytes that were not fetched.
    """

    def __init__(self, baud: int, link: Path | None = None) -> None:
        """Open one, raw, its near end set to ``baud`` bit/s until a program sets it; ``link``: path of a link to it.

        Raises OSError if there are no pseudo-terminals, or if the link cannot be made.
        """
        if sys.platform == "win32":
            raise OSError(NONE_HERE)
        import tty

        self._far, self._near = os.openpty()
        self._link: Path | None = None
        self.device = os.ttyname(self._near)
        self.name = self.device
        self.dropped = 0
        self._unsent = bytearray()
        tty.setraw(self._near)
        self._set_baud(baud)
        os.set_blocking(self._far, False)
        if link is not None:
            try:
                _point(link, self.device)
            except OSError:
                self.close()
                raise
            self._link, self.name = link, str(link)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._far

    @property
    def baud(self) -> int:
        """Baud rate set by the program, bit/s; 0 for a rate without a constant."""
        if sys.platform == "win32":
            return 0
        import termios

        return _rates().get(termios.tcgetattr(self._near)[5], 0)

    def read(self) -> bytes:
        """Return the program's bytes, b"" for none."""
        try:
            return os.read(self._far, _CHUNK)
        except OSError:
            return b""

    def write(self, data: bytes | bytearray) -> None:
        """Send bytes to the program, now or with a later call."""
        if len(self._unsent) + len(data) > MOST_UNSENT:
            self.dropped += len(data)
        else:
            self._unsent += data
        if not self._unsent:
            return
        try:
            sent = os.write(self._far, self._unsent)
        except OSError:  # full: no program reads
            return
        del self._unsent[:sent]

    def forget(self) -> None:
        """Drop the bytes that were not sent."""
        self._unsent.clear()

    def close(self) -> None:
        """Close both ends and remove the link."""
        os.close(self._far)
        os.close(self._near)
        if self._link is not None:
            with suppress(OSError):
                if str(self._link.readlink()) == self.device:
                    self._link.unlink()

    def _set_baud(self, baud: int) -> None:
        if sys.platform == "win32":
            return
        import termios

        settings = termios.tcgetattr(self._near)
        constant = next((number for number, rate in _rates().items() if rate == baud), None)
        if constant is not None:
            settings[4] = settings[5] = constant
            termios.tcsetattr(self._near, termios.TCSANOW, settings)


def _rates() -> dict[int, int]:
    """Return the rates of this system in bit/s, by their constants."""
    import termios

    return {getattr(termios, name): int(name[1:]) for name in dir(termios) if name[:1] == "B" and name[1:].isdigit()}


def _point(link: Path, device: str) -> None:
    """Point ``link`` at ``device``; a link of an earlier process is replaced, any other file is not."""
    link.parent.mkdir(parents=True, exist_ok=True)
    if link.is_symlink():
        link.unlink()
    link.symlink_to(device)
