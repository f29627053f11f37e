"""`python -m tests.campaigns.belt [--sample] [--seeds N] [--jobs N]`: is a belt's loss of grip found, apart from
wheels?

A belt loses 10 % of its grip over 2 km of travel under load. In made-up sets, and in runs on the simulated rig with
wheels that wear three times as fast as believed: with six wheel changes, or a reserved wheel, the stated interval must
contain the loss; with one wheel the product must state that it cannot separate the two. Prints a line a figure; exit
status 1 where one misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import chain
from multiprocessing import get_context

from tests.campaigns.acceptance.figure import Figure, at_least, holds
from tests.campaigns.belt import sets, twin

SETS, SAMPLE_SETS = 500, 200
SEEDS, SAMPLE_SEEDS = 20, 1
COVERED = (89.0, 99.0)
"""Share of made-up sets whose interval contains the loss, per cent."""
OF_SEEDS = 0.8
"""Of the runs: 16 of 20."""


def of_sets(count: int) -> Iterator[Figure]:
    """Yield how many intervals of made-up sets contain the loss."""
    low, high = COVERED
    for way in sets.WAYS:
        found = list(sets.drifts(way, count))
        if not way.separable:
            silent = sum(not one.apart for one in found)
            yield holds(f"sets, {way.name}: it cannot tell", silent == count, f"{silent} of {count}", f"all {count}")
            continue
        held = 100.0 * sum(one.apart and twin.holds_truth(one) for one in found) / count
        half = sum(one.coverage * one.standard for one in found) / count * sets.OVER_M
        value = f"{held:.1f} % of {count}, +- {100.0 * half:.1f} % in the mean"
        yield holds(f"sets, {way.name}: interval holds the loss", low <= held <= high, value, f"{low:g} to {high:g} %")


def of_twins(seeds: int, jobs: int, ways: Sequence[str]) -> Iterator[Figure]:
    """Yield the results of runs on the simulated rig."""
    cases = [twin.TwinCase(way, seed) for way in ways for seed in range(1, seeds + 1)]
    found: list[twin.TwinFound] = []
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(twin.carry_out, cases):
            found.append(one)
            off = "" if one.covered or not one.stated else "  OUTSIDE"
            print(f"     {one.case.way}, seed {one.case.seed}: {one.sentence}{off}", flush=True)
    for way in ways:
        ours = [one for one in found if one.case.way == way]
        if way == "one wheel":
            silent = sum(not one.stated for one in ours)
            yield at_least(f"runs, {way}: it cannot tell, of {seeds}", silent, seeds, digits=0)
        else:
            held = sum(one.stated and one.covered for one in ours)
            name = f"runs, {way}: interval holds the loss, of {seeds}"
            yield at_least(name, held, int(OF_SEEDS * seeds), digits=0)


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.belt", description=(__doc__ or "").partition("\n")[2])
    parser.add_argument("--sample", action="store_true", help="the short form, for every change")
    parser.add_argument("--seeds", type=int, metavar="N", help=f"runs of each way (default {SEEDS}); 0: sets alone")
    parser.add_argument("--way", action="append", choices=[*twin.WAYS], help="runs of this way alone; may be repeated")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    given = parser.parse_args(arguments)
    sample: bool = given.sample
    seeds: int = given.seeds if given.seeds is not None else SAMPLE_SEEDS if sample else SEEDS
    ways: list[str] = given.way or [*twin.WAYS]
    missed = 0
    runs = of_twins(seeds, given.jobs, ways) if seeds else iter(())
    for figure in chain(of_sets(SAMPLE_SETS if sample else SETS), runs):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
