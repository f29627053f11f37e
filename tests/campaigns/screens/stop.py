"""STOP from a key to the service: how long it takes."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from itertools import cycle

from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal
from tests.campaigns.screens.seat import Noise, NotSeenError, Seat, median
from tests.campaigns.screens.terminal import Terminal, start_mine

ASKED_S = 0.05
RUNS, QUICK = 8, 2
A_RUN = 4
"""Presses in one run: the first stops it, the others follow while it stops, or just after."""
IN_RUNS = 0.25
"""At least this share of the presses, the first of each run, comes during the run: the scan has priority."""
SETTLE_S = 0.25
"""Time to draw a newly selected screen, s."""
SCREENS = ("F3", "F2", "F5", "F4", "F6")


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Press STOP on every screen during runs; an observer receives the service's event of it."""
    runs = QUICK if quick else RUNS
    wanted = runs * A_RUN
    taken_s: list[float] = []
    in_run_s: list[float] = []
    lost = 0
    async with seat.service() as observer:
        noise = Noise()
        screen = Terminal(seat, ["tui", "--out", str(seat.runs)])
        try:
            await observer.controlled()
            await screen.until("✔   mine", 60.0)
            keys, screens = cycle(("F12", "Ctrl+X")), cycle(SCREENS)
            for _ in range(runs):
                await start_mine(screen)
                await observer.until(lambda state: state.mode == "RUN" and state.t_s > 1.0, "a run")
                for _ in range(A_RUN):
                    await screen.press(next(screens))
                    await asyncio.sleep(SETTLE_S)
                    under_way = observer.state.mode != "OFFLINE"
                    pressed_s = screen.key(next(keys))
                    try:
                        received_s = await observer.stop_by_screen(pressed_s, "STOP at the service")
                    except NotSeenError:
                        lost += 1
                        continue
                    taken_s.append(received_s - pressed_s)
                    in_run_s += [received_s - pressed_s] if under_way else []
                await observer.until(lambda state: state.mode == "OFFLINE", "the rig at a standstill", 60.0)
        finally:
            screen.close()
    yield Figure("a process that only waits is woken late by: median, 99.9 %, maximum", noise.end(), "no limit", True)
    yield equal("STOP taken", f"{len(taken_s)} of {len(taken_s) + lost}", f"{wanted} of {wanted}")
    for name, found in (("all", taken_s), ("while a run is under way", in_run_s)):
        most = max(found, default=float("nan"))
        yield at_most(f"key to service, {name}, median", 1e3 * median(found), 1e3 * ASKED_S, "ms", 1)
        yield at_most(f"key to service, {name}, maximum", 1e3 * most, 1e3 * ASKED_S, "ms", 1, note=f" of {len(found)}")
    yield at_least("presses while a run is under way", len(in_run_s), IN_RUNS * wanted)
