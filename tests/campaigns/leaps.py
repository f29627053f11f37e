"""`python -m tests.campaigns.leaps [--sample] [--seeds N]`: runs with leaps beside the same runs in which every scan is
made.

Specimens on a track, with all noise and scatter; other kinds of machine make every scan. A condition differs by its
coefficient, its temperature, or by being kept in one run and lost in the other.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import median
from time import process_time

import recipes
from tester.analysis.results import RepeatResult
from tester.machine.run import Outcome
from tests.campaigns.track import FASTER, SAMPLED
from tests.tester.kinds.specimen_on_track.bench import TrackBench, one_track

SEEDS, SAMPLE_SEEDS = 20, 2
RECIPES = (("grosch", "grosch"), ("pin-on-disc", "pin-on-disc"))
"""Recipes and their rigs ..."""
CHAMBERS = ("grosch",)
"""... those with a chamber, for which a run waits."""
MOST_PERCENT, MOST_K = 0.02, 0.05
"""Most by which a coefficient and its temperature may differ."""
TWO = "0 degC, 30 degC"
"""Temperatures of the sample."""
LOST_IN = 500
"""Conditions of which one may be kept in one run and lost in the other."""


def valid(bench: TrackBench) -> dict[tuple[int, int], RepeatResult]:
    """Return the valid repeats of a run by condition and place in the order of measuring."""
    found: dict[tuple[int, int], RepeatResult] = {}
    for place, (condition, result) in enumerate(bench.kept.results):
        if result.valid:
            found[condition, place] = result
    return found


class Compared:
    """One seed of a recipe, run both ways."""

    def __init__(self, rig: str, text: str, seed: int) -> None:
        """Run it, first with every scan."""
        began_s = process_time()
        self.every = TrackBench(rig, text, (), seed).to_the_end()
        between_s = process_time()
        self.leapt = TrackBench(rig, text, (), seed).leaping().to_the_end()
        self.every_s, self.leapt_s = between_s - began_s, process_time() - between_s

    @property
    def done(self) -> bool:
        """Whether both runs ended as planned, without a trip."""
        runs = self.every, self.leapt
        return all(one.run.outcome is Outcome.DONE and not one.kept.trips for one in runs)

    def rows(self) -> tuple[list[tuple[float, float]], int]:
        """Return how far each repeat differs, in per cent and K, and how many are in one run only."""
        ours, theirs = (valid(one) for one in (self.every, self.leapt))
        apart = [
            (
                100.0 * abs(theirs[key].mu_resultant / result.mu_resultant - 1.0),
                abs(theirs[key].means["contact_c"] - result.means["contact_c"]),
            )
            for key, result in ours.items()
            if key in theirs
        ]
        return apart, len(ours.keys() ^ theirs.keys())


def measure(recipe: str, rig: str, seeds: int, *, sample: bool) -> int:
    """Run a packaged recipe with some seeds; print the figures, return how many miss."""
    text = Path(recipes.find(recipe)).read_text(encoding="utf-8")
    if sample:
        text = one_track(text).replace(SAMPLED[0], TWO).replace(FASTER, "")
    apart, lost, unfinished, leapt_s = list[tuple[float, float]](), 0, 0, 0.0
    every_s, with_s = list[float](), list[float]()
    for seed in range(seeds):
        both = Compared(rig, text, seed)
        rows, missing = both.rows()
        apart, lost, unfinished = apart + rows, lost + missing, unfinished + (not both.done)
        leapt_s += both.leapt.run.engine.leapt_s
        every_s.append(both.every_s)
        with_s.append(both.leapt_s)
    percent, kelvin = (max((row[i] for row in apart), default=float("inf")) for i in (0, 1))
    figures = [
        (f"runs of {seeds} seeds not finished, or tripped", f"{unfinished}", "0", unfinished == 0),
        (f"coefficient, worst of {len(apart)}", f"{percent:.4f} %", f"<= {MOST_PERCENT:g} %", percent <= MOST_PERCENT),
        ("temperature, worst", f"{kelvin:.4f} K", f"<= {MOST_K:g} K", kelvin <= MOST_K),
        ("repeats in one run only", f"{lost}", f"1 in {LOST_IN}", lost * LOST_IN <= len(apart)),
        ("leapt", f"{leapt_s:.0f} s", "some with a chamber", leapt_s > 0.0 or rig not in CHAMBERS),
    ]
    for name, value, asked, met in figures:
        print(f"{'ok  ' if met else 'MISS'} {recipe}: {name}: {value} (asked: {asked})", flush=True)
    ratio = median(a / b for a, b in zip(every_s, with_s, strict=True))
    print(f"     {recipe}: processor time with every scan, over that with leaps: {ratio:.2f}", flush=True)
    return sum(not met for *_, met in figures)


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.leaps", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SEEDS} seeds of the first recipe, cut short")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"seeds ({SEEDS})")
    read = parser.parse_args(arguments)
    chosen, seeds = (RECIPES[:1], SAMPLE_SEEDS) if read.sample else (RECIPES, read.seeds)
    missed = sum(measure(recipe, rig, seeds, sample=read.sample) for recipe, rig in chosen)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
