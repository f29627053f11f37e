"""An unread terminal: its effect on the scan."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

from tester.base import clock
from tests.campaigns.acceptance.figure import Figure, at_most, holds
from tests.campaigns.screens.seat import NotSeenError, Observer, Seat
from tests.campaigns.screens.terminal import Terminal
from tests.realtime.processes import SimProcess

WATCHED_S, QUICK_S = 20.0, 6.0
LATER_S = 0.02
STOP_S = 0.5
"""Limit for a screen that is stuck, s [A]: the 50 ms apply to one that is read."""
EVERY_S = 0.2


async def latest_s(observer: Observer, seconds: float) -> float:
    """Return the greatest lateness of a scan during a time, s; ``late_s`` covers the last second and more."""
    await asyncio.sleep(2.0)  # forgets the time before
    found = 0.0
    end_s = clock.monotonic() + seconds
    while clock.monotonic() < end_s:
        if observer.client.lost or observer.state.mode != "RUN":
            raise NotSeenError(f"the run ended: {observer.state.mode} {observer.state.mode_text}")
        found = max(found, observer.state.tick.late_s)
        await asyncio.sleep(EVERY_S)
    return found


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Let a run slide on `tester sim`, over sockets and by the clock, with and without such a terminal."""
    seconds = QUICK_S if quick else WATCHED_S
    sim = SimProcess(seat.folder)
    try:
        async with seat.service("--rig", str(sim.rig_file)) as observer:
            begun = await asyncio.to_thread(seat.tester, "run", str(seat.recipe), "--detach", "--yes")
            if begun.returncode:
                raise NotSeenError(f"the run: {begun.stderr}")
            await observer.sliding()
            without_s = await latest_s(observer, seconds)
            screen = Terminal(seat, ["tui", "--out", str(seat.runs)])
            try:
                await observer.controlled()
                await screen.until(" RUN ")
                screen.reading(on=False)
                with_s = await latest_s(observer, seconds)
                pressed_s = screen.key("F12")
                stopped_s = await observer.stop_by_screen(pressed_s, "STOP from the unread terminal")
                screen.forget()
                screen.reading(on=True)
                await screen.until("Friction", 10.0)
                back = screen.process.poll() is None
            finally:
                screen.close()
    finally:
        sim.process.kill()
        sim.process.wait()
    name = f"latest scan of {seconds:g} s"
    yield holds(f"{name} without a screen", True, f"{1e3 * without_s:.1f} ms late", "no limit")
    yield holds(f"{name} beside a terminal that nobody reads", True, f"{1e3 * with_s:.1f} ms late", "no limit")
    yield at_most("later than without it", 1e3 * max(with_s - without_s, 0.0), 1e3 * LATER_S, "ms", 1)
    took_ms = 1e3 * (stopped_s - pressed_s)
    yield at_most("STOP from that terminal reaches the service after", took_ms, 1e3 * STOP_S, "ms", 1)
    yield holds("the terminal, read again, shows the run", back, "yes" if back else "no", "yes")
