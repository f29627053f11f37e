"""A service under attack, the operator who uses it, and their files."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from array import array
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random

from tester.base import clock
from tester.service.address import UnixAddress
from tester.service.client import Client, NoServiceError
from tester.service.commands import TakeControl
from tester.service.gateway_process import NICE as GATEWAY_NICE
from tester.service.state_view import StateView
from tester.service.stop_call import NotTakenError, StopCall
from tests.campaigns.stop.hostile import KINDS
from tests.campaigns.stop.loop import PERIOD_S
from tests.campaigns.stop.owner import OPERATOR, PROBE, SCANS, STOPS

LOOK_S = 0.02
START_S = 180.0
"""Time limit for the service's start: on a busy machine it once took a minute."""
ROLLING = 500
"""Number of scans over which the difference between both clocks counts as constant."""


class NotReachedError(Exception):
    """The state to be measured was not reached; the message gives it, and the actual state."""


@dataclass(frozen=True, slots=True)
class Try:
    """One STOP: when it was sent, when it was in control, when the answer arrived (tester.base.clock.monotonic)."""

    sent_s: float
    control_s: float | None
    answered_s: float | None


NICE = 10
"""Niceness of hostile clients."""
LOOPS = tuple(f"loop{number}.txt" for number in range(4))
"""Output of the bare loops that wake like the owner.

A single loop would wake half as often as the scans it is compared with: the worst of few moments means little.
"""
NICED_LOOPS = ("niced.txt",)
"""Output of the loop that wakes like the gateway."""


def started(*words: str, nice: int = 0, mute: bool = False) -> subprocess.Popen[bytes]:
    """Run a module of this package; ``mute``: discard its error output."""
    before = ["nice", "-n", str(nice)] if nice else []
    errors = subprocess.DEVNULL if mute else None
    return subprocess.Popen([*before, sys.executable, "-m", *words], stdin=subprocess.DEVNULL, stderr=errors)


def ended(process: subprocess.Popen[bytes]) -> None:
    """End a process, at first in an orderly way."""
    process.terminate()
    try:
        process.wait(30.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


class Place:
    """One folder, one service, bare loops."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        """Start them; they end with ``stack``."""
        self.folder = folder
        self.address = UnixAddress(folder / "service.sock")
        self._owner = started("tests.campaigns.stop.owner", str(folder))
        stack.callback(ended, self._owner)
        for files, nice in ((LOOPS, 0), (NICED_LOOPS, GATEWAY_NICE)):
            for number, file in enumerate(files):
                phase_s = PERIOD_S * number / len(files)
                stack.callback(ended, started("tests.campaigns.stop.loop", str(folder / file), str(phase_s), nice=nice))
        self._probes = 0
        self._random = Random(7)

    async def operator(self) -> Client:
        """Connect once the service exists, and take control. Raises NotReachedError."""
        end_s = clock.monotonic() + START_S
        while clock.monotonic() < end_s:
            try:
                return await Client.connect(self.address, name="operator at the screen", control=True)
            except NoServiceError:
                await asyncio.sleep(LOOK_S)
        raise NotReachedError(f"no service within {START_S:g} s")

    @contextmanager
    def attack(self, kinds: Sequence[str] = KINDS) -> Iterator[None]:
        """Run the hostile clients during the block. Raises NotReachedError if they have ended."""
        module, folder = "tests.campaigns.stop.hostile", str(self.folder)
        processes = [started(module, kind, folder, nice=NICE, mute=True) for kind in kinds]
        try:
            yield
            if gone := [kind for kind, one in zip(kinds, processes, strict=True) if one.poll() is not None]:
                raise NotReachedError(f"an attack to its end: {', '.join(gone)} ended before")
        finally:
            for process in processes:
                process.kill()
                process.wait()

    async def until(
        self, client: Client, true: Callable[[StateView], bool], what: str, within_s: float = 90.0
    ) -> None:
        """Wait for a state. Raises NotReachedError."""
        end_s = clock.monotonic() + within_s
        while not true(client.state):
            if clock.monotonic() > end_s or client.lost:
                state = client.state
                why = f"{state.mode}: {state.mode_text} {client.lost}"
                raise NotReachedError(f"{what}: not within {within_s:g} s; {why}")
            await asyncio.sleep(LOOK_S)

    async def take_control(self, client: Client) -> None:
        """Take control from any client."""
        await client.command(TakeControl(force=True))

    # -- STOP -------------------------------------------------------------------------------------------------

    async def stop(self, call: StopCall, after_s: float = 0.0) -> tuple[str, float, float | None]:
        """Send a probe's STOP; return its name, when it was sent and when it was answered (None: not)."""
        self._probes += 1
        name = f"{PROBE}{self._probes}"
        await asyncio.sleep(after_s)

        def say() -> tuple[float, float | None]:
            call.name = name
            sent_s = clock.monotonic()
            try:
                call.stop()
            except NotTakenError:
                return sent_s, None
            return sent_s, clock.monotonic()

        sent_s, answered_s = await asyncio.to_thread(say)
        return name, sent_s, answered_s

    async def tries(self, count: int, kept: bool = False, fresh: bool = False) -> list[Try]:
        """Send STOP so many times at random moments, over a connection that stays open as a screen's does.

        ``kept``: if nothing ticks it is enough that nothing begins any more. ``fresh``: connect anew each time, as a
        command or a script does; the time to connect counts.
        """
        return self.judged(await self.stops(count, fresh), kept)

    async def stops(self, count: int, fresh: bool = False) -> list[tuple[str, float, float | None]]:
        """As ``tries``, not judged yet."""
        made: list[tuple[str, float, float | None]] = []
        with StopCall(self.address, "probe") as call:
            if not fresh:
                call.connect()
            for _ in range(count):
                made.append(await self.stop(call, 0.05 + 0.2 * self._random.random()))
                if fresh:
                    call.close()
        return made

    def judged(self, made: list[tuple[str, float, float | None]], kept: bool = False) -> list[Try]:
        """Return the tries with the times at which control had them."""
        taken: dict[str, float] = {}
        for line in (self.folder / STOPS).read_text(encoding="utf-8").splitlines():
            at, how, names = line.split(" ", 2)
            for name in names.split(", ") if kept or how == "done" else ():
                taken.setdefault(name.split(" ", 1)[0], float(at))  # behind it: the peer
        return [Try(sent_s, taken.get(name), answered_s) for name, sent_s, answered_s in made]

    def early(self, name: str) -> bool:
        """Return whether a STOP came while nothing ticked."""
        lines = (self.folder / STOPS).read_text(encoding="utf-8").splitlines()
        return any(line.split(" ")[1:3] == ["kept", name] for line in lines)

    def end_for_real(self) -> None:
        """Send the operator's STOP, which is carried out. Raises NotTakenError."""
        with StopCall(self.address, OPERATOR) as call:
            call.stop()

    def scheduling(self) -> str:
        """Return how the operating system schedules the process that ticks now."""
        if sys.platform != "linux":
            return f"not known on {sys.platform}"
        kind = os.sched_getscheduler(self._owner.pid) & ~os.SCHED_RESET_ON_FORK
        return "real-time priority" if kind == os.SCHED_RR else "an ordinary process: no real-time priority is granted"

    # -- records ---------------------------------------------------------------------------------------

    def loop_late_s(self, from_s: float, to_s: float, files: Sequence[str] = LOOPS) -> float:
        """Return the worst lateness of the bare loops in an interval."""
        return max(self.loops_late_s(from_s, to_s, files), default=0.0)

    def loops_late_s(self, from_s: float, to_s: float, files: Sequence[str] = LOOPS) -> list[float]:
        """Return every lateness of the bare loops in an interval."""
        lines = [line for file in files for line in (self.folder / file).read_text(encoding="utf-8").splitlines()]
        rows = [line.split() for line in lines]
        return [float(row[1]) for row in rows if len(row) == 2 and from_s <= float(row[0]) <= to_s]

    def scans(self) -> list[tuple[float, float]]:
        """Return every scan of the finished runs: clock time of its beginning, and its lateness, s."""
        notes: array[float] = array("d")
        file = self.folder / SCANS
        if not file.exists():
            return []
        with file.open("rb") as stream:
            notes.frombytes(stream.read())
        return late_scans(list(zip(notes[::2], notes[1::2], strict=True)))


def late_scans(scans: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return when scans began and how late, s, from their clock times and due times.

    Each run has a clock of its own, which begins at 0: no piece of ``ROLLING`` scans contains two of them.
    """
    late: list[tuple[float, float]] = []
    first = 0
    for end in range(1, len(scans) + 1):
        if end < len(scans) and end - first < ROLLING and scans[end][1] >= scans[end - 1][1]:
            continue
        piece = scans[first:end]
        least = min(at - meant for at, meant in piece)
        late += [(at, at - meant - least) for at, meant in piece]
        first = end
    return late
