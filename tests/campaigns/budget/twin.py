"""Do the intervals of runs on the simulated rig contain the rig's truth, with wrong beliefs?

One condition a seed, on two wheels: all rows of a run share the session, so seeds are counted, not rows. Wheels wear
three times as fast as believed, heat and belt differ by 30 % from control's assumptions, and a session draws the
imperfections of its sensors. The truth of this wheel is model x condition x wheel; that of the compound in this
condition is model x condition, as the rig itself records (``sim.record_truth``), without the scatter of repeats.

How often are the two wheels of a run, of one compound, called different? Runs of two seeds cannot be compared this way:
the seed also draws the model's error for a compound in a condition.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.analysis.difference import difference
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.sweep.case import Unseen
from tester.store.run_reader import RunReader

WRONG_BELIEFS = (
    "sim.wear=3",
    "sim.friction_heat_fraction=0.078",
    "sim.belt_conductance=0.078 W/K",
    "sim.record_truth=true",
)
CONDITIONS = (
    ("1#", 200, 300, 40, "never"), ("3#", 200, 300, 55, "never"), ("1#", 200, 100, 55, "each_condition"),
    ("2#", 100, 300, 25, "never"), ("1#", 300, 300, 70, "never"), ("2#", 400, 100, 70, "each_condition"),
)  # fmt: skip
"""Compound, load N, slip mm/s, temperature degC, checks of the diameter, in turns: at 100 mm/s a diameter matters."""
RECIPE = """recipe: true or not
specimens: [{{compound: "{0}"}}]
replicates: 2
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}}
rest: {{at_least: 20 min, until: 25 degC, within: 2 degC}}
measure: {{wheel_speed: 0.8 m/s, repeats: 3, window: 30 rev, temperature_band: 2 degC,
  wear_check: {4}}}
grids:
  - {{name: one, slip_velocity: {2} mm/s, load: {1} N, temperature: {3} degC}}
"""


@dataclass(frozen=True, slots=True)
class Held:
    """The result of one seed: error of the first wheel's value in per cent, and whether each U contains the truth."""

    seed: int
    condition: tuple[str, int, int, int, str]
    off_percent: float
    u_percent: float
    this: bool
    compound: bool
    both: bool
    """Whether U of the mean of both wheels contains the compound's truth."""
    wheels_differ: bool
    """Whether the two wheels are called different."""


def held(seeds: int, jobs: int = 1) -> Iterator[Held]:
    """Yield the result of each seed that has values."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from (one for one in pool.map(_of_seed, range(seeds)) if one is not None)


def _of_seed(seed: int) -> Held | None:
    with TemporaryDirectory() as name:
        return _run(Path(name), seed, CONDITIONS[seed % len(CONDITIONS)])


def _run(folder: Path, seed: int, condition: tuple[str, int, int, int, str]) -> Held | None:
    recipe = folder / "recipe.yaml"
    recipe.write_text(RECIPE.format(*condition), encoding="utf-8")
    screen = Unseen()
    options = SessionOptions(str(recipe), "sim", out=folder / "runs", seed=seed, overrides=WRONG_BELIEFS, samples=False)
    session = screen.session = Session(options, screen)
    session.run()
    if session.folder is None:
        raise RuntimeError(f"the run did not begin: {' '.join(screen.messages)}")
    with RunReader(session.folder) as reader:
        (row,) = results_of(reader).rows
    first, second = (measured.result for measured in row.replicates)
    if not (first.ok and second.ok):
        return None
    with closing(sqlite3.connect(session.folder / "run.db")) as database:
        number = row.replicates[0].info.condition
        true = dict(database.execute("SELECT name, value FROM truth WHERE condition = ?", [number]))
    compound = true["model"] * true["condition"]
    this = compound * true["wheel"]
    return Held(
        seed,
        condition,
        100.0 * (first.mu / this - 1.0),
        100.0 * first.budget.expanded / this,
        abs(first.mu - this) <= first.budget.expanded,
        abs(first.mu - compound) <= first.compound_budget.expanded,
        abs(row.result.mu - compound) <= row.result.compound_budget.expanded,
        difference(first, second, same_rig=True).told_apart,
    )
