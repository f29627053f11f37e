"""A place to work at: a folder with recipes, a service of its own, and the installed command `tester`."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from tester.base import clock
from tester.base.who import who_here
from tester.service.address import UnixAddress
from tester.service.client import Client, LostError, NoServiceError
from tester.service.commands import Stop
from tester.service.protocol import Event
from tester.service.state_view import StateView
from tester.tui.host import ROLE
from tests.campaigns.acceptance.bench import COMMAND, ROOT

SCREEN = who_here(ROLE)
"""The service's name for a screen opened here."""
LOOK_S = 0.005
"""Polling interval of a wait, s."""
END_S = 30.0
"""A service ends within this time, s: it comes to a standstill first."""
SLIDING_MM_S, LOADED_N = 50.0, 50.0


class NotSeenError(Exception):
    """Timed out: the message gives the awaited event, and the last state."""


def installed() -> list[str]:
    """Return the command installed beside this Python; without one, an equivalent."""
    script = Path(sys.executable).with_name("tester.exe" if os.name == "nt" else "tester")
    return [str(script)] if script.exists() else [sys.executable, "-c", COMMAND]


class Seat:
    """One folder, one service, any number of screens."""

    def __init__(self, folder: Path, captures: Path, recipe: str = "") -> None:
        """``recipe``: text of recipes/mine.yaml, if there is to be one; ``captures``: where pictures go."""
        self.folder, self.captures, self.runs = folder, captures, folder / "runs"
        self.runtime = folder / "rt"
        self.runtime.mkdir(parents=True, mode=0o700)
        self.address = UnixAddress(self.runtime / "service.sock")
        self.recipe = folder / "recipes" / "mine.yaml"
        if recipe:
            self.recipe.parent.mkdir()
            self.recipe.write_text(recipe, encoding="utf-8")
        hidden = ("NO_COLOR", "COLUMNS", "LINES", "TMUX", "VISUAL")
        self.environment = {name: value for name, value in os.environ.items() if name not in hidden}
        self.environment |= {
            "TESTER_RUNTIME_DIR": str(self.runtime), "TERM": "xterm-256color", "COLORTERM": "truecolor",
            "PYTHONPATH": os.pathsep.join((str(ROOT), os.environ.get("PYTHONPATH", ""))),
        }  # fmt: skip

    def tester(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run `tester WORDS` and return its result."""
        return subprocess.run(
            [*installed(), *words], cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False,
            stdin=subprocess.DEVNULL,
        )  # fmt: skip

    @asynccontextmanager
    async def service(self, *words: str) -> AsyncIterator[Observer]:
        """Give a viewer of `tester serve WORDS`, which ends with the block."""
        with (self.folder / "serve.log").open("ab") as log:
            process = subprocess.Popen(
                [*installed(), "serve", "--out", str(self.runs), *words], cwd=self.folder, env=self.environment,
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
            )  # fmt: skip
        try:
            async with await self.observer(process) as seen:
                yield seen
        finally:
            process.terminate()
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def end_services(self) -> None:
        """End the processes that a screen started here: `tester serve` with runs in this seat's folder."""
        listed = subprocess.run(["ps", "-ewwo", "pid=,args="], capture_output=True, text=True, check=True).stdout
        for line in listed.splitlines():
            if " serve " in line and str(self.runs) in line:
                with suppress(ProcessLookupError):
                    os.kill(int(line.split()[0]), signal.SIGTERM)

    async def observer(self, process: subprocess.Popen[bytes] | None = None) -> Observer:
        """Connect to the service once it exists; raises NotSeenError."""
        end_s = clock.monotonic() + 30.0
        while clock.monotonic() < end_s and (process is None or process.poll() is None):
            try:
                client = await Client.connect(self.address, name="observer")
            except NoServiceError:
                await asyncio.sleep(LOOK_S)
            else:
                return Observer(client, process.pid if process is not None else 0)
        raise NotSeenError(f"no service: {(self.folder / 'serve.log').read_text(encoding='utf-8')[-500:]}")


class Observer:
    """A viewer of the service that records the time of each event. ``pid``: the service's process."""

    def __init__(self, client: Client, pid: int) -> None:
        """Listen from now on."""
        self.client, self.pid = client, pid
        self.events_at: list[tuple[float, Event]] = []
        """With their times (tester.base.clock.monotonic)."""
        self._listening = asyncio.create_task(self._listen())

    async def __aenter__(self) -> Observer:
        """Return itself."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Stop the run, and disconnect."""
        with suppress(LostError, TimeoutError):
            await self.client.command(Stop(fast=True))
        await self.client.close()
        await self._listening

    async def _listen(self) -> None:
        async for message in self.client:
            if isinstance(message, Event):
                self.events_at.append((clock.monotonic(), message))

    @property
    def state(self) -> StateView:
        """Return the newest state."""
        return self.client.state

    async def until(self, true: Callable[[StateView], bool], what: str, within_s: float = 60.0) -> None:
        """Wait for a state; raises NotSeenError."""
        end_s = clock.monotonic() + within_s
        while not true(self.state):
            if clock.monotonic() > end_s or self.client.lost:
                state = self.state
                raise NotSeenError(f"{what}: not within {within_s:g} s; {state.mode}: {state.mode_text} {state.run}")
            await asyncio.sleep(LOOK_S)

    async def event(self, true: Callable[[Event], bool], after_s: float, what: str, within_s: float = 5.0) -> float:
        """Wait for an event after a moment and return its time; raises NotSeenError."""
        end_s = clock.monotonic() + within_s
        while clock.monotonic() < end_s:
            for came_s, event in self.events_at:
                if came_s >= after_s and true(event):
                    return came_s
            await asyncio.sleep(LOOK_S / 5)
        raise NotSeenError(f"{what}: not within {within_s:g} s")

    async def stop_by_screen(self, after_s: float, what: str) -> float:
        """Wait for the STOP of a screen of this place and return its time; raises NotSeenError."""
        return await self.event(lambda event: event.text.startswith(f"stop by {SCREEN}"), after_s, what)

    async def controlled(self) -> None:
        """Wait until a screen is connected and has control."""
        await self.until(lambda state: state.clients.controller == SCREEN, "a screen that controls")

    async def sliding(self) -> None:
        """Wait until the wheel slides under load."""
        await self.until(slides, "sliding under load", 180.0)


class Noise:
    """The wake-up lateness of this otherwise idle process: the machine adds it to every figure of time."""

    def __init__(self) -> None:
        """Watch from now on."""
        self.late_s: list[float] = []
        self._watching = asyncio.create_task(self._watch())

    async def _watch(self) -> None:
        while True:
            due_s = clock.monotonic() + LOOK_S
            await asyncio.sleep(LOOK_S)
            self.late_s.append(clock.monotonic() - due_s)

    def end(self) -> str:
        """Stop, and return the figures in words."""
        self._watching.cancel()
        ordered = sorted(self.late_s) or [0.0]
        rare, most = ordered[-1 - len(ordered) // 1000], ordered[-1]
        return f"{1e3 * median(ordered):.1f} ms, {1e3 * rare:.1f} ms, {1e3 * most:.1f} ms"


def slides(state: StateView) -> bool:
    """Return whether the wheel slides under load."""
    slip, load = state.value("slip"), state.value("load")
    return (
        state.mode == "RUN" and slip is not None and load is not None and slip.value is not None
        and load.value is not None and slip.value > SLIDING_MM_S and load.value > LOADED_N
    )  # fmt: skip


def median(values: Sequence[float]) -> float:
    """Return the median, NaN of none."""
    ordered = sorted(values)
    return ordered[len(ordered) // 2] if ordered else float("nan")
