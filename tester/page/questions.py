"""Answers questions of pages: about pairings here, about stored runs in processes of their own.

Two processes, so that making tables anew after an exclusion delays no zoom. A file to download is written by the
command of `tester` that writes it for people, in a process of its own.
"""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import tempfile
from collections.abc import Coroutine
from contextlib import suppress
from pathlib import Path
from typing import Final, NamedTuple

from pydantic import JsonValue
from pydantic_core import to_json

from tester.base.processes import tester_command
from tester.page.answers import Download, Tickets
from tester.page.data_worker import DataWorker
from tester.page.front import PageQuestion
from tester.page.pairing import Pairing, Pairings
from tester.page.reception import AskError
from tester.page.roles import includes
from tester.page.stored.asked import ASKED, PREPARE, WRITING
from tester.service.asked_process import NICE
from tester.store.run_folders import newest_run

WITHIN_S = 120.0
"""Time for writing a download, s [A]: a report of 165 conditions takes 20 s."""
MOST_BYTES = 64_000_000
"""Largest download: the report of a long campaign has 10 MB."""


class WrittenFile(NamedTuple):
    """A download: the command that writes it, its suffix and its content type."""

    command: tuple[str, ...]
    suffix: str
    kind: str


WRITTEN: Final = {
    "csv": WrittenFile(("export", "--format", "conditions"), ".csv", "text/csv; charset=utf-8"),
    "xlsx": WrittenFile(
        ("export", "--format", "xlsx"), ".xlsx", "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
    ),
    "report": WrittenFile(("report",), ".html", "text/html; charset=utf-8"),
}
"""Downloads by the word of the query ``ticket``; both commands take a run and ``--out``."""


class Questions:
    """Answers each question by its name."""

    def __init__(self, runs: Path, pairings: Pairings, tickets: Tickets) -> None:
        """``runs``: folder of the stored runs."""
        self._runs = runs
        self._pairings = pairings
        self._tickets = tickets
        self._reading, self._writing = DataWorker(runs), DataWorker(runs)
        self._downloads = asyncio.Semaphore(1)
        self._tasks: set[asyncio.Task[None]] = set()

    async def __aenter__(self) -> Questions:
        return self

    def warm(self) -> None:
        """Before the first question, start the reading process, which takes a second, and prepare the newest run there.

        A question about that run then finds it in memory; in another process, both would make it at the same time.
        """
        newest = newest_run(self._runs)
        self._start(self._prepared(self._reading, newest.name) if newest is not None else self._reading.warm())

    def prepare(self, run: str) -> None:
        """Make what the pictures of a run that is over need, without waiting."""
        self._start(self._prepared(self._writing, run))

    def _start(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _prepared(self, worker: DataWorker, run: str) -> None:
        with suppress(AskError, TimeoutError):  # the first picture then makes it
            await worker.answer(PREPARE, {"run": run}, "")

    async def __aexit__(self, *_: object) -> None:
        """End the processes."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._reading.close()
        self._writing.close()

    async def answer(self, pairing: Pairing, question: PageQuestion) -> bytes:
        """Return the answer as JSON. Raises AskError."""
        name = question.query
        if name == "pairings":
            return to_json({"pairings": self._listed()})
        if name == "ticket":
            return to_json({"path": self._tickets.issue(await self._download(question.rest))})
        if name not in ASKED or name == PREPARE:
            raise AskError(f"no question {name!r}")
        if name in WRITING and not includes(pairing.role, "control"):
            raise AskError(f"{name} needs the role control, and this page has {pairing.role}")
        worker = self._writing if name in WRITING else self._reading
        return await worker.answer(name, question.rest, pairing.recorded)

    def _listed(self) -> list[JsonValue]:
        return [
            {"number": one.number, "name": one.name, "role": one.role, "expires_utc": one.expires_utc}
            for one in self._pairings.listed()
        ]

    async def _download(self, keys: dict[str, JsonValue]) -> Download:
        match keys:
            case {"run": str(run), "what": str(what), **rest} if what in WRITTEN and not rest:
                written = WRITTEN[what]
            case _:
                raise AskError(f"expected run, and what: one of {', '.join(WRITTEN)}")
        if Path(run).name != run or run.startswith((".", "-")) or not (self._runs / run).is_dir():
            raise AskError(f"no run {run} under {self._runs}")
        async with self._downloads:
            with tempfile.TemporaryDirectory(prefix="tester-page-") as folder:
                file = Path(folder) / f"out{written.suffix}"
                await _written([*written.command, str(self._runs.absolute() / run), "--out", str(file)])
                body = await asyncio.to_thread(_read, file)
        name = re.sub(r"[^A-Za-z0-9.-]", "-", run)[:120]
        return Download(f"{name}{written.suffix}", written.kind, body)


def _read(file: Path) -> bytes:
    """Return a file's bytes. Raises AskError."""
    if not file.is_file() or file.stat().st_size > MOST_BYTES:
        raise AskError(f"the file is missing, or larger than {MOST_BYTES / 1e6:g} MB: use `tester export`")
    return file.read_bytes()


async def _written(arguments: list[str]) -> None:
    """Run `tester ARGUMENTS` at low priority. Raises AskError with its last words."""
    process = await asyncio.create_subprocess_exec(
        *tester_command(*arguments), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    try:
        with suppress(ProcessLookupError):  # it may be gone already
            if hasattr(os, "setpriority"):
                os.setpriority(os.PRIO_PROCESS, process.pid, NICE)
        async with asyncio.timeout(WITHIN_S):
            _, words = await process.communicate()
    finally:
        if process.returncode is None:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
    if process.returncode:
        raise AskError(words.decode(errors="replace").strip()[-500:] or f"exit code {process.returncode}")
