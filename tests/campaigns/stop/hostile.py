"""`python -m tests.campaigns.stop.hostile KIND FOLDER`: clients that try to keep STOP from the rig, until killed.

KIND: ``talkers`` (each command in a loop, a client each), ``takers`` (two that tear control away from each other and
from the operator), ``mutes`` (join, command, and never read), ``strangers`` (idle connections that never join,
connections that come and go), ``callers`` (the same at the door for STOP).
"""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path

from tester.service.address import UnixAddress, stop_path
from tester.service.client import Client, LostError, NoServiceError, RefusedError
from tester.service.commands import (
    Acknowledge,
    Action,
    Answer,
    Arm,
    CheckRecipe,
    Hold,
    Jog,
    ListRecipes,
    ListRuns,
    Release,
    ResumeRun,
    RunRecipe,
    ShowPlan,
    Stop,
    TakeControl,
    Tare,
    WatchFrames,
)

IDLE, COMING = 32, 600
COMMANDS: tuple[Callable[[int], Action], ...] = (
    lambda n: WatchFrames(on=bool(n % 2)),
    lambda n: TakeControl(take=bool(n % 2)),
    lambda n: CheckRecipe("quickstart"),
    lambda n: ShowPlan("table2"),
    lambda n: ListRecipes(),
    lambda n: ListRuns(),
    lambda n: RunRecipe("quickstart", text="x" * 200_000),
    lambda n: ResumeRun("none"),
    lambda n: Hold(),
    lambda n: Release(),
    lambda n: Acknowledge(),
    lambda n: Answer(1),
    lambda n: Arm(),
    lambda n: Jog("wheel", 1),
    lambda n: Tare(),
    lambda n: Stop(),
    lambda n: Stop(fast=True),
)
"""One client each."""
MUTES = 3
"""Together with the talkers: twenty."""
TAKERS = 2
"""In addition, in scenes that allow it: any client may take control by force, which ends manual mode."""
KINDS = ("talkers", "mutes", "strangers", "callers")
BY_FORCE = (*KINDS, "takers")


async def for_ever(work: Callable[[], Awaitable[None]]) -> None:
    """Do something repeatedly, ignoring failures."""
    while True:
        with suppress(OSError, LostError, NoServiceError, TimeoutError):
            await work()
        await asyncio.sleep(0)


async def talk(address: UnixAddress, make: Callable[[int], Action]) -> None:
    """Send one command in a loop, without waiting for the answers."""
    async with await Client.connect(address, name="hostile") as client:
        number = 0
        waiting: set[asyncio.Task[None]] = set()

        async def one(action: Action) -> None:
            with suppress(RefusedError, LostError, TimeoutError):
                await client.command(action)

        while not client.lost:
            number += 1
            task = asyncio.create_task(one(make(number)))
            waiting.add(task)
            task.add_done_callback(waiting.discard)
            await asyncio.sleep(0)
            if len(waiting) > 200:
                await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)


async def keep_mute(address: UnixAddress) -> None:
    """Send commands and read nothing."""
    client = await Client.connect(address, name="hostile mute")
    transport = client._connection.transport  # pyright: ignore[reportPrivateUsage]
    transport.pause_reading()
    try:
        for number in range(1_000_000):
            with suppress(TimeoutError, RefusedError):
                await client.command(WatchFrames(on=bool(number % 2)), within_s=0.001)
    finally:
        transport.abort()


async def idle(path: str) -> None:
    """Connect, and send nothing until the other side disconnects."""
    reader, writer = await asyncio.open_unix_connection(path)
    with suppress(OSError):
        await reader.read()
    writer.close()


async def come_and_go(path: str) -> None:
    """Connect, send half a message, and disconnect."""
    _, writer = await asyncio.open_unix_connection(path)
    writer.write(b"GET / HTTP/1.1\r\nHost: x\r\n")
    writer.close()


async def call(path: str) -> None:
    """Send STOP at its door in a loop."""
    reader, writer = await asyncio.open_unix_connection(path)
    while True:
        writer.write(b"stop hostile\n")
        if not await reader.readline():
            return


async def main(kind: str, folder: Path) -> None:
    """Run that kind of client until killed."""
    address = UnixAddress(folder / "service.sock")
    where = str(stop_path(address.path) if kind == "callers" else address.path)
    works: list[Callable[[], Awaitable[None]]] = []
    if kind == "talkers":
        works += [lambda make=make: talk(address, make) for make in COMMANDS]
    elif kind == "takers":
        works += [lambda: talk(address, lambda n: TakeControl(force=True))] * TAKERS
    elif kind == "mutes":
        works += [lambda: keep_mute(address)] * MUTES
    else:
        works += [lambda: idle(where)] * IDLE + [lambda: come_and_go(where)] * COMING
        if kind == "callers":
            works += [lambda: call(where)] * 4
    await asyncio.gather(*(for_ever(work) for work in works))


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], Path(sys.argv[2])))
