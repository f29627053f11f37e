"""`python -m tests.campaigns.acceptance [NAME ...] [--sample | --full] [--list] [--jobs N] [--keep DIR]`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.topic import Topic
from tests.campaigns.acceptance.topics import TOPICS


def options(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    description = "Measure what the software is asked to do; 1 where a figure misses."
    parser = argparse.ArgumentParser("python -m tests.campaigns.acceptance", description=description)
    parser.add_argument("names", nargs="*", metavar="NAME", help="topics, all unless named: " + ", ".join(TOPICS))
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--sample", action="store_true", help="the short form of each topic (default)")
    extent.add_argument("--full", action="store_true", help="the long form: Table 2 whole, several seeds")
    parser.add_argument("--list", action="store_true", help="name the topics and leave")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep every run in this folder")
    read = parser.parse_args(arguments)
    if unknown := [name for name in read.names if name not in TOPICS]:
        parser.error(f"no topic {', '.join(unknown)}; there are {', '.join(TOPICS)}")
    return read


def measure(topics: list[Topic], bench: Bench) -> int:
    """Print every figure and return the number of misses."""
    for topic in topics:
        bench.start(topic.runs(bench))
    missed = 0
    for topic in topics:
        print(f"== {topic.name}: {topic.title}", flush=True)
        for figure in topic.measured(bench):
            missed += not figure.ok
            print(figure, flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure the named topics; 1 where a figure misses."""
    read = options(arguments)
    if read.list:
        print("\n".join(f"{topic.name:12} {topic.title}" for topic in TOPICS.values()))
        return 0
    topics = [TOPICS[name] for name in dict.fromkeys(read.names or TOPICS)]
    with TemporaryDirectory(prefix="acceptance-") as temporary:
        folder: Path = (read.keep or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        bench = Bench(folder, full=read.full, jobs=read.jobs)
        try:
            missed = measure(topics, bench)
        finally:
            bench.close()
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
