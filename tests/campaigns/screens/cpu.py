"""CPU time of a screen and of the service, of one core, while the wheel slides in real time."""

from __future__ import annotations

import asyncio
import subprocess
from collections.abc import AsyncIterator

from tester.base import clock
from tests.campaigns.acceptance.figure import Figure, at_least, at_most
from tests.campaigns.screens.seat import NotSeenError, Observer, Seat, slides
from tests.campaigns.screens.terminal import Terminal
from tests.realtime.processes import OVERRIDES

MEASURED_S, QUICK_S = 40.0, 10.0
NEAR_AMBIENT = tuple(word for override in OVERRIDES for word in ("--set", override))
SETTLE_S = 3.0
SCREEN_PERCENT, SERVICE_PERCENT = 12.0, 5.0
SNAPSHOTS_PER_S = 3.8
"""Four a second are sent; the first and the last may lie outside the time."""
TICKS_PER_S = 100.0
"""USER_HZ of Linux."""


def cpu_s(pid: int) -> float:
    """Return the CPU time of a process, s, from the system's accounting (ps, which rounds to 10 ms at best)."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:  # noqa: PTH123 - no file
            fields = file.read().rpartition(")")[2].split()
    except OSError:
        text = subprocess.run(["ps", "-o", "time=", "-p", str(pid)], capture_output=True, text=True, check=True).stdout
        seconds = 0.0
        for part in text.strip().replace("-", ":").split(":"):
            seconds = 60.0 * seconds + float(part)
        return seconds
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


def children(pid: int) -> list[int]:
    """Return the live child processes of a process."""
    output = subprocess.run(["ps", "-eo", "pid=,ppid="], capture_output=True, text=True, check=True).stdout
    pairs = [tuple(map(int, line.split())) for line in output.splitlines()]
    return [child for child, parent in pairs if parent == pid]


async def share(observer: Observer, pids: list[int], seconds: float) -> list[float]:
    """Return the processes' share of a core while the wheel slides, %."""
    await asyncio.sleep(SETTLE_S)
    before, began_s = [cpu_s(pid) for pid in pids], clock.monotonic()
    await asyncio.sleep(seconds)
    took_s = clock.monotonic() - began_s
    return [100.0 * (cpu_s(pid) - was) / took_s for pid, was in zip(pids, before, strict=True)]


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Measure the screen at 120 x 40, then the service alone: not even the observer is connected."""
    seconds = QUICK_S if quick else MEASURED_S
    async with seat.service(*NEAR_AMBIENT) as observer:
        begun = await asyncio.to_thread(seat.tester, "run", str(seat.recipe), "--detach", "--yes", "--speed", "1")
        if begun.returncode:
            raise NotSeenError(f"the run: {begun.stderr}")
        await observer.sliding()
        screen = Terminal(seat, ["tui", "--out", str(seat.runs)], (120, 40))
        try:
            await screen.until(" RUN ")
            await screen.press("F2")
            await screen.until("✔   mine", 60.0)  # until then the checks keep it busy
            await screen.press("F3")
            pids = [screen.process.pid, observer.pid, *children(observer.pid)]
            rows = len(observer.client.trend)
            found = await share(observer, pids, seconds)
            sent = (len(observer.client.trend) - rows) / (seconds + SETTLE_S)
        finally:
            screen.close()
        sliding = slides(observer.state)
        yield at_least("snapshots meanwhile", sent, SNAPSHOTS_PER_S, "a second", 1)
        yield at_most("screen at 120 x 40, 4 Hz, sliding", found[0], SCREEN_PERCENT, "% of a core", 1)
        yield Figure("service and gateway meanwhile", f"{found[1]:.1f} + {found[2]:.1f} % of a core", "no limit", True)
        await observer.client.close()
        alone = await share(observer, pids[1:], seconds)
        async with await seat.observer() as again:
            sliding = sliding and slides(again.state)
    yield at_most("service without clients, with the rig it simulates, in real time", sum(alone), SERVICE_PERCENT,
                  "% of a core", 1)  # fmt: skip
    yield Figure("of this the gateway", f"{alone[1]:.1f} % of a core", "no limit", True)
    yield Figure("the wheel slid", str(sliding), "True", sliding)
