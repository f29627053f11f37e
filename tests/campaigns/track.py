"""`python -m tests.campaigns.track [--sample] [--seeds N]`: a specimen on a track against its law, over seeds.

The friction's scatter from specimen to specimen and the biases of air sensor and pyrometer are switched off, the noise
of the sensors is on: a row's difference from the law then comes from procedures, reduction and sensors. The law is
evaluated at the specimen's true mean temperature; the row's temperature (on the disc, less the excess of the track over
the specimen there) is compared with it separately. The seeds of grosch take each of Grosch's four rubbers in turn.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from math import inf
from pathlib import Path
from statistics import median
from time import process_time
from typing import NamedTuple

import recipes
from sim.physics.laws import LawSetting
from tester.kinds.specimen_on_track.axes import held_by
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import FOUR_RUBBERS, TrackBench, one_track, with_rubber

SEEDS, SAMPLE_SEEDS = 8, 4
MOST_PERCENT = 0.25
"""Maximum difference of a coefficient from the law: settling to 0.5 % a stretch."""
MOST_K = 0.1
"""Maximum error of a temperature: a step of the chamber's readings."""
RIGHT = ("sim.scatter=0", "sim.sensors.air_bias=0", "sim.sensors.pyrometer_bias=0")
SAMPLED = ("-40 degC, -30 degC, -20 degC, -10 degC, 0 degC, 10 degC, 20 degC, 30 degC, 40 degC, 50 degC, 60 degC",
           "-10 degC, 20 degC, 50 degC")  # fmt: skip
FASTER = "1e-6 m/s, 3.162e-6 m/s, "
"""The two slowest speeds take four fifths of the time: left out of the sample."""


class Row(NamedTuple):
    """A repeat: its coefficient beside the law at the true temperature, %, and its temperature beside the truth, K."""

    words: str
    percent: float
    kelvin: float


class Truth:
    """A whole run, and the true mean temperature of the specimen in each of its repeats."""

    def __init__(self, bench: TrackBench) -> None:
        """Run it; uses the scans that count for a repeat."""
        self.bench, ctx = bench, bench.run.engine.ctx
        self._sums: dict[int, tuple[int, float]] = {}
        while not bench.run.finished:
            bench.tick()
            if ctx.burst and ctx.gate == 0:
                count, sum_c = self._sums.get(repeat := len(bench.kept.results), (0, 0.0))
                self._sums[repeat] = count + 1, sum_c + bench.world.plant.specimen_c

    def rows(self) -> Iterator[Row]:
        """Yield each repeat beside the truth."""
        bench, sim = self.bench, self.bench.config.sim
        steps = {step.condition: step for step in bench.plan.conditions()}
        for repeat, (condition, result) in enumerate(bench.kept.results):
            held = held_by(steps[condition].setpoint)
            dry = sim.friction_of(steps[condition].setpoint.compound, LawSetting(surface=held.surface))
            law = sim.contact.through(dry, held.interface)  # type: ignore[arg-type]
            count, sum_c = self._sums[repeat]
            true_c, read_c = sum_c / count, result.means["contact_c"]
            if not bench.config.chamber:
                read_c -= sim.heat.exit_rise * result.means["friction_n"] * held.track_m_s
            percent = 100.0 * (result.mu_resultant / law.mu(true_c, held.load_n, held.track_m_s) - 1.0)
            yield Row(f"{held}", percent, read_c - true_c)


def measure(rig: str, seeds: int, *, sample: bool) -> int:
    """Run a packaged recipe with some seeds; print the figures, return how many miss."""
    text = Path(recipes.find(rig)).read_text(encoding="utf-8")
    if rig == "grosch" and sample:
        text = one_track(text)
    if sample:
        text = text.replace(*SAMPLED).replace(FASTER, "")
    missed, found, valid, wanted = 0, list[Row](), 0, 0
    began_s = process_time()
    for seed in range(seeds):
        own = with_rubber(text, FOUR_RUBBERS[seed % len(FOUR_RUBBERS)]) if rig == "grosch" else text
        truth = Truth(bench := TrackBench(rig, own, RIGHT, seed))
        wanted += sum(step.repeats for step in bench.plan.conditions())
        valid += sum(result.valid for _, result in bench.kept.results)
        if bench.run.outcome is not Outcome.DONE or bench.kept.trips:
            missed += 1
            print(f"MISS {rig}, seed {seed}: {bench.run.outcome.value}: {bench.run.reason} (asked: done, no trip)")
        for row in truth.rows():
            found.append(row)
            if abs(row.percent) > MOST_PERCENT or abs(row.kelvin) > MOST_K:
                print(f"     {rig}, seed {seed}: {row.words} {row.percent:+.3f} %, {row.kelvin:+.3f} K")
    off = [abs(row.percent) for row in found] or [inf]
    off_k = [abs(row.kelvin) for row in found] or [inf]
    figures = [(f"repeats of {seeds} seeds", f"{valid} of {wanted}", "all", valid == wanted)]
    figures += [("off the law, median", f"{median(off):.3f} %", "no limit", True)]
    figures += [("off the law, worst", f"{max(off):.3f} %", f"<= {MOST_PERCENT:g} %", max(off) <= MOST_PERCENT)]
    figures += [("temperature, worst", f"{max(off_k):.3f} K", f"<= {MOST_K:g} K", max(off_k) <= MOST_K)]
    for name, value, asked, met in figures:
        missed += not met
        print(f"{'ok  ' if met else 'MISS'} {rig}: {name}: {value} (asked: {asked})", flush=True)
    print(f"     {rig}: processor time: {process_time() - began_s:.0f} s", flush=True)
    return missed


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.track", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SEEDS} seeds, three temperatures, seven speeds")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"seeds ({SEEDS})")
    read = parser.parse_args(arguments)
    seeds = SAMPLE_SEEDS if read.sample else read.seeds
    missed = measure("pin-on-disc", seeds, sample=False)
    missed += measure("grosch", seeds, sample=read.sample)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
