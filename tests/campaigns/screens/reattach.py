"""A screen opened after another one was killed: how soon it shows the run."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

from tests.campaigns.acceptance.figure import Figure, at_most, holds
from tests.campaigns.screens.seat import NotSeenError, Seat, median
from tests.campaigns.screens.terminal import Terminal

TIMES, QUICK = 10, 2
ASKED_S = 1.0
FIRST, LIVE = "F12 STOP", "Friction"
"""The last line is on the first picture; a value's row appears only with a state of the service, the run's."""


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Kill a screen and open another one, which must find the run by itself."""
    first_s: list[float] = []
    live_s: list[float] = []
    async with seat.service() as observer:
        begun = await asyncio.to_thread(seat.tester, "run", str(seat.recipe), "--detach", "--yes", "--speed", "1")
        if begun.returncode:
            raise NotSeenError(f"the run: {begun.stderr}")
        await observer.until(lambda state: state.mode == "RUN" and state.t_s > 1.0, "a run")
        for _ in range((QUICK if quick else TIMES) + 1):
            screen = Terminal(seat, ["tui", "--out", str(seat.runs)])
            try:
                drawn_s = await screen.until(FIRST)
                seen_s = await screen.until(LIVE)
                await screen.until(" RUN ")
                await observer.controlled()
            finally:
                screen.close()
            first_s.append(drawn_s - screen.began_s)
            live_s.append(seen_s - drawn_s)
    count = f"of {len(live_s) - 1} screens after a SIGKILL"
    yield holds("process start to first picture, median", True, f"{median(first_s[1:]):.2f} s {count}", "no limit")
    yield at_most("first picture to live values, median", median(live_s[1:]), ASKED_S, "s", 2)
    yield at_most("first picture to live values, maximum", max(live_s[1:]), ASKED_S, "s", 2)
