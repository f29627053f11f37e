"""One page that has entered: its connection, its waiting messages, its ways to the service."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass, field

from pydantic import JsonValue
from websockets.asyncio.server import ServerConnection

from tester.page.pairing import Pairing
from tester.service.address import Address
from tester.service.client import Client
from tester.service.commands import Action
from tester.service.outbox import Outbox
from tester.service.stop_call import NotTakenError
from tester.service.stop_line import StopLine

UNANSWERED = 8
"""Greatest number of a page's commands and questions that may be worked on at a time."""


@dataclass(eq=False)
class Visitor:
    """A page. ``stop_line``: None for a role that may not stop."""

    connection: ServerConnection
    pairing: Pairing
    address: Address | None
    stop_line: StopLine | None = None
    outbox: Outbox = field(default_factory=Outbox)
    seen: int = 0
    """Number of the last event that was queued for this page."""
    leaving: asyncio.Task[None] | None = None
    _client: Client | None = None
    _working: set[asyncio.Task[None]] = field(default_factory=set[asyncio.Task[None]])
    _lock: asyncio.Lock = field(default_factory=asyncio.Lock)

    @property
    def busy(self) -> bool:
        """Whether as many of its messages are worked on as may be."""
        return len(self._working) >= UNANSWERED

    def start(self, task: asyncio.Task[None]) -> None:
        """Keep a task until it ends."""
        self._working.add(task)
        task.add_done_callback(self._working.discard)

    async def stop(self, *, fast: bool) -> str:
        """Send STOP to its door; return "" once it is taken, else the reason why it is not."""
        line = self.stop_line
        if line is None:
            return f"STOP needs the role stop, and this page has {self.pairing.role}"
        line.press(fast=fast)
        sent = line.take()
        assert sent is not None  # it was pressed in this thread
        try:
            await asyncio.wrap_future(sent)
        except NotTakenError as error:
            return f"STOP has not arrived: {error}: use the machine's stop"
        return ""

    async def command(self, action: Action) -> JsonValue:
        """Send a command under the page's name and return its result.

        Its own connection opens with the first command: the service's rules on who controls are then those for any
        client. Raises NoServiceError, RefusedError, LostError, TimeoutError.
        """
        async with self._lock:
            if self._client is None or self._client.lost:
                client = await Client.connect(self.address, name=self.pairing.recorded, control=True)
                self._client = client
                drain = asyncio.create_task(self._drain(client))
                self._working.add(drain)  # until the connection ends
                drain.add_done_callback(self._working.discard)
        return await self._client.command(action)

    async def once(self, action: Action) -> JsonValue:
        """Send a command that needs no control under the page's name, over a connection of its own; return its result.

        Raises as ``command`` does.
        """
        async with await Client.connect(self.address, name=self.pairing.recorded) as client:
            return await client.command(action)

    async def _drain(self, client: Client) -> None:
        """Read what this connection receives; the hub's link shows it."""
        async for _ in client:
            pass

    async def close(self) -> None:
        """End what it began."""
        if self.stop_line is not None:
            self.stop_line.close()
        if self._client is not None:
            with suppress(OSError):
                await self._client.close()
        for task in list(self._working):
            task.cancel()
