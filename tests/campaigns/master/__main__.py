"""`python -m tests.campaigns.master [--seeds N] [--jobs N] [--only PART] [--sample]`: master curves, truth known.

Synthetic two-peak sets of 99 conditions: the error of Ts, how often its interval contains the truth, and whether sets
that do not collapse are recognised. Then the simulated slow track, from the recipe to Ts, and Grosch's rules.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median
from typing import Final

import numpy as np

from tester.analysis.master_curve.fitted_curve import Master, master_of
from tester.analysis.master_curve.points import MasterPoint
from tester.analysis.master_curve.verdict import Verdict
from tests.campaigns.master import rules
from tests.campaigns.master.synthetic import FAILING, TS_C, synthetic
from tests.campaigns.master.twin import Found, measured

SEEDS: Final = 20
NEAR_K: Final = {0.0: 0.1, 0.02: 1.0, 0.05: 2.0}
"""Maximum error of Ts of a synthetic set, K, by noise of ln mu."""
SETS, SAMPLE_SETS = 100, 5
COVERED_SETS, SAMPLE_COVERED = 200, 16
COVERED: Final = (0.90, 0.99)
COVERED_NOISE, COVERED_BIAS_K = 0.02, 0.5
"""Noise, and standard deviation of the thermometer's bias, of the sets whose intervals are counted."""
FAILING_NOISE: Final = 0.02
WITHIN_K: Final = 1.0
"""Maximum error of Ts of a simulated run with a correct thermometer, and the median with all errors."""
INSIDE: Final = 0.8
"""Required share of simulated runs whose interval contains the truth: 16 of 20."""
Figure = tuple[str, bool]


def made(points: Sequence[MasterPoint]) -> Master:
    """Return the master curve at 20 degC."""
    return master_of(points, 20.0)


def near(sets: int) -> Iterator[Figure]:
    """Yield the error of Ts, by noise, and how often a clean set is not recognised as a master curve."""
    for noise, most_k in NEAR_K.items():
        found = [made(synthetic(seed, noise)) for seed in range(1 if noise == 0.0 else sets)]
        off = [one.collapse.ts_c - TS_C for one in found]
        worst = max(map(abs, off))
        error = f"{np.mean(off):+.2f} +- {np.std(off):.2f} K" if noise else f"{off[0]:+.3f} K"
        yield (
            f"Ts of {len(found)} sets, {100.0 * noise:g} % noise: {error}, worst {worst:.2f} K (asked: {most_k:g} K)",
            worst <= most_k,
        )
        missed = sum(one.judged.verdict is not Verdict.COLLAPSES for one in found)
        yield f"... not taken for one curve: {missed} of {len(found)} (asked: none)", missed == 0


def covered(sets: int) -> Figure:
    """Return how often the interval contains the true Ts, with an error of the thermometer."""
    held = 0
    for seed in range(sets):
        bias_k = COVERED_BIAS_K * float(np.random.default_rng(10_000 + seed).standard_normal())
        points = synthetic(seed, COVERED_NOISE, bias_k=bias_k, thermometer_k=COVERED_BIAS_K)
        low, high = made(points).collapse.interval
        held += low <= TS_C <= high
    low, high = COVERED
    slack = 0.0 if sets >= COVERED_SETS else 2.5 * (low * (1.0 - low) / sets) ** 0.5
    share = held / sets
    return (
        f"intervals that hold Ts: {held} of {sets}, {100.0 * share:.1f} % (asked: {100.0 * (low - slack):.0f} to"
        f" {100.0 * min(high + slack, 1.0):.0f} %)",
        low - slack <= share <= high + slack,
    )


def refused(sets: int) -> Iterator[Figure]:
    """Yield how often sets that do not collapse, and power laws, which determine no Ts, are recognised."""
    for name, how in FAILING.items():
        found = [made(synthetic(seed, FAILING_NOISE, **how)) for seed in range(sets)]  # type: ignore[arg-type]
        recognised = sum(one.judged.verdict is Verdict.DOES_NOT for one in found)
        yield f"{name}: {recognised} of {sets} do not collapse (asked: all)", recognised == sets
    found = [made(synthetic(seed, FAILING_NOISE, power=0.2)) for seed in range(sets)]
    recognised = sum(one.judged.verdict is Verdict.OPEN for one in found)
    yield f"a power law: cannot tell, {recognised} of {sets} (asked: all)", recognised == sets


def made_up(sets: int, covered_sets: int) -> Iterator[Figure]:
    """Yield every figure of synthetic sets."""
    yield from near(sets)
    yield covered(covered_sets)
    yield from refused(sets)


def twin(seeds: int, jobs: int, *, sample: bool) -> Iterator[Figure]:
    """Yield the results of simulated runs, with a correct thermometer and with all errors."""
    wanted = [(seed, unbiased, sample) for unbiased in ((True,) if sample else (True, False)) for seed in range(seeds)]
    found: list[Found] = []
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(measured, wanted):
            found.append(one)
            kind = "right thermometer" if one.unbiased else "everything on"
            result = f"{one.rows} rows, Ts {one.ts_c:.2f} ({one.low_c:.2f} to {one.high_c:.2f}) degC, {one.verdict}"
            print(f"     seed {one.seed}, {kind}: {result}", flush=True)
    for unbiased in (True, False):
        own = [one for one in found if one.unbiased is unbiased]
        if not own:
            continue
        name, n = "simulated runs, right thermometer" if unbiased else "simulated runs, everything on", len(own)
        off = [abs(one.off_k) if one.off_k == one.off_k else float("inf") for one in own]
        collapsed = sum(one.verdict == Verdict.COLLAPSES.value for one in own)
        yield f"{name}: {collapsed} of {n} collapse (asked: all)", collapsed == n
        if unbiased:
            near_enough = sum(one <= WITHIN_K for one in off)
            text = f"{name}: Ts within {WITHIN_K:g} K in {near_enough} of {n}, worst {max(off):.2f} K (asked: all)"
            yield text, near_enough == n
        inside = sum(one.inside for one in own)
        text = f"{name}: Ts inside its interval in {inside} of {n} (asked: {INSIDE * n:g})"
        yield text, unbiased or inside >= INSIDE * n
        middle = median(off)
        yield f"{name}: median error {middle:.2f} K (asked: at most {WITHIN_K:g} K)", middle <= WITHIN_K


def main(arguments: Sequence[str] | None = None) -> int:
    """Print every figure; return 1 if one misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.master", description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"simulated runs of each sort ({SEEDS})")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (1)")
    text = f"whole runs of the recipe for Grosch's rules ({rules.RUNS})"
    parser.add_argument("--runs", type=int, default=rules.RUNS, metavar="N", help=text)
    parts = ("synthetic", "twin", "rules")
    parser.add_argument("--only", choices=parts, help="sets that are made up, simulated runs, or Grosch's rules")
    parser.add_argument("--sample", action="store_true", help="few synthetic sets, one simulated run")
    read = parser.parse_args(arguments)
    sets = SAMPLE_SETS if read.sample else SETS
    missed = 0

    def tell(figure: Figure) -> None:
        nonlocal missed
        text, met = figure
        missed += not met
        print(f"{'ok  ' if met else 'MISS'} {text}", flush=True)

    if read.only in (None, "synthetic"):
        for figure in made_up(sets, SAMPLE_COVERED if read.sample else COVERED_SETS):
            tell(figure)
    if read.only in (None, "twin"):
        for figure in twin(1 if read.sample else read.seeds, read.jobs, sample=read.sample):
            tell(figure)
    if read.only in (None, "rules"):
        runs = 0 if read.sample else min(read.runs, read.seeds)
        for figure in rules.figures(rules.SAMPLE_SEEDS if read.sample else read.seeds, runs, read.jobs):
            tell(figure)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
