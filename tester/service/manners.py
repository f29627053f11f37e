"""What the gateway allows its clients: a rate, a number of connections, lines in the log."""

from __future__ import annotations

import asyncio
import logging
import sys
from collections.abc import Callable

from websockets.asyncio.server import ServerConnection

from tester.base import clock

MOST_CLIENTS = 32
"""Clients that have joined, at most."""
MOST_STRANGERS = 64
"""Connections that have not joined yet, at most: one more, and the oldest of them is let go of."""
MESSAGES_PER_S = 50.0
"""What a client may say for long [A]: a person with a key held down makes 30."""
MESSAGES_AT_ONCE = 100.0
"""... and at once: a screen that opens asks for every recipe's check."""
BYTES_PER_MESSAGE = 8192
"""A longer message counts as several."""
LINES_PER_MINUTE = 10
"""Lines of one kind of trouble that the log gets; the rest is counted."""


class Bucket:
    """A client's allowance: it fills with time; who has spent it is made to wait."""

    def __init__(self, now: Callable[[], float] = clock.monotonic) -> None:
        """Full. ``now``: seconds."""
        self._now = now
        self._left = MESSAGES_AT_ONCE
        self._at_s = now()

    def spend(self, size: int) -> float:
        """Pay for a message of so many bytes; return how long to wait before the next is read, s."""
        now = self._now()
        self._left = min(self._left + (now - self._at_s) * MESSAGES_PER_S, MESSAGES_AT_ONCE)
        self._at_s = now
        self._left -= 1.0 + size / BYTES_PER_MESSAGE
        return max(-self._left / MESSAGES_PER_S, 0.0)


class Strangers:
    """Connections that have not said yet who they are, oldest first."""

    def __init__(self) -> None:
        """Nobody is there."""
        self._there: dict[ServerConnection, asyncio.Transport] = {}

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._there)

    def came(self, connection: ServerConnection, transport: asyncio.Transport) -> None:
        """Take notice of one; where they are too many the oldest has to go."""
        self._there[connection] = transport
        if len(self._there) > MOST_STRANGERS:
            oldest = next(iter(self._there))
            self._there.pop(oldest).abort()

    def known(self, connection: ServerConnection) -> None:
        """It has joined, or is gone."""
        self._there.pop(connection, None)


class SparseLog(logging.Handler):
    """Writes a line for trouble, without its trace, and no more than some a minute."""

    def __init__(
        self, write: Callable[[str], object] | None = None, now: Callable[[], float] = clock.monotonic
    ) -> None:
        """``write``: takes a line, by default standard error; ``now``: seconds."""
        super().__init__(logging.WARNING)
        self._write = write or sys.stderr.write
        self._now = now
        self._since_s = float("-inf")
        self._lines = self._left_out = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Write it, or count it."""
        now = self._now()
        if now - self._since_s >= 60.0:
            if self._left_out:
                self._write(f"{self._left_out} more lines like these were left out\n")
            self._since_s, self._lines, self._left_out = now, 0, 0
        if self._lines >= LINES_PER_MINUTE:
            self._left_out += 1
            return
        self._lines += 1
        cause = record.exc_info[1] if record.exc_info else None
        because = f": {type(cause).__name__}: {cause}" if cause is not None else ""
        self._write(f"{clock.utc_now()} {record.name}: {record.getMessage()}{because}"[:500].replace("\n", " ") + "\n")


def sparse_logger(name: str) -> logging.Logger:
    """Return a logger that writes sparsely, and nowhere else."""
    logger = logging.getLogger(name)
    logger.handlers[:] = [SparseLog()]
    logger.propagate = False
    return logger
