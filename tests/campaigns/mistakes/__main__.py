"""Mistakes of wiring, scaling and typing on the twin: each must be named, and none on a clean rig.

    python -m tests.campaigns.mistakes [--sample] [--track] [--seeds N] [--list FILE.yaml] [NAME...]

In virtual time. A mistake counts as named if a finding of the doctor, or of commissioning, matches the expected text.
The doctor's exit code must be 0 exactly if a run on the same machine arms. ``--sample``: one seed of every second
mistake, without those that need motion. ``--list``: another author's list for the doctor (``written``), nine in ten of
which must be named. Exit code 1 on a miss.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from importlib.util import find_spec
from itertools import chain
from math import ceil
from pathlib import Path
from time import process_time
from types import ModuleType

from tests.campaigns.acceptance.figure import Figure, at_least, equal
from tests.campaigns.mistakes.by_doctor import clean, mistakes_of
from tests.campaigns.mistakes.mistake import Mistake
from tests.campaigns.mistakes.written import read_list

LEAST = 20
"""Required number of named kinds of mistakes."""
LISTED_SHARE = 0.9
"""Minimum named share of another author's list."""
SOURCES = ("by_doctor", "by_answers", "by_track", "by_commissioning")
"""Modules of this package that define ``MISTAKES`` and ``clean``, quick ones first."""
SECOND_HAND = Path(__file__).with_name("second_hand.yaml")
"""Mistakes by another author than the probes'."""
CLEAN_SEEDS = 10


def sources(names: tuple[str, ...] = SOURCES) -> list[ModuleType]:
    """Return the existing modules."""
    package = "tests.campaigns.mistakes"
    return [import_module(f"{package}.{name}") for name in names if find_spec(f"{package}.{name}") is not None]


def named(mistake: Mistake, seeds: range) -> Figure:
    """Return in how many seeds a mistake was named; a miss shows the actual findings."""
    missed: list[str] = []
    for seed in seeds:
        found = mistake.find(seed)
        if not any(re.search(mistake.named_by, line) for line in found):
            missed.append(f"seed {seed}: {'; '.join(found) or 'nothing'}")
    value = f"{len(seeds) - len(missed)} of {len(seeds)}"
    return Figure(f"named: {mistake.name}", "; ".join([value, *missed]), f"{len(seeds)} of {len(seeds)}", not missed)


def agreed(mistakes: Sequence[Mistake], seeds: range) -> Figure:
    """Return the cases in which the doctor's exit code contradicts a run of the same machine."""
    wrong = [
        f"{mistake.name}, seed {seed}: {why}"
        for mistake in mistakes for seed in seeds if (why := mistake.disagrees(seed))
    ]  # fmt: skip
    return equal("exit codes of the doctor that contradict a run of the same machine", wrong, [])


def unfounded(name: str, clean: Callable[[int], list[str]], seeds: range) -> Figure:
    """Return how many clean rigs have findings."""
    findings = {seed: found for seed in seeds if (found := clean(seed))}
    value = [f"seed {seed}: {'; '.join(found)}" for seed, found in findings.items()]
    return equal(f"{len(seeds)} clean rigs: named by {name}", value, [])


def figures(modules: list[ModuleType], seeds: int, clean_seeds: int, wanted: list[str]) -> Iterator[Figure]:
    """Measure."""
    mistakes: list[Mistake] = [mistake for module in modules for mistake in module.MISTAKES]
    mistakes = mistakes[::2] if seeds == 1 else mistakes
    chosen = [mistake for mistake in mistakes if not wanted or any(word in mistake.name for word in wanted)]
    caught = 0
    for mistake in chosen:
        figure = named(mistake, range(seeds))
        caught += figure.ok
        yield figure
    yield agreed(chosen, range(seeds))
    if not wanted:
        yield at_least("kinds of mistakes that were named", caught, LEAST)
        for module in modules:
            yield unfounded(module.__name__.rpartition(".")[2], module.clean, range(clean_seeds))


def listed(path: Path, seeds: int) -> Iterator[Figure]:
    """Measure another author's list."""
    mistakes, named_ones = mistakes_of(read_list(path)), 0
    for mistake in mistakes:
        figure = named(mistake, range(seeds))
        named_ones += figure.ok
        print(figure, flush=True)
    yield at_least(f"named of {len(mistakes)}", named_ones, ceil(LISTED_SHARE * len(mistakes)))
    yield agreed(mistakes, range(seeds))
    yield unfounded("by_doctor", clean, range(CLEAN_SEEDS))


def main() -> int:
    """Measure, print a figure a line, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.mistakes", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="one seed a mistake, what can be seen without motion")
    parser.add_argument("--seeds", type=int, default=3, help="seeds of each mistake (default 3)")
    parser.add_argument("--list", type=Path, help="another list of mistakes for the doctor")
    parser.add_argument("names", nargs="*", help="only mistakes whose names hold one of these words")
    parser.add_argument("--track", action="store_true", help="only the commissioning of a specimen on a track")
    given = parser.parse_args()
    modules = sources(("by_track",)) if given.track else sources(SOURCES[:2]) if given.sample else sources()
    seeds, clean_seeds = (1, 1 if given.track else 8) if given.sample else (given.seeds, CLEAN_SEEDS)
    missed, total = 0, 0
    if given.list:
        measured = listed(given.list, seeds)
    else:
        measured = figures(modules, seeds, clean_seeds, given.names)
        if not (given.sample or given.names or given.track):
            measured = chain(measured, listed(SECOND_HAND, seeds))
    for figure in measured:
        print(figure, flush=True)
        missed, total = missed + (not figure.ok), total + 1
    print(f"{total - missed} of {total} figures kept, {process_time():.0f} s of CPU")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
