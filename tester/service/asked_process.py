"""A process that answers questions one at a time, so that its owner never computes: both ends of the link.

Request and answer are a length (4 bytes, big endian) and JSON; the first message is the process's settings. Answer: the
letter ``a`` and the result, or ``r`` and the reason of a refusal.
"""

from __future__ import annotations

import asyncio
import socket
import subprocess
from collections.abc import Callable
from contextlib import suppress
from struct import Struct

from pydantic import JsonValue
from pydantic_core import from_json, to_json

from tester.service.child_process import spawn

LENGTH = Struct(">I")
NICE = 10
"""Lower priority than everything that has to do with the rig."""


class RefusedQuestionError(Exception):
    """A question cannot be answered; the message gives the reason, for people."""


def answer_all(link: socket.socket, begin: Callable[[JsonValue], Callable[[JsonValue], JsonValue]]) -> None:
    """Answer until the owner ends. ``begin`` receives the settings and returns what answers a request; that may raise
    RefusedQuestionError.
    """
    first = _received(link)
    if first is None:
        return
    answer = begin(from_json(first))
    while (request := _received(link)) is not None:
        try:
            reply = b"a" + to_json(answer(from_json(request)), inf_nan_mode="null")
        except RefusedQuestionError as error:
            reply = b"r" + str(error).encode()
        link.sendall(LENGTH.pack(len(reply)) + reply)


def _received(link: socket.socket) -> bytes | None:
    """Return the next message; None once the owner has ended."""
    head = _exactly(link, LENGTH.size)
    return _exactly(link, LENGTH.unpack(head)[0]) if head is not None else None


def _exactly(link: socket.socket, size: int) -> bytes | None:
    data = bytearray()
    while len(data) < size:
        more = link.recv(min(size - len(data), 1 << 20))
        if not more:
            return None
        data += more
    return bytes(data)


class AskedProcess:
    """The owner's end. The process starts with the first question, and anew after a death."""

    def __init__(self, module: str, settings: JsonValue, within_s: float) -> None:
        """``module``: run as ``python -m module LINK``; ``settings``: its first message; ``within_s``: time for an
        answer, s.
        """
        self._module, self._settings, self._within_s = module, settings, within_s
        self._lock = asyncio.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def ask(self, request: JsonValue) -> bytes:
        """Return the answer as JSON. Raises RefusedQuestionError, TimeoutError."""
        async with self._lock:
            return await self._asked(to_json(request))

    async def warm(self) -> None:
        """Start the process in advance. A failure shows with the first question."""
        async with self._lock:
            if self._streams is None:
                with suppress(OSError):
                    await self._start()

    async def _asked(self, request: bytes) -> bytes:
        try:
            async with asyncio.timeout(self._within_s):
                reader, writer = self._streams or await self._start()
                writer.write(LENGTH.pack(len(request)) + request)
                await writer.drain()
                (size,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
                reply = await reader.readexactly(size)
        except (OSError, EOFError) as error:
            self.close()
            if isinstance(error, TimeoutError):  # an OSError too
                raise
            raise RefusedQuestionError("the process that reads stored runs has ended: ask again") from error
        except asyncio.CancelledError:
            self.close()  # its answer would be taken for that to the next question
            raise
        if reply[:1] != b"a":
            raise RefusedQuestionError(reply[1:].decode(errors="replace"))
        return reply[1:]

    async def _start(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        self._process, link = await asyncio.to_thread(spawn, self._module, ())
        self._streams = await asyncio.open_connection(sock=link)
        first = to_json(self._settings)
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
