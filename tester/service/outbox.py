"""Pending messages to one client: all answers and events, and only the newest state, plan, results and queue."""

from __future__ import annotations

import asyncio
from collections import deque

MOST_BEHIND = 1000
"""Greatest number of events waiting for a client; one more disconnects it. A run makes some hundred an hour."""
MOST_REPLIES = 128
"""Greatest number of answers waiting for a client; one more disconnects it, because it does not read."""


class Outbox:
    """A queue that never blocks the sender and returns messages by urgency: answers, events, plan, results, queue,
    state.
    """

    def __init__(self) -> None:
        """Begin empty."""
        self._replies: deque[bytes] = deque()
        self._events: deque[bytes] = deque()
        self._newest: dict[str, bytes] = {}
        self._something = asyncio.Event()
        self.behind = 0
        """Number of waiting events or answers when the limit was exceeded; 0 while the client keeps up."""

    def __len__(self) -> int:
        """Return the number of waiting messages."""
        return len(self._replies) + len(self._events) + len(self._newest)

    def reply(self, message: bytes) -> None:
        """Queue an answer; drop it if too many answers wait."""
        if len(self._replies) >= MOST_REPLIES:
            self.behind = len(self._replies) + 1
        else:
            self._replies.append(message)
        self._something.set()

    def event(self, message: bytes) -> None:
        """Queue an event; drop it if too many events wait."""
        if len(self._events) >= MOST_BEHIND:
            self.behind = len(self._events) + 1
        else:
            self._events.append(message)
        self._something.set()

    def newest(self, kind: str, message: bytes) -> None:
        """Replace the waiting message of this kind."""
        self._newest[kind] = message
        self._something.set()

    async def next(self) -> bytes:
        """Wait for the next message and return it."""
        while True:
            if self._replies:
                return self._replies.popleft()
            if self._events:
                return self._events.popleft()
            for kind in ("plan", "results", "queue", "snapshot", "frames"):
                if kind in self._newest:
                    return self._newest.pop(kind)
            self._something.clear()
            await self._something.wait()
