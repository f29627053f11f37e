"""`python -m tests.campaigns.stop [--sample] [--tries N]`: STOP among hostile clients.

Twenty clients that send each command in a loop or never read, two that take control by force, 32 that connect and stay
silent and 600 that come and go at both doors, all at low priority. Prints a line a figure with its limit, and exits 1
where one misses.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
from collections.abc import AsyncIterator
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.service.address import HAS_UNIX
from tests.campaigns.acceptance.figure import Figure, holds
from tests.campaigns.stop import scenes
from tests.campaigns.stop.place import NotReachedError, Place

TRIES, SAMPLE = 50, 8
"""In each scene."""
PLANNED, MANY = 20_000, 200_000
"""Conditions of the planned recipe; of the larger one, planned for a tenth of the tries."""


def options(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.stop", description="STOP among hostile clients.")
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} tries a scene instead of {TRIES}")
    parser.add_argument("--tries", type=int, metavar="N", help="so many tries a scene")
    return parser.parse_args(arguments)


async def figures(folder: Path, tries: int, *, many: bool) -> AsyncIterator[Figure]:
    """Yield every figure; ``many``: also those of the larger recipe."""
    with ExitStack() as stack:
        place = Place(folder, stack)
        async with await place.operator() as client:
            planned = scenes.Planned()
            parts = [
                scenes.sliding_and_resting(place, client, place.attack, tries),
                scenes.by_hand(place, client, place.attack, tries),
                scenes.torn_away(place, client, place.attack, tries),
                scenes.planning(place, client, place.attack, tries, PLANNED, planned),
            ]
            if many:
                parts.append(scenes.planning(place, client, place.attack, max(tries // 10, 1), MANY, planned))
            for scene in parts:
                async for figure in scene:
                    yield figure


async def measure(tries: int, *, many: bool) -> int:
    """Print the figures; return the number of misses."""
    missed = 0
    with TemporaryDirectory(prefix="stop-", ignore_cleanup_errors=True) as folder:
        try:
            async for figure in figures(Path(folder), tries, many=many):
                missed += not figure.ok
                print(figure, flush=True)
        except (NotReachedError, OSError) as error:
            missed += 1
            print(holds("can be measured", False, str(error), "yes"), flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure; return 1 if a figure misses."""
    read = options(arguments)
    if not HAS_UNIX:
        print("not measured: no Unix sockets on this system")
        return 0
    missed = asyncio.run(measure(read.tries or (SAMPLE if read.sample else TRIES), many=not read.sample))
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
