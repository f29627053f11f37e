"""The process that reads stored runs for pages, ``python -m tester.page.data_process LINK``: it ends with its owner.

Request and answer are a length (4 bytes, big endian) and JSON. Request: ``{"query", "keys", "by"}``; the first one is
the folder of the runs. Answer: the letter ``a`` and the result, or ``r`` and the reason of a refusal.
"""

from __future__ import annotations

import socket
import sqlite3
from pathlib import Path
from struct import Struct

from pydantic import JsonValue
from pydantic_core import from_json, to_json

from tester.base.source import InvalidSource
from tester.base.trouble import TroubleError, in_words
from tester.page.stored.asked import answer
from tester.page.stored.run_cache import QuestionError, RunCache
from tester.service.child_process import link_to_owner

LENGTH = Struct(">I")
NICE = 10
"""Lower priority than everything that has to do with the rig, as for questions to the service."""


def serve(link: socket.socket) -> None:
    """Answer until the owner ends."""
    first = _received(link)
    if first is None:
        return
    cache = RunCache(Path(str(from_json(first))))
    while (request := _received(link)) is not None:
        reply = _answered(cache, from_json(request))
        link.sendall(LENGTH.pack(len(reply)) + reply)


def _answered(cache: RunCache, request: JsonValue) -> bytes:
    match request:
        case {"query": str(query), "keys": dict(keys), "by": str(by)}:
            pass
        case _:
            return b"rnot a request"
    try:
        return b"a" + to_json(answer(cache, query, keys, by), inf_nan_mode="null")
    except (QuestionError, TroubleError, InvalidSource, OSError, sqlite3.Error) as error:
        return b"r" + in_words(error).encode()


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


if __name__ == "__main__":
    serve(link_to_owner(NICE))
