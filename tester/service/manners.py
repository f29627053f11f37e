"""Limits for the gateway's clients: message rate, number of clients, lines in the log."""

from __future__ import annotations

import asyncio
import logging
import sys
from collections.abc import Callable
from typing import cast

from websockets.asyncio.server import ServerConnection

from tester.base import clock

MOST_CLIENTS = 32
"""Greatest number of clients that have joined."""
MOST_STRANGERS = 64
"""Greatest number of connections that have not joined; above it, the oldest is closed."""
MESSAGES_PER_S = 50.0
"""Sustained rate of a client's messages [A]: a person who holds a key down makes 30."""
MESSAGES_AT_ONCE = 100.0
"""Greatest number of messages in a burst: a screen that opens requests every recipe's check."""
BYTES_PER_MESSAGE = 8192
"""Size that counts as one message; a longer message counts as several."""
LINES_PER_MINUTE = 10
"""Greatest number of log lines for one kind of trouble; further lines are counted."""


class Bucket:
    """A client's allowance of messages. It refills with time; a client that has used it up must wait."""

    def __init__(self, now: Callable[[], float] = clock.monotonic) -> None:
        """Begin with a full allowance. ``now`` returns seconds."""
        self._now = now
        self._left = MESSAGES_AT_ONCE
        self._at_s = now()

    def spend(self, size: int) -> float:
        """Charge a message of ``size`` bytes; return how long to wait before reading the next, s."""
        now = self._now()
        self._left = min(self._left + (now - self._at_s) * MESSAGES_PER_S, MESSAGES_AT_ONCE)
        self._at_s = now
        self._left -= 1.0 + size / BYTES_PER_MESSAGE
        return max(-self._left / MESSAGES_PER_S, 0.0)


class Strangers:
    """Connections that have not joined yet, oldest first."""

    def __init__(self) -> None:
        """Begin empty."""
        self._there: dict[ServerConnection, asyncio.Transport] = {}

    def __len__(self) -> int:
        """Return the number of connections."""
        return len(self._there)

    def came(self, connection: ServerConnection, transport: asyncio.Transport) -> None:
        """Add a connection; close the oldest if there are too many."""
        self._there[connection] = transport
        if len(self._there) > MOST_STRANGERS:
            oldest = next(iter(self._there))
            self._there.pop(oldest).abort()

    def known(self, connection: ServerConnection) -> None:
        """Remove a connection that has joined or closed."""
        self._there.pop(connection, None)


def counted(strangers: Strangers) -> type[ServerConnection]:
    """Return a connection class that reports each connection to ``strangers`` as soon as it opens."""

    class CountedConnection(ServerConnection):
        """A connection that counts as not joined until it joins, so that the number of these is limited."""

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            strangers.came(self, cast("asyncio.Transport", transport))
            super().connection_made(transport)

        def connection_lost(self, exc: Exception | None) -> None:
            strangers.known(self)
            super().connection_lost(exc)

    return CountedConnection


class SparseLog(logging.Handler):
    """A log handler that writes one line for each error, without its trace, and a limited number of lines a minute."""

    def __init__(
        self, write: Callable[[str], object] | None = None, now: Callable[[], float] = clock.monotonic
    ) -> None:
        """``write`` writes a line, by default to standard error; ``now`` returns seconds."""
        super().__init__(logging.WARNING)
        self._write = write or sys.stderr.write
        self._now = now
        self._since_s = float("-inf")
        self._lines = self._left_out = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record, or only count it."""
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
    """Return a logger that writes only through a ``SparseLog``."""
    logger = logging.getLogger(name)
    logger.handlers[:] = [SparseLog()]
    logger.propagate = False
    return logger
