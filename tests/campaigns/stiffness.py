"""`python -m tests.campaigns.stiffness [--sample] [--jobs N]`: does a run find stiffness, softening and relaxation
correctly?

The twin's rubber is drawn by seed: its stiffness, the rise of load with depth, its loss per kelvin and per decade of
time. So are its growth with heat, its runout and its wear, while the software believes the rig file's figures. Each run
measures two loads at three temperatures; its table of stiffness is compared with the truth. The true depth in a
condition follows from the force on record and the twin's law of contact. Prints a line a figure and exits 1 where one
misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from math import exp, isfinite
from multiprocessing import get_context
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

from sim.physics.contact import ContactModel, Relaxation
from sim.physics.parameters import ContactParameters
from tester.analysis.deformation import WithU
from tester.base.quantities import KEY, TIME
from tester.results.run_results import results_of
from tester.results.stiffness_table import stiffness_rows
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.compiled.worker import Silent
from tests.campaigns.lives import RUBBER_EXPANSION

SEEDS, SAMPLE = 20, 2
HELD: Final = 0.9
"""Required share of seeds, and of all conditions, whose stated interval contains the truth: 18 of 20."""
AMBIENT_C: Final = 23.0
"""Of the simulated rig: its stiffness is stated at this temperature."""
WIDEST_RELAXATION, WIDEST_SOFTENING, WIDEST_STIFFNESS = 0.03, 0.004, 0.1
"""A wider interval (median of U) is useless [A]: relaxation a decade, softening 1/K, stiffness (share)."""
TOUCHING_N: Final = 5.0
"""The record's force above this counts as contact."""
RECIPE = """recipe: how stiff
specimens: [{compound: "1#"}]
measure:
  wheel_speed: 0.8 m/s
  repeats: 3
  window: 6 rev
  temperature_band: 4 degC
  soak: {within: 2 degC, for: 5 s}
grids:
  - {name: one, slip_velocity: 100 mm/s, load: [100 N, 250 N], temperature: [30 degC, 45 degC, 60 degC]}
"""


class Rubber(NamedTuple):
    """The twin's truth: N/mm at 200 N, exponent, shares of the load lost per kelvin and per decade, and the remaining
    differences from belief as overrides."""

    seed: int
    reference_n_mm: float
    exponent: float
    softening_per_k: float
    relaxation: float
    others: tuple[str, ...]

    @property
    def overrides(self) -> tuple[str, ...]:
        """Return the settings of the twin."""
        contact = {
            "reference_stiffness": f"{self.reference_n_mm:.3f}", "exponent": f"{self.exponent:.5f}",
            "softening": f"{self.softening_per_k:.6f}", "relaxation": f"{self.relaxation:.6f}",
        }  # fmt: skip
        scales = ("sim.relaxation=1", "sim.softening=1", "sim.growth=1")
        return (*scales, *(f"sim.contact.{key}={value}" for key, value in contact.items()), *self.others)


def drawn(seed: int) -> Rubber:
    """Draw a rubber, and the differences of its wear, growth and runout from the beliefs."""
    draw = Random(f"stiffness {seed}")
    others = (
        f"sim.abrasion.wear_rate={0.08 * exp(draw.uniform(-1.1, 1.1)):.4f}",
        f"sim.contact.rubber_expansion={draw.uniform(*RUBBER_EXPANSION):.6f}",
        f"sim.contact.runout={draw.uniform(0.02, 0.08):.4f}",
        f"sim.friction_heat_fraction={draw.uniform(0.2, 0.5):.3f}",
    )
    return Rubber(
        seed, draw.uniform(115.0, 180.0), draw.uniform(1.2, 1.4), draw.uniform(0.002, 0.007),
        draw.uniform(0.01, 0.06), others,
    )  # fmt: skip


class Judged(NamedTuple):
    """A value with its U, and the truth."""

    found: WithU
    truth: float

    @property
    def held(self) -> bool:
        """Return whether the interval contains the truth."""
        return abs(self.found.value - self.truth) <= self.found.expanded


class Found(NamedTuple):
    """A run's results about its rubber."""

    rubber: Rubber
    exit_code: int
    relaxation: Judged
    softening: Judged
    stiffness: tuple[Judged, ...]


def carry_out(seed: int) -> Found:
    """Run the recipe on the simulated rig and judge its table."""
    rubber = drawn(seed)
    with TemporaryDirectory(prefix="stiffness-") as name:
        recipe = Path(name) / "recipe.yaml"
        recipe.write_text(RECIPE, encoding="utf-8")
        screen = Silent()
        session = Session(
            SessionOptions(str(recipe), overrides=rubber.overrides, out=Path(name) / "runs", seed=seed), screen
        )
        code = session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            rows = stiffness_rows(results_of(reader), reader)
            true_n_mm = true_stiffness(reader, rubber)
    if not rows:
        nothing = Judged(WithU(), rubber.relaxation)
        return Found(rubber, code, nothing, nothing, ())
    whole = rows[0].rubber
    stiffness = [Judged(row.here.stiffness_n_mm, true_n_mm[row.measured.info.condition]) for row in rows]
    return Found(
        rubber, code, Judged(whole.relaxation, rubber.relaxation),
        Judged(whole.softening_per_k, rubber.softening_per_k), tuple(stiffness),
    )  # fmt: skip


def true_stiffness(reader: RunReader, rubber: Rubber) -> dict[int, float]:
    """Return load over true depth in each condition, N/mm: the twin's contact under the force on record."""
    parameters = ContactParameters(reference_stiffness=rubber.reference_n_mm, exponent=rubber.exponent)
    factor, lost = ContactModel(parameters).factor, Relaxation(rubber.relaxation)
    of_repeat = {repeat.key: repeat.condition for repeat in reader.repeats(attempts=True)}
    sums: dict[int, list[float]] = {}
    before_s = dt_s = 0.0
    for block in reader.sample_blocks():
        columns = block.columns
        for t_s, key, force_n, surface_c, hub_c in zip(
            columns[TIME], columns[KEY], columns["force_z_n"], columns["surface_c"], columns["hub_c"], strict=True
        ):
            passed_s, before_s = t_s - before_s, t_s
            if not force_n > TOUCHING_N:
                lost.rest(passed_s)
                continue
            if abs(passed_s - dt_s) > 1e-6:
                dt_s = passed_s
                lost.retime(dt_s)
            elastic_n = force_n + lost.lost_n
            lost.load_n(elastic_n)
            share = exp(-rubber.softening_per_k * (0.5 * (surface_c + hub_c) - AMBIENT_C))
            condition = of_repeat.get(round(key), 0)
            if condition and isfinite(share):
                each = sums.setdefault(condition, [0.0, 0.0])
                each[0] += force_n
                each[1] += (elastic_n / (factor * share)) ** (1.0 / rubber.exponent)
    return {condition: force_n / depth_mm for condition, (force_n, depth_mm) in sums.items()}


def figures(found: Sequence[Found]) -> Iterator[tuple[str, bool]]:
    """Yield every figure in words, and whether it passes."""
    ended = sum(one.exit_code == 0 for one in found)
    yield f"runs that ended in order: {ended} of {len(found)} (asked: all)", ended == len(found)
    for name, listed, widest in (
        ("relaxation a decade", [one.relaxation for one in found], WIDEST_RELAXATION),
        ("softening 1/K", [one.softening for one in found], WIDEST_SOFTENING),
    ):
        held, least = sum(one.held for one in listed), int(HELD * len(listed))
        yield f"{name}: in the stated interval in {held} of {len(listed)} (asked: {least})", held >= least
        wide = median(one.found.expanded for one in listed)
        yield f"{name}: median of U {wide:.4f} (asked: at most {widest:g})", wide <= widest
    every = [one for run in found for one in run.stiffness]
    held, least = sum(one.held for one in every), int(HELD * len(every))
    yield f"stiffness of conditions: in the stated interval {held} of {len(every)} (asked: {least})", held >= least > 0
    if every:
        wide = median(one.found.expanded / one.truth for one in every)
        text = f"stiffness: median of U {100.0 * wide:.1f} % (asked: at most {100.0 * WIDEST_STIFFNESS:g} %)"
        yield text, wide <= WIDEST_STIFFNESS


def run_text(one: Found) -> str:
    """Return a run as a line."""
    parts = [f"seed {one.rubber.seed:2}:"]
    for name, judged in (("relaxation", one.relaxation), ("softening", one.softening)):
        off = "" if judged.held else " OUTSIDE"
        parts.append(f"{name} {judged.found.value:.4f} +- {judged.found.expanded:.4f} (true {judged.truth:.4f}){off};")
    worst = max(one.stiffness, key=lambda each: abs(each.found.value / each.truth - 1.0), default=None)
    if worst is not None:
        held = sum(each.held for each in one.stiffness)
        off = 100.0 * (worst.found.value / worst.truth - 1.0)
        u = 100.0 * worst.found.expanded / worst.truth
        parts.append(f"stiffness held {held} of {len(one.stiffness)}, at most {off:+.1f} % off with U {u:.1f} %")
    return " ".join(parts)


def main(arguments: list[str] | None = None) -> int:
    """Run everything; return 1 if a figure misses."""
    about = (__doc__ or "").partition("\n")[2]
    parser = argparse.ArgumentParser("python -m tests.campaigns.stiffness", description=about)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} seeds instead of {SEEDS}")
    parser.add_argument("--seed", type=int, default=1, help="the first (default 1)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    read = parser.parse_args(arguments)
    seeds = range(read.seed, read.seed + (SAMPLE if read.sample else SEEDS))
    found: list[Found] = []
    with ProcessPoolExecutor(read.jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(carry_out, seeds):
            found.append(one)
            print(f"   {run_text(one)}", flush=True)
    missed = 0
    for text, kept in figures(found):
        missed += not kept
        print(f"{'ok  ' if kept else 'MISS'} {text}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
