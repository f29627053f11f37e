"""`python -m tests.campaigns.seeds [TOPIC ...] [--sample | --full] [--jobs N] [--tester COMMAND] [--keep DIR]`."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.figure import Figure
from tests.campaigns.seeds.sweeps import SweepError, Sweeps
from tests.campaigns.seeds.topics import TOPICS, Topic


def options(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    description = "Run recipes over many seeds and print what is asked of them; 1 where a figure misses."
    parser = argparse.ArgumentParser("python -m tests.campaigns.seeds", description=description)
    parser.add_argument("names", nargs="*", metavar="TOPIC", help="all unless named: " + ", ".join(TOPICS))
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--sample", action="store_true", help="few seeds (default)")
    extent.add_argument("--full", action="store_true", help="all seeds: hours of CPU time as plain Python")
    parser.add_argument("--list", action="store_true", help="name the topics and leave")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side")
    parser.add_argument("--tester", metavar="COMMAND", help="another installation's `tester`, such as a compiled one")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep every sweep in this folder")
    read = parser.parse_args(arguments)
    if unknown := [name for name in read.names if name not in TOPICS]:
        parser.error(f"no topic {', '.join(unknown)}; there are {', '.join(TOPICS)}")
    return read


def measure(topics: list[Topic], sweeps: Sweeps) -> int:
    """Print every figure and return the number of misses; a failed measurement is also a miss."""
    missed = 0
    for topic in topics:
        print(f"== {topic.name}: {topic.title}", flush=True)
        try:
            for figure in topic.figures(sweeps):
                missed += not figure.ok
                print(figure, flush=True)
        except (SweepError, LookupError, ValueError, OSError) as error:
            missed += 1
            print(Figure(topic.name, f"{type(error).__name__}: {error}", "can be measured", False), flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure the named topics; return 1 if a figure misses."""
    read = options(arguments)
    if read.list:
        print("\n".join(f"{topic.name:12} {topic.title}" for topic in TOPICS.values()))
        return 0
    with TemporaryDirectory(prefix="seeds-") as temporary:
        folder: Path = (read.keep or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        sweeps = Sweeps(folder, full=read.full, jobs=read.jobs, command=read.tester)
        missed = measure([TOPICS[name] for name in dict.fromkeys(read.names or TOPICS)], sweeps)
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
