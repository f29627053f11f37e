"""`python -m tests.campaigns.page.crowd URL ORIGIN KIND WORDS...`: streaming pages, one that never reads, guessers.

``reads SECRET COUNT``: so many pages that read everything; ``frozen SECRET``: one that enters and stops reading;
``guesses N``: N wrong codes, one after the other from 20 sockets. Prints "there" once it has begun.
"""

from __future__ import annotations

import asyncio
import json
import sys
from contextlib import suppress

from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

SOCKETS = 20


async def reads(url: str, origin: str, secret: str) -> None:
    """Read everything that a page receives."""
    async with connect(url, origin=origin, max_size=None, compression=None) as page:  # type: ignore[arg-type]
        await page.send(json.dumps({"type": "enter", "secret": secret}))
        async for _ in page:
            pass


async def frozen(url: str, origin: str, secret: str) -> None:
    """Enter, then read nothing: the buffers fill, as with a hung browser."""
    async with connect(url, origin=origin, max_size=None, max_queue=1, ping_interval=None) as page:  # type: ignore[arg-type]
        await page.send(json.dumps({"type": "enter", "secret": secret}))
        await asyncio.sleep(3600.0)


async def guesses(url: str, origin: str, first: int, count: int) -> None:
    """Try codes one after the other."""
    for number in range(first, first + count):
        with suppress(OSError, InvalidHandshake, ConnectionClosed, TimeoutError):
            async with connect(url, origin=origin, compression=None) as page:  # type: ignore[arg-type]
                await page.send(json.dumps({"type": "pair", "code": f"{number:06d}", "name": "guess"}))
                await page.recv()


async def main(url: str, origin: str, kind: str, *words: str) -> None:
    """Run so many pages until the process ends, or all codes are tried."""
    if kind == "guesses":
        each = int(words[0]) // SOCKETS
        tasks = [guesses(url, origin, n * each, each) for n in range(SOCKETS)]
    elif kind == "frozen":
        tasks = [frozen(url, origin, words[0])]
    else:
        tasks = [reads(url, origin, words[0]) for _ in range(int(words[1]))]
    print("there", flush=True)
    await asyncio.gather(*tasks)


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
