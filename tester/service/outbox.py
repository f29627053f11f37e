"""What is on its way to one client: answers and events in full, of states and plans only the newest."""

from __future__ import annotations

import asyncio
from collections import deque

MOST_BEHIND = 1000
"""Events that may wait for a client; one more and it is disconnected. A run makes some hundred an hour."""
MOST_REPLIES = 128
"""Answers that may wait for a client; one more and it is disconnected: it does not read."""


class Outbox:
    """Takes without waiting, gives in order of urgency: answers, events, plan, state, frames."""

    def __init__(self) -> None:
        """Empty."""
        self._replies: deque[bytes] = deque()
        self._events: deque[bytes] = deque()
        self._newest: dict[str, bytes] = {}
        self._something = asyncio.Event()
        self.behind = 0
        """Events or answers that waited when there were too many; 0 while the client keeps up."""

    def __len__(self) -> int:
        """Return how many messages wait."""
        return len(self._replies) + len(self._events) + len(self._newest)

    def reply(self, message: bytes) -> None:
        """Queue an answer; a client that leaves too many unread gets none of them any more."""
        if len(self._replies) >= MOST_REPLIES:
            self.behind = len(self._replies) + 1
        else:
            self._replies.append(message)
        self._something.set()

    def event(self, message: bytes) -> None:
        """Queue an event; a client that is too far behind gets none of them any more."""
        if len(self._events) >= MOST_BEHIND:
            self.behind = len(self._events) + 1
        else:
            self._events.append(message)
        self._something.set()

    def newest(self, kind: str, message: bytes) -> None:
        """Put a message in the place of the one of its kind that still waits."""
        self._newest[kind] = message
        self._something.set()

    async def next(self) -> bytes:
        """Return what is to be sent next; wait for it."""
        while True:
            if self._replies:
                return self._replies.popleft()
            if self._events:
                return self._events.popleft()
            for kind in ("plan", "snapshot", "frames"):
                if kind in self._newest:
                    return self._newest.pop(kind)
            self._something.clear()
            await self._something.wait()
