"""`python -m tests.campaigns.leaps [--sample] [--seeds N] [RECIPE ...]`: compares runs with leaps to the same runs with
every scan.

Wheels and specimens on a track, with all noise and scatter; each seed also draws the rig's difference from its file
(wear, diameter, heat). A condition differs in its coefficient, in its temperature, or by being kept in one run and lost
in the other.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from random import Random
from statistics import median
from time import process_time
from typing import NamedTuple

import recipes
from tester.machine.run import Outcome
from tests.campaigns.time_left.cases import truth as wheel_truth
from tests.campaigns.track import FASTER, SAMPLED
from tests.tester.kinds.specimen_on_track.bench import TrackBench, one_track
from tests.tester.kinds.wheel_on_belt.bench import Simulation

WHEEL = "wheel"

SEEDS, SAMPLE_SEEDS = 20, 2
RECIPES = (("quickstart", WHEEL), ("grosch", "grosch"), ("pin-on-disc", "pin-on-disc"))
"""Recipes and their rigs, ..."""
WAITING = (WHEEL, "grosch")
"""... those that wait while only heat flows: a wheel rests and cools, a chamber tempers."""
MOST_PERCENT, MOST_K = 0.02, 0.05
"""Maximum difference of a coefficient and of its temperature."""
TWO = "0 degC, 30 degC"
"""Temperatures of the sample."""
LOST_IN = 500
"""In so many conditions, one may be kept in one run and lost in the other."""

Repeats = dict[tuple[int, int], tuple[float, float]]
"""Coefficient and temperature (degC) of valid repeats, by condition and place in the order of measuring."""


class Ended(NamedTuple):
    """A finished run."""

    repeats: Repeats
    done: bool
    """Whether it ended as planned, without a trip."""
    leapt_s: float
    cpu_s: float


def truth(rig: str, seed: int) -> tuple[str, ...]:
    """Return the differences, drawn for a seed, between a rig and what its file and recipes assume."""
    if rig == WHEEL:
        return wheel_truth("sim", seed)
    drawn = Random(f"truth {seed}").uniform
    return (
        f"sim.heat.chamber_rate={0.06 * drawn(0.8, 1.2):.4f} K/s",
        f"sim.heat.chamber_time={1800.0 * drawn(0.8, 1.2):.0f} s",
        f"sim.heat.specimen_time={300.0 * drawn(0.8, 1.2):.1f} s",
        f"sim.heat.friction_share={0.1 * drawn(0.5, 2.0):.4f}",
        f"sim.contact.wear={0.0005 * drawn(0.5, 3.0):.5f} mm/m",
        f"sim.ambient={23.0 + drawn(-3.0, 3.0):.2f} degC",
    )


def run_of(rig: str, text: str, seed: int, *, leaps: bool) -> Ended:
    """Run a recipe in this process."""
    began_s = process_time()
    if rig == WHEEL:
        wheel = Simulation(text, truth(rig, seed), seed=seed)
        run = (wheel.leaping() if leaps else wheel).to_the_end(1e6).run
        repeats, tripped = of_wheel(wheel), bool(wheel.notes.texts("trip"))
    else:
        track = TrackBench(rig, text, truth(rig, seed), seed)
        run = (track.leaping() if leaps else track).to_the_end().run
        repeats, tripped = of_track(track), bool(track.kept.trips)
    done = run.outcome is Outcome.DONE and not tripped
    return Ended(repeats, done, run.engine.leapt_s, process_time() - began_s)


def of_track(bench: TrackBench) -> Repeats:
    """Return the valid repeats of a run on a track."""
    kept = enumerate(bench.kept.results)
    return {(c, place): (one.mu_resultant, one.means["contact_c"]) for place, (c, one) in kept if one.valid}


def of_wheel(bench: Simulation) -> Repeats:
    """Return the valid repeats of a run on a wheel."""
    conditions = [row["condition"] for row in bench.notes.fields("INSERT INTO repeat (")]
    rows = [row for row in bench.notes.fields("UPDATE repeat SET") if "mu_resultant" in row]
    found: Repeats = {}
    for place, (condition, row) in enumerate(zip(conditions, rows, strict=True)):
        if not row["reason"]:
            mu, surface_c = row["mu_resultant"], row["surface_c"]
            assert isinstance(condition, int) and isinstance(mu, float) and isinstance(surface_c, float)
            found[condition, place] = mu, surface_c
    return found


def compare(every: Repeats, leapt: Repeats) -> tuple[list[tuple[float, float]], int]:
    """Return how far each repeat differs, in per cent and K, and how many are in one run only."""
    both = every.keys() & leapt.keys()
    apart = [
        (100.0 * abs(leapt[key][0] / every[key][0] - 1.0), abs(leapt[key][1] - every[key][1])) for key in sorted(both)
    ]
    return apart, len(every.keys() ^ leapt.keys())


def measure(recipe: str, rig: str, seeds: int, *, sample: bool) -> int:
    """Run a packaged recipe with some seeds; print the figures, return how many miss."""
    text = Path(recipes.find(recipe)).read_text(encoding="utf-8")
    if sample and rig != WHEEL:
        text = one_track(text).replace(SAMPLED[0], TWO).replace(FASTER, "")
    apart, lost, unfinished, leapt_s = list[tuple[float, float]](), 0, 0, 0.0
    ratios = list[float]()
    for seed in range(seeds):
        every, leapt = (run_of(rig, text, seed, leaps=leaps) for leaps in (False, True))
        rows, missing = compare(every.repeats, leapt.repeats)
        apart, lost, unfinished = apart + rows, lost + missing, unfinished + (not every.done or not leapt.done)
        leapt_s += leapt.leapt_s
        ratios.append(every.cpu_s / leapt.cpu_s)
    percent, kelvin = (max((row[i] for row in apart), default=float("inf")) for i in (0, 1))
    figures = [
        (f"runs of {seeds} seeds not finished, or tripped", f"{unfinished}", "0", unfinished == 0),
        (f"coefficient, worst of {len(apart)}", f"{percent:.4f} %", f"<= {MOST_PERCENT:g} %", percent <= MOST_PERCENT),
        ("temperature, worst", f"{kelvin:.4f} K", f"<= {MOST_K:g} K", kelvin <= MOST_K),
        ("repeats in one run only", f"{lost}", f"1 in {LOST_IN}", lost * LOST_IN <= len(apart)),
        ("leapt", f"{leapt_s:.0f} s", "some where a run waits", leapt_s > 0.0 or rig not in WAITING),
    ]
    for name, value, asked, met in figures:
        print(f"{'ok  ' if met else 'MISS'} {recipe}: {name}: {value} (asked: {asked})", flush=True)
    print(f"     {recipe}: processor time with every scan, over that with leaps: {median(ratios):.2f}", flush=True)
    return sum(not met for *_, met in figures)


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.leaps", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SEEDS} seeds of the first recipes, cut short")
    parser.add_argument("--seeds", type=int, metavar="N", help=f"seeds ({SEEDS})")
    names = [recipe for recipe, _ in RECIPES]
    parser.add_argument("recipes", nargs="*", metavar="RECIPE", help=f"{', '.join(names)} (all)")
    read = parser.parse_args(arguments)
    if unknown := sorted({*read.recipes} - {*names}):
        parser.error(f"no recipe {unknown[0]!r}; there are: {', '.join(names)}")
    chosen = tuple(one for one in RECIPES if one[0] in read.recipes) or (RECIPES[:2] if read.sample else RECIPES)
    seeds = SAMPLE_SEEDS if read.sample and read.seeds is None else read.seeds or SEEDS
    missed = sum(measure(recipe, rig, seeds, sample=read.sample) for recipe, rig in chosen)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
