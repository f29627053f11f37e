"""The page process's end of a process that reads stored runs: one question at a time, and a new process after a death.
"""

from __future__ import annotations

import asyncio
import subprocess
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from pydantic import JsonValue
from pydantic_core import to_json

from tester.page.data_process import LENGTH
from tester.page.reception import AskError
from tester.service.child_process import spawn

WITHIN_S = 120.0
"""Time for an answer, s [A]: the tables of a run of 1,000 conditions take 10 s."""
MOST_ASKED = 32
"""Questions that wait for this process; a further one is refused."""


class DataWorker:
    """Asks the process, which starts with the first question."""

    def __init__(self, runs: Path) -> None:
        """``runs``: folder of the stored runs."""
        self._runs = runs
        self._lock = asyncio.Lock()
        self._waiting = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def ask(self, query: str, keys: Mapping[str, JsonValue], by: str) -> bytes:
        """Return the answer as JSON. Raises AskError."""
        if self._waiting >= MOST_ASKED:
            raise AskError("too many questions at once: ask again later")
        self._waiting += 1
        try:
            async with self._lock:
                return await self._asked(to_json({"query": query, "keys": keys, "by": by}))
        finally:
            self._waiting -= 1

    async def warm(self) -> None:
        """Start the process in advance. A failure shows with the first question."""
        async with self._lock:
            if self._streams is None:
                with suppress(OSError):
                    await self._start()

    async def _asked(self, request: bytes) -> bytes:
        try:
            async with asyncio.timeout(WITHIN_S):
                reader, writer = self._streams or await self._start()
                writer.write(LENGTH.pack(len(request)) + request)
                await writer.drain()
                (size,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
                reply = await reader.readexactly(size)
        except (OSError, EOFError) as error:
            self.close()
            raise AskError("the process that reads stored runs has ended: ask again") from error
        except (TimeoutError, asyncio.CancelledError):
            self.close()  # its answer would be taken for that to the next question
            raise
        if reply[:1] != b"a":
            raise AskError(reply[1:].decode(errors="replace"))
        return reply[1:]

    async def _start(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        self._process, link = await asyncio.to_thread(spawn, "tester.page.data_process", ())
        self._streams = await asyncio.open_connection(sock=link)
        first = to_json(str(self._runs))
        self._streams[1].write(LENGTH.pack(len(first)) + first)
        return self._streams

    def close(self) -> None:
        """End the process."""
        if self._streams is not None:
            self._streams[1].close()
            self._streams = None
        if self._process is not None:
            with suppress(ProcessLookupError):
                self._process.kill()
            self._process.wait()
            self._process = None
