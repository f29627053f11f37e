"""`python -m tests.campaigns.screens [NAME ...] [--sample] [--list] [--captures DIR]`: requirements of the screen.

Real terminals, real keys, the installed command, a service on the simulated rig. Prints a line a figure with its limit,
and exits 1 where one misses.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.figure import Figure
from tests.campaigns.screens.seat import NotSeenError, Seat, installed
from tests.campaigns.screens.terminal import HAS_PTY
from tests.campaigns.screens.topics import TOPICS, Topic


def options(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.screens", description="Measure the operator's screen.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="topics, all unless named: " + ", ".join(TOPICS))
    parser.add_argument("--sample", action="store_true", help="the short form of each topic")
    parser.add_argument("--list", action="store_true", help="name the topics and leave")
    parser.add_argument("--captures", type=Path, metavar="DIR", help="put what the terminals show into this folder")
    read = parser.parse_args(arguments)
    if unknown := [name for name in read.names if name not in TOPICS]:
        parser.error(f"no topic {', '.join(unknown)}; there are {', '.join(TOPICS)}")
    return read


async def measure(topic: Topic, seat: Seat, *, quick: bool) -> int:
    """Print the figures of a topic and return the number of misses; a failed measurement is a miss."""
    missed = 0
    try:
        async for figure in topic.figures(seat, quick=quick):
            missed += not figure.ok
            print(figure, flush=True)
    except (NotSeenError, OSError) as error:
        missed += 1
        print(Figure(topic.name, str(error), "can be measured", False), flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure the named topics; return 1 if a figure misses."""
    read = options(arguments)
    if read.list:
        print("\n".join(f"{topic.name:10} {topic.title}" for topic in TOPICS.values()))
        return 0
    if not HAS_PTY:
        print("not measured: no pseudo-terminals on this system")
        return 0
    print(f"command: {' '.join(installed())}")
    missed = 0
    with TemporaryDirectory(prefix="screens-", ignore_cleanup_errors=True) as temporary:
        captures: Path = (read.captures or Path(temporary) / "captures").resolve()
        captures.mkdir(parents=True, exist_ok=True)
        for name in dict.fromkeys(read.names or TOPICS):
            topic = TOPICS[name]
            print(f"== {name}: {topic.title}", flush=True)
            seat = Seat(Path(temporary) / name, captures, topic.recipe)
            missed += asyncio.run(measure(topic, seat, quick=read.sample))
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
