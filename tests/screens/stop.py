"""STOP from a key to the service: how long it takes."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from itertools import cycle

from tests.acceptance.figure import Figure, at_most, equal
from tests.screens.seat import NotSeenError, Seat, median
from tests.screens.terminal import Terminal, start_mine

ASKED_S = 0.05
PRESSES, QUICK = 24, 6
A_RUN = 6
"""Presses in one run: the first stops it, the others come while it stops."""
SCREENS = ("F3", "F2", "F5", "F4", "F6")
BETWEEN_S = 0.25


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Press STOP on every screen during runs; an observer hears from the service that it was taken."""
    wanted = QUICK if quick else PRESSES
    taken_s: list[float] = []
    first_s: list[float] = []
    lost = 0
    async with seat.service() as observer:
        screen = Terminal(seat, ["tui", "--out", str(seat.runs)])
        try:
            await observer.controlled()
            await screen.until("✔   mine", 60.0)
            keys, screens = cycle(("F12", "Ctrl+X")), cycle(SCREENS)
            for _ in range(wanted // A_RUN):
                await start_mine(screen)
                await observer.until(lambda state: state.mode == "RUN" and state.t_s > 1.0, "a run")
                for number in range(A_RUN):
                    await screen.press(next(screens))
                    await asyncio.sleep(BETWEEN_S)
                    pressed_s = screen.key(next(keys))
                    try:
                        heard_s = await observer.event(lambda event: event.text.startswith("stop by tui"), pressed_s,
                                                       "STOP at the service")  # fmt: skip
                    except NotSeenError:
                        lost += 1
                        continue
                    taken_s.append(heard_s - pressed_s)
                    first_s += [heard_s - pressed_s] if number == 0 else []
                await observer.until(lambda state: state.mode == "OFFLINE", "the rig at a standstill", 60.0)
        finally:
            screen.close()
    yield equal("STOP taken", f"{len(taken_s)} of {len(taken_s) + lost}", f"{wanted} of {wanted}")
    yield at_most("key to service, median", 1e3 * median(taken_s), 1e3 * ASKED_S, "ms", 1)
    yield at_most("key to service, maximum", 1e3 * max(taken_s, default=float("nan")), 1e3 * ASKED_S, "ms", 1)
    yield at_most("of those that stopped a run, maximum", 1e3 * max(first_s, default=float("nan")), 1e3 * ASKED_S,
                  "ms", 1)  # fmt: skip
