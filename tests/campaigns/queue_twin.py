"""Random lives of a queue whose runs are real, for ``tests.campaigns.queue --twin``: `tester serve`, killed.

Each life has services that follow each other in one folder. A client adds, moves, skips, drops, starts and stops items,
and SIGKILL ends each service but the last at a random moment, runs included.
"""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
from collections import Counter
from contextlib import suppress
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from tester.base import clock
from tester.queue.items import ItemState
from tester.queue.places import queue_folder, run_recipe
from tester.queue.record import read_queue
from tester.queue.view import ItemView
from tester.run.kind_lookup import load_rig
from tester.service.client import Client, LostError, RefusedError
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueSkip, QueueStart, RigAction, Stop
from tester.store.run_folders import run_folders
from tester.store.run_reader import RunReader
from tests.campaigns.acceptance.figure import Figure, holds
from tests.campaigns.queue_life import fault_figures
from tests.campaigns.screens.seat import LOOK_S, Seat, installed
from tests.tester.kinds.wheel_on_belt.bench import SHORT

ITEMS = 5
"""Minimum number of items added in a life."""
KILLS_MOST = 4
KILL_WITHIN_S = 15.0
"""Maximum time from a service's first command to its kill: a run, or adding an item, takes seconds."""
QUIET_S = 1.0
"""Nothing may begin in a restarted service for this long."""
LIFE_S = 180.0
BEGIN_S = 30.0


class TwinLife:
    """A life in a folder of its own; afterwards ``misses`` has the faults, ``counts`` the events."""

    def __init__(self, folder: Path, random: Random) -> None:
        """Live in ``folder``."""
        self.seat = Seat(folder, folder)
        self.random = random
        self.misses: list[str] = []
        self.counts: Counter[str] = Counter()
        self._confirmed: set[int] = set()
        self._queue = queue_folder(self.seat.runs, load_rig("sim").name, simulated=True)

    def live(self) -> None:
        """Live to the end, and judge."""
        for _ in range(self.random.randint(1, KILLS_MOST)):
            asyncio.run(self._service(self.random.uniform(0.5, KILL_WITHIN_S), last=False))
            self.counts["kills"] += 1
        asyncio.run(self._service(LIFE_S, last=True))
        self._judge()

    async def _service(self, for_s: float, *, last: bool) -> None:
        """Run a service; kill it after a time, the last one when every item has ended."""
        with (self.seat.folder / "serve.log").open("ab") as log:
            process = subprocess.Popen(
                [*installed(), "serve", "--out", str(self.seat.runs)], cwd=self.seat.folder, env=self.seat.environment,
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
            )  # fmt: skip
        watching: asyncio.Task[None] | None = None
        try:
            observer = await self.seat.observer(process)
            await observer.client.close()
            client = await Client.connect(self.seat.address, name="campaign", control=True)
            watching = asyncio.create_task(self._watch(client))
            await self._begins_nothing(client)
            until_s = clock.monotonic() + for_s
            with suppress(LostError, TimeoutError):
                while clock.monotonic() < until_s and not (last and self._over(client)):
                    await self._act(client)
                    await asyncio.sleep(self.random.uniform(0.05, 0.8))
            self.counts["kills in a run"] += not last and self._runs_now(client)
            if last and not self._over(client):
                self.misses.append("the queue does not come to its end")
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            if watching is not None:
                await watching

    async def _watch(self, client: Client) -> None:
        """Check every state of the queue, and drop other messages."""
        with suppress(LostError):
            async for _ in client:
                queue = client.queue
                if queue is not None:
                    self.counts["states"] += 1
                    if not queue.state.strip():
                        self.misses.append(f"a wait without a reason: {queue}")

    async def _begins_nothing(self, client: Client) -> None:
        """After a restart nothing runs until a person starts the queue."""
        end_s = clock.monotonic() + BEGIN_S
        while client.queue is None and clock.monotonic() < end_s:
            await asyncio.sleep(LOOK_S)
        before, quiet_s = self._runs(), clock.monotonic() + QUIET_S
        while clock.monotonic() < quiet_s:
            queue = client.queue
            if queue is None or queue.going or self._runs_now(client):
                self.misses.append(f"starts without evidence: the queue goes by itself: {queue}")
                return
            await asyncio.sleep(LOOK_S)
        if self._runs() != before:
            self.misses.append("starts without evidence: a run began by itself")

    @staticmethod
    def _runs_now(client: Client) -> bool:
        return client.queue is not None and any(item.state.under_way for item in client.queue.items)

    def _over(self, client: Client) -> bool:
        queue = client.queue
        return (
            queue is not None and len(self._confirmed) >= ITEMS
            and all(item.state.over or item.state is ItemState.SKIPPED for item in queue.items)
        )  # fmt: skip

    async def _act(self, client: Client) -> None:
        """Send one command at random; a refusal is an answer."""
        queue = client.queue
        assert queue is not None
        kinds = {"add": 4.0 if len(self._confirmed) < ITEMS else 0.0, "move": 1.0, "skip": 0.2, "drop": 0.1,
                 "start": 0.0 if queue.going else 4.0, "stop": 0.15, "wait": 1.0}  # fmt: skip
        (kind,) = self.random.choices(list(kinds), list(kinds.values()))
        if kind == "wait":
            return
        action = self._action(kind, queue.revision, list(queue.listed))
        try:
            result = await client.command(action)
        except RefusedError as error:
            self.counts["refused"] += 1
            if not str(error).strip():
                self.misses.append(f"a refusal without a reason: {action}")
            return
        if isinstance(result, dict) and isinstance(number := result.get("id"), int):
            self._confirmed.add(number)

    def _action(self, kind: str, revision: int, listed: list[ItemView]) -> RigAction:
        random = self.random
        numbers = [item.id for item in listed] or [1]
        number = random.choice(numbers)
        load = random.choice(("100 N", "200 N"))
        match kind:
            case "add":
                return QueueAdd("short", text=SHORT.replace("200 N", load), seed=random.randrange(99), speed=None,
                                yes=True)  # fmt: skip
            case "move":
                return QueueMove(number, revision, random.choice([0, *numbers]))
            case "skip":
                return QueueSkip(number, revision)
            case "drop":
                return QueueDrop(number, revision)
            case "start":
                return QueueStart()
            case _:
                return Stop()

    # -- judging ------------------------------------------------------------------------------------------------

    def _runs(self) -> list[str]:
        return [run.name for run in run_folders(self.seat.runs)]

    def _judge(self) -> None:
        entries = {entry.item.id: entry for entry in read_queue(self._queue).entries}
        for number in sorted(self._confirmed - set(entries)):
            self.misses.append(f"item {number} is lost")
        ran: Counter[int] = Counter()
        for run in run_folders(self.seat.runs):
            with RunReader(run) as reader:
                source = Path(reader.run().info.recipe_source)
            if source.name != run_recipe(Path()).name:
                self.misses.append(f"a run of no item: {source}")
                continue
            ran[int(source.parts[-3])] += 1
        for number, times in ran.items():
            if times > 1:
                self.misses.append(f"item {number} ran twice")
            entry = entries.get(number)
            if entry is None or not entry.began_utc or entry.end is None:
                self.misses.append(f"starts without evidence: a run of item {number}, which is on record as {entry}")
        self.counts["items"] += len(entries)
        self.counts["runs"] += sum(ran.values())


def twin_lives(count: int) -> list[Figure]:
    """Return the figures of random lives on the twin."""
    misses: list[str] = []
    totals: Counter[str] = Counter()
    with TemporaryDirectory(prefix="queue-twin-", ignore_cleanup_errors=True) as folder:
        for seed in range(count):
            life = TwinLife(Path(folder) / str(seed), Random(seed))
            life.live()
            misses += [f"seed {seed}: {miss}" for miss in life.misses]
            totals += life.counts
    shown = ("items", "runs", "kills", "kills in a run", "refused", "states")
    words = ", ".join(f"{totals[name]:,} {name}" for name in shown)
    return [
        holds(f"{count} schedules on the twin, SIGKILL at random", totals["runs"] >= count, words, "runs in them"),
        *fault_figures(misses, "on the twin: "),
    ]
