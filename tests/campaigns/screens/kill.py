"""SIGKILL of the screen that started a run, in the middle of the run: this must not change the run's tables."""

from __future__ import annotations

import random
from collections.abc import AsyncIterator
from pathlib import Path

from tests.campaigns.acceptance.figure import Figure, equal
from tests.campaigns.screens.seat import NotSeenError, Observer, Seat
from tests.campaigns.screens.terminal import Terminal, start_mine

KILLS, QUICK = 10, 2
SPEED = "40"
TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")
SEED = 1
"""Of the moments of the kills."""
EARLIEST, LATEST = 0.05, 0.9
"""Share of the run after which the screen is killed."""


def tables(run: Path) -> dict[str, bytes]:
    """Return a run's tables."""
    return {name: (run / name).read_bytes() for name in TABLES}


async def one(seat: Seat, observer: Observer, share: float) -> tuple[float, Path]:
    """Start a run from a screen, kill the screen after a share of the run; return the actual share and the run."""
    before = set(seat.runs.glob("2*"))
    screen = Terminal(seat, ["tui", "--speed", SPEED, "--out", str(seat.runs)])
    try:
        await screen.until("✔   mine", 60.0)
        await start_mine(screen)
        await observer.until(lambda state: state.mode == "RUN" and state.progress.share >= share, "the run", 120.0)
    finally:
        screen.close()
    at = observer.state.progress.share
    await observer.until(lambda state: state.mode == "OFFLINE", "the end of the run", 120.0)
    run = observer.state.run
    if run is None or run.outcome != "done":
        raise NotSeenError(f"the run ended: {run.outcome if run is not None else 'none'}")
    (made,) = set(seat.runs.glob("2*")) - before
    return at, made


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Compare with `tester run` of the same recipe and seed, without a screen."""
    alone = seat.folder / "alone"
    done = seat.tester("run", str(seat.recipe), "--yes", "--out", str(alone))
    if done.returncode:
        raise NotSeenError(f"the undisturbed run: {done.stderr[-500:]}")
    wanted = tables(next(alone.glob("2*")))
    moments = random.Random(SEED)
    kills = QUICK if quick else KILLS
    same = 0
    shares: list[float] = []
    async with seat.service() as observer:
        for number in range(kills):
            share, run = await one(seat, observer, moments.uniform(EARLIEST, LATEST))
            shares.append(share)
            found = tables(run)
            differing = [name for name in TABLES if found[name] != wanted[name]]
            same += not differing
            what = ", ".join(differing) or "no table"
            print(f"kill {number + 1}: at {100 * share:.0f} %: {what} differs", flush=True)
    rows = {name: text.count(b"\n") for name, text in wanted.items()}
    yield equal("rows with their heads of " + ", ".join(TABLES), list(rows.values()), [3, 3, 9])
    yield equal("screens killed in the middle of their run", sum(0.0 < share < 1.0 for share in shares), kills)
    yield equal("runs with the tables of the undisturbed one", f"{same} of {kills}", f"{kills} of {kills}")
