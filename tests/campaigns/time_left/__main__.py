"""`python -m tests.campaigns.time_left [--sample] [--seeds N] [--jobs N]`: does a run predict its remaining time?

Five recipes run for several seeds on rigs whose heat, wear, wheel and friction heat are drawn for every run and differ
from their files' beliefs. At 10 % to 90 % of a run's final duration, the time left printed in its head line is compared
with the true one; the printed list of steps is added up; finished conditions are counted and compared with the record,
also in resumed runs and replays. Prints a line a figure and exits 1 if one misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median
from time import process_time
from typing import Final

from tests.campaigns.time_left.cases import Case, all_recipes, carry_out
from tests.campaigns.time_left.looks import Look, Looked

SEEDS, SAMPLE_SEEDS = 20, 1
MOST: Final = 0.07
"""Median error of the time left, as a share of the true one, over all seeds."""
SAMPLE_MOST: Final = 0.3
"""The same for the sample. The median of one seed is 4 to 19 % in 20 seeds: a sample shows gross errors only."""
AT: Final = tuple(tenth / 10.0 for tenth in range(1, 10))
"""Shares of a run's time at which the time left is read."""
SLACK_S: Final = 1.0
"""A condition that ends within this time of a look may count or not: screens are drawn between two scans."""

def errors(looked: Looked) -> Iterator[float]:
    """Yield the error of the time left at each of the moments, as a share of the true one."""
    for share in AT:
        at = max((one for one in looked.looks if one.t_s <= share * looked.took_s), key=_time, default=None)
        if at is not None:
            left_s = looked.took_s - at.t_s
            yield at.left_s / left_s - 1.0


def _time(look: Look) -> float:
    return look.t_s


def miscounted(looked: Looked) -> int:
    """Return the number of looks with a wrong count of conditions."""
    wrong = 0
    for look in looked.looks:
        least, most = (sum(one <= look.t_s + by_s for one in looked.ended_s) for by_s in (-SLACK_S, SLACK_S))
        wrong += not least <= look.over <= most or look.conditions != len(looked.ended_s)
    return wrong


def report(found: Sequence[tuple[Case, list[Looked]]], seeds: int, most: float) -> int:
    """Print the figures; return the number of misses. ``most``: the greatest median error."""
    missed = 0
    runs = [(case, looked) for case, several in found for looked in several]
    whole = [(case, looked) for case, looked in runs if looked.name == "run"]
    off = [abs(one) for _, looked in whole for one in errors(looked)]
    for name in dict.fromkeys(case.recipe.name for case, _ in whole):
        own = [one for case, looked in whole if case.recipe.name == name for one in errors(looked)]
        sizes = sorted(map(abs, own))
        print(f"     {name}: time left off by {100 * median(sizes):.1f} % (median), {100 * median(own):+.1f} % on the "
              f"side, {100 * sizes[int(0.9 * len(sizes))]:.1f} % in nine of ten")  # fmt: skip
        at = [median(abs(list(errors(looked))[place]) for case, looked in whole if case.recipe.name == name)
              for place in range(len(AT))]  # fmt: skip
        print("       at 10 % to 90 %: " + " ".join(f"{100 * one:.1f}" for one in at))
    done = sum(looked.outcome == "done" for _, looked in whole)
    unequal = sum(look.left_s != look.listed_s for _, looked in runs for look in looked.looks)
    wrong = {name: sum(miscounted(looked) for _, looked in runs if looked.name == name) for name in
             dict.fromkeys(looked.name for _, looked in runs)}  # fmt: skip
    looks = sum(len(looked.looks) for _, looked in runs)
    figures = [
        (f"runs of {seeds} seeds that were done", f"{done} of {len(whole)}", "all", done == len(whole)),
        ("time left, median error", f"{100 * median(off):.1f} %", f"<= {100 * most:g} %", median(off) <= most),
        (f"looks at which the list does not add up to the head line, of {looks}", f"{unequal}", "0", not unequal),
        *((f"looks at which a {name} counts conditions wrong", f"{count}", "0", not count)
          for name, count in wrong.items()),
    ]  # fmt: skip
    for name, value, asked, met in figures:
        missed += not met
        print(f"{'ok  ' if met else 'MISS'} {name}: {value} (asked: {asked})", flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.time_left", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SEEDS} seed of each recipe, with a wider limit")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"seeds ({SEEDS})")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="the first seed (0)")
    parser.add_argument("--only", default="", metavar="NAME", help="one recipe")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (1)")
    read = parser.parse_args(arguments)
    seeds = SAMPLE_SEEDS if read.sample else read.seeds
    chosen = [one for one in all_recipes() if read.only in ("", one.name)]
    cases = [Case(one, read.first + seed) for one in chosen for seed in range(seeds)]
    cut = [one for one in chosen if one.name in ("quickstart", "both directions", "pin-on-disc")]
    cases += [Case(one, 1000 + read.first + seed, cut=True) for one in cut for seed in range(max(seeds // 5, 1))]
    began_s = process_time()
    if read.jobs > 1:
        with ProcessPoolExecutor(read.jobs, get_context("spawn")) as pool:
            found = list(pool.map(carry_out, cases))
    else:
        found = [carry_out(case) for case in cases]
    missed = report(found, seeds, SAMPLE_MOST if read.sample else MOST)
    print(f"     processor time of this process: {process_time() - began_s:.0f} s")
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
