"""A page process in front of a service without a rig, and browsers that speak to it over real sockets.

async with PageStage(folder) as stage:
    page = await stage.paired("control")
    answer = await page.command({"command": "hold"})
"""

from __future__ import annotations

import asyncio
import json
import socket
from contextlib import AsyncExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

from tester.page.desk_call import DeskView, NewCode, Revoke, ShowDesk, call_desk
from tester.page.page_process import PageOptions, host_page
from tester.page.roles import Role
from tests.tester.service.fake import FakeService

WITHIN_S = 60.0


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


class Browser:
    """One page: it keeps what arrives, by type."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.kept: list[dict[str, Any]] = []
        self._number = 0

    async def send(self, **message: Any) -> None:
        await self.connection.send(json.dumps(message))

    async def until(self, *types: str, number: int | None = None) -> dict[str, Any]:
        """Return the next message of these types (with this id)."""
        async with asyncio.timeout(WITHIN_S):
            while True:
                message: dict[str, Any] = json.loads(await self.connection.recv())
                self.kept.append(message)
                if message["type"] in types and number in (None, message.get("id")):
                    return message

    async def service(self, kind: str) -> dict[str, Any]:
        """Return the next message of the service of a type."""
        while True:
            message = (await self.until("service"))["message"]
            if message["type"] == kind:
                return dict(message)

    async def command(self, action: dict[str, Any], **further: Any) -> dict[str, Any]:
        self._number += 1
        await self.send(type="command", id=self._number, action=action, **further)
        return await self.until("accepted", "refused", number=self._number)

    async def ask(self, query: str, **further: Any) -> dict[str, Any]:
        self._number += 1
        await self.send(type="ask", id=self._number, query=query, **further)
        return await self.until("accepted", "refused", number=self._number)


class PageStage:
    """The page process, in this process, and its service."""

    def __init__(self, folder: Path, **options: Any) -> None:
        self.folder = folder
        self.port = free_port()
        self.fake = FakeService(folder)
        self.printed: list[str] = []
        self._options = options
        self._stack = AsyncExitStack()

    @property
    def origin(self) -> str:
        scheme = "https" if "certificate" in self._options else "http"
        return f"{scheme}://{self._options.get('lan', '127.0.0.1')}:{self.port}"

    async def __aenter__(self) -> PageStage:
        await self._stack.enter_async_context(self.fake)
        began = asyncio.Event()
        there = {"address": self.fake.address, "runs": self.folder / "runs", "warm": False}
        options = PageOptions(self.port, **there, **self._options)
        task = asyncio.create_task(host_page(options, self.printed.append, began))
        self._stack.push_async_callback(self._end, task)
        waiting = asyncio.create_task(began.wait())
        await asyncio.wait({task, waiting}, return_when=asyncio.FIRST_COMPLETED)
        if task.done():
            task.result()
        return self

    async def _end(self, task: asyncio.Task[None]) -> None:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._stack.aclose()

    async def desk(self, request: ShowDesk | NewCode | Revoke | None = None) -> DeskView:
        """The question of the machine's screen."""
        return await asyncio.to_thread(call_desk, self.fake.address, request or ShowDesk())

    async def browser(self, **options: Any) -> Browser:
        """Open a socket that is not paired."""
        options.setdefault("origin", self.origin)
        connection = await connect(f"ws://127.0.0.1:{self.port}/socket", max_size=None, compression=None, **options)
        return Browser(await self._stack.enter_async_context(connection))

    async def paired(self, role: Role, name: str = "Anna's phone") -> Browser:
        """Open a page and pair it."""
        code = (await self.desk(NewCode(role))).code
        assert code is not None
        page = await self.browser()
        await page.send(type="pair", code=code.digits, name=name)
        answer = await page.until("paired")
        assert answer["role"] == role
        return page

    async def secret(self, role: Role) -> str:
        page = await self.paired(role)
        return str(page.kept[0]["secret"])

    async def http(self, request: str) -> bytes:
        """Send bytes to the port; return the answer."""
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        writer.write(request.encode().replace(b"\n", b"\r\n"))
        answer = b""
        with suppress(ConnectionError):
            async with asyncio.timeout(WITHIN_S):
                answer = await reader.read()
        writer.close()
        return answer
