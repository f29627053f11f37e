"""Addition to python-can's slcan client: it reads more than one character at a time.

Measured with python-can 4.6.1: the client fetches every character with its own ``select`` and ``read``, and wakes up
each millisecond without data. So a scan's answers from five drives cost its thread 270 system calls, and each time
the interpreter's lock, which the controlling thread then holds. Here the client's serial port is replaced by one that
fetches all available characters at once and returns them one by one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import can
    from serial import Serial

INTERFACE = "slcan"
WAIT_S = 0.05
"""Time that the client sleeps for a character before it checks its own time-out, s."""
_PORT = "serialPortOrig"


def settings() -> dict[str, float]:
    """Return the arguments for opening the client, besides channel and bit rate."""
    return {"timeout": WAIT_S}


def tune(bus: can.BusABC) -> None:
    """Make a client read in one piece; other buses, and a client that keeps its port elsewhere, stay as they are."""
    port = getattr(bus, _PORT, None)
    if port is not None:
        setattr(bus, _PORT, _InPieces(port))


class _InPieces:
    """A serial port whose characters are fetched together; everything else is delegated to the port."""

    def __init__(self, port: Serial) -> None:
        self._port = port
        self._fetched = b""
        self._at = 0

    @property
    def in_waiting(self) -> int:
        """Number of characters that ``read`` returns without waiting: those already fetched, else those at the port."""
        return len(self._fetched) - self._at or self._port.in_waiting

    def read(self, size: int = 1) -> bytes:
        """Return up to ``size`` characters; waits, as the port does, only where none are there."""
        if self._at >= len(self._fetched):
            first = self._port.read(1)
            self._fetched = first + self._port.read(self._port.in_waiting) if first else b""
            self._at = 0
        piece = self._fetched[self._at : self._at + size]
        self._at += len(piece)
        return piece

    def reset_input_buffer(self) -> None:
        """Drop the fetched and the waiting characters."""
        self._fetched, self._at = b"", 0
        self._port.reset_input_buffer()

    def write(self, data: bytes) -> int | None:
        """Send bytes."""
        return self._port.write(data)

    def flush(self) -> None:
        """Return at once: the port sends by itself, and waiting for the last bit would delay a scan."""

    @property
    def write_timeout(self) -> float | None:
        """Write time-out of the port, s."""
        return self._port.write_timeout

    @write_timeout.setter
    def write_timeout(self, seconds: float | None) -> None:
        self._port.write_timeout = seconds

    def __getattr__(self, name: str) -> Any:
        """Return the port's own attribute."""
        return getattr(self._port, name)
