"""`python -m tests.campaigns.budget [--sample | --twin SEEDS]`: is the stated U right; one line a figure.

Coverage of both measurands by Monte Carlo with the distributions that the budget declares; how often two wheels of one
compound, and compounds 10 % apart, are called different; and whether a test fails for every wrong term of the budget.
``--twin``: instead, coverage on the simulated rig with wrong beliefs, one condition a seed. Exit status 0 when every
figure is what is asked for, 1 when one misses it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import chain
from math import sqrt
from random import Random

from tester.analysis.difference import difference
from tests.campaigns.acceptance.figure import Figure, at_least, equal, holds
from tests.campaigns.budget.cells import BETWEEN, CELLS, Cell, measured, replicates, rig
from tests.campaigns.budget.mutant import survivors
from tests.campaigns.budget.mutants import mutants
from tests.campaigns.budget.twin import Held, held

DRAWS, SAMPLE_DRAWS = 10_000, 1_000
PAIRS, SAMPLE_PAIRS = 1_000, 300
COVERED = (94.0, 99.0)
"""Share of intervals that contain the value, per cent: nominally 95; bounded distributions make it slightly larger."""
ON_THE_TWIN, TWIN_SEEDS = (89.0, 99.0), 100
"""The same on the simulated rig: with 100 seeds the count itself scatters by two."""
CALLED_ON_THE_TWIN = (1.0, 11.0)
"""Share of pairs of wheels of one compound, on the simulated rig, that are called different, per cent."""
SURE = 2.5
"""Tolerance of a sample's figure, in its own standard deviations."""
EVERY = 20
"""The sample hunts every twentieth mutant."""


def _within(name: str, hits: int, count: int, low: float, high: float, *, exact: bool) -> Figure:
    """Return a share in per cent with its bounds; a sample's bounds allow for the scatter of a count."""
    share = 100.0 * hits / count
    room = 0.0 if exact else SURE * 100.0 * sqrt(max(low * (100.0 - low), high * (100.0 - high)) / count) / 100.0
    limit = f"{low:g} to {high:g} %" + (f" +- {room:.1f} for {count}" if room else "")
    return holds(name, low - room <= share <= high + room, f"{share:.1f} % of {count}", limit)


def coverage(draws: int) -> Iterator[Figure]:
    """Yield how many intervals contain this wheel's value, and how many the compound's."""
    for number, cell in enumerate(CELLS):
        random = Random(f"coverage {number}")
        this = compound = whole = 0
        for _ in range(draws):
            mu = cell.mu * (1.0 + random.gauss(0.0, BETWEEN))
            found = measured(cell, mu, rig(random), random, random.gauss(0.0, 1.0))
            this += abs(found.mu - mu) <= found.budget.expanded
            compound += abs(found.mu - cell.mu) <= found.compound_budget.expanded
        exact = draws >= DRAWS
        yield _within(f"{cell.name}: this wheel covered", this, draws, *COVERED, exact=exact)
        yield _within(f"{cell.name}: the compound covered", compound, draws, *COVERED, exact=exact)
        if number == 0:
            for _ in range(draws // 4):
                found = replicates(cell, cell.mu, rig(random), random, random.gauss(0.0, 1.0), 3)
                whole += abs(found.mu - cell.mu) <= found.compound_budget.expanded
            name = f"{cell.name}: the compound covered by 3 replicates"
            yield _within(name, whole, draws // 4, *COVERED, exact=exact)


def _called(cell: Cell, apart: float, wheels: int, pairs: int) -> int:
    """Return the number of pairs, each measured on one rig, in which two compounds are called different."""
    random = Random(f"pairs {apart} {wheels}")
    called = 0
    for _ in range(pairs):
        one_rig, slope_off = rig(random), random.gauss(0.0, 1.0)
        sides = [replicates(cell, mu, one_rig, random, slope_off, wheels) for mu in (cell.mu, cell.mu * (1.0 + apart))]
        called += difference(sides[0], sides[1], same_rig=True).told_apart
    return called


def pairs(count: int) -> Iterator[Figure]:
    """Yield how often two compounds are called different."""
    cell, exact = CELLS[0], count >= PAIRS
    yield _within("one compound, one wheel each, called different", _called(cell, 0.0, 1, count), count, 3.5, 6.5,
                  exact=exact)  # fmt: skip
    yield _within("one compound, three wheels each, called different", _called(cell, 0.0, 3, count), count, 3.5, 6.5,
                  exact=exact)  # fmt: skip
    yield _within("10 % apart, one wheel each, called different", _called(cell, 0.1, 1, count), count, 50.0, 68.0,
                  exact=exact)  # fmt: skip
    yield _within("10 % apart, three wheels each, called different", _called(cell, 0.1, 3, count), count, 93.0, 100.0,
                  exact=exact)  # fmt: skip


def twin(seeds: int, jobs: int) -> Iterator[Figure]:
    """Yield how many intervals of runs on the simulated rig contain its truth."""
    found: list[Held] = []
    for one in held(seeds, jobs):
        found.append(one)
        text = f"off by {one.off_percent:+.2f} %, U {one.u_percent:.2f} %"
        print(f"     seed {one.seed} {one.condition}: {text}", flush=True)
    count = len(found)
    yield at_least("seeds with a value", count, 0.95 * seeds, digits=0)
    if count:
        exact = count >= TWIN_SEEDS
        this, compound = sum(one.this for one in found), sum(one.compound for one in found)
        yield _within("on the twin: this wheel covered", this, count, *ON_THE_TWIN, exact=exact)
        yield _within("on the twin: the compound covered", compound, count, *ON_THE_TWIN, exact=exact)
        both, called = sum(one.both for one in found), sum(one.wheels_differ for one in found)
        yield _within("on the twin: the compound covered by two wheels", both, count, *ON_THE_TWIN, exact=exact)
        yield _within("two wheels of a run called different", called, count, *CALLED_ON_THE_TWIN, exact=exact)


def killed(every: int, word: str = "") -> Iterator[Figure]:
    """Yield the wrong budgets that no test detects, among every so many, or among those with a word in their names."""
    hunted = [one for one in mutants() if word in one.name][::every]
    alive: list[str] = []
    for one, lives in survivors(hunted):
        if lives:
            alive.append(one.name)
            print(f"     not noticed: {one.name}", flush=True)
    yield equal(f"wrong budgets that no test notices, of {len(hunted)}", alive, [])


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.budget", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="the short form, for every change")
    parser.add_argument("--twin", type=int, metavar="SEEDS", help="coverage on the simulated rig; 100: half an hour")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="of --twin: runs side by side (default 1)")
    parser.add_argument("--mutants", nargs="?", const="", metavar="WORD", help="mutants alone, those with a word")
    given = parser.parse_args(arguments)
    sample: bool = given.sample
    draws, count, every = (SAMPLE_DRAWS, SAMPLE_PAIRS, EVERY) if sample else (DRAWS, PAIRS, 1)
    missed = 0
    if given.mutants is not None:
        made = killed(every, given.mutants)
    elif given.twin is not None:
        made = twin(given.twin, given.jobs)
    else:
        made = chain(coverage(draws), pairs(count), killed(every))
    for figure in made:
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
