"""The service on the simulated rig and the page's process, as a user starts them: two processes, real sockets."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import threading
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from tester.base import clock
from tester.page.desk_call import NewCode, NoPageError, call_desk
from tester.page.roles import Role
from tester.service.address import UnixAddress
from tester.service.client import Client, NoServiceError
from tester.service.commands import RunRecipe
from tester.service.protocol import Snapshot
from tests.tester.page.stage import free_port

CODE = "from tester.cli.main import main; main()"
WITHIN_S = 60.0
T = TypeVar("T")


def beside(work: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine in another thread: the browser's driver keeps this one's event loop."""
    with ThreadPoolExecutor(1) as threads:
        return threads.submit(asyncio.run, work).result(4 * WITHIN_S)


class Whole:
    """Both processes. ``stopped_at`` and similar methods ask the service through their own client."""

    def __init__(self, folder: Path) -> None:
        """``folder`` gets the sockets and the runs."""
        self.runs = folder / "runs"
        self.address = UnixAddress(folder / "service.sock")
        self.port = free_port()
        self.processes: list[subprocess.Popen[bytes]] = []

    @property
    def origin(self) -> str:
        """The page's address."""
        return f"http://127.0.0.1:{self.port}"

    def begin(self) -> None:
        """Start the service, then the page."""
        self._start("serve", "--connect", str(self.address))
        self.until(self._served)
        self._start("page", "--connect", str(self.address), "--port", str(self.port))
        self.until(self._paged)

    def _start(self, *words: str) -> None:
        command = [sys.executable, "-P", "-c", CODE, *words, "--out", str(self.runs)]
        self.processes.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL))

    def until(self, true: Callable[[], bool]) -> None:
        """Wait until a function returns something true."""
        end_s = clock.monotonic() + WITHIN_S
        while not true():
            assert clock.monotonic() < end_s, "not in time"
            assert all(process.poll() is None for process in self.processes), "a process has ended"
            threading.Event().wait(0.05)

    def _served(self) -> bool:
        try:
            self.mode()
        except NoServiceError:
            return False
        return True

    def _paged(self) -> bool:
        try:
            call_desk(self.address, NewCode("look"))
        except NoPageError:
            return False
        return True

    def code(self, role: Role) -> str:
        """Return a new code for a role."""
        code = call_desk(self.address, NewCode(role)).code
        assert code is not None
        return code.digits

    def mode(self) -> tuple[str, str]:
        """Return the service's mode and the outcome of its run."""

        async def ask() -> tuple[str, str]:
            async with await Client.connect(self.address, name="watch") as client:
                run = client.state.run
                return client.state.mode, run.outcome if run is not None else ""

        return beside(ask())

    def run(self, recipe: str = "quickstart", speed: float | None = None, *, to_end: bool = False) -> None:
        """Start a run; wait until it is under way, or to its end."""

        async def work() -> None:
            async with await Client.connect(self.address, name="starter", control=True) as client:
                await client.command(RunRecipe(recipe, seed=1, speed=speed, yes=True), within_s=WITHIN_S)
                begun = False
                async for message in client:
                    if isinstance(message, Snapshot):
                        begun = begun or message.state.mode == "RUN"
                        if begun and (not to_end or message.state.mode == "OFFLINE"):
                            return

        beside(work())

    def end(self) -> None:
        """End both."""
        for process in reversed(self.processes):
            process.terminate()
        for process in reversed(self.processes):
            process.wait(WITHIN_S)


@contextmanager
def whole(folder: Path) -> Iterator[Whole]:
    """Serve a simulated rig and its page."""
    both = Whole(folder)
    try:
        both.begin()
        yield both
    finally:
        both.end()
