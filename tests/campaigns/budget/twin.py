"""Do the intervals of runs on the simulated rig hold what the rig knows to be true, with beliefs that are wrong?

One condition a seed: wheel and session are shared by the conditions of a run, so that seeds are counted, not rows. The
wheel wears three times as fast as believed, heat and belt differ by 30 % from what control reckons with, and a session
draws the imperfections of its sensors. True of this wheel is model x condition x wheel, of the compound in this
condition model x condition, as the rig itself tells (``sim.record_truth``), without what one repeat differs by.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.export.results import results_of
from tester.run.session import Session, SessionOptions
from tester.store.reader import RunReader
from tester.sweep.case import Unseen

WRONG_BELIEFS = (
    "sim.wear=3",
    "sim.friction_heat_fraction=0.078",
    "sim.belt_conductance=0.078 W/K",
    "sim.record_truth=true",
)
CONDITIONS = (("1#", 200, 300, 40), ("3#", 200, 300, 55), ("2#", 100, 300, 25), ("1#", 300, 300, 70))
"""Compound, load N, slip mm/s, temperature degC, in turns."""
RECIPE = """recipe: true or not
specimens: [{{compound: "{0}"}}]
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}}
rest: {{at_least: 20 min, until: 25 degC, within: 2 degC}}
measure: {{wheel_speed: 0.8 m/s, repeats: 3, window: 30 rev, temperature_band: 2 degC}}
grids:
  - {{name: one, slip_velocity: {2} mm/s, load: {1} N, temperature: {3} degC}}
"""


@dataclass(frozen=True, slots=True)
class Held:
    """What became of one seed: per cent by which the value is off this wheel's truth, and whether U holds each."""

    seed: int
    condition: tuple[str, int, int, int]
    off_percent: float
    u_percent: float
    this: bool
    compound: bool


def held(seeds: int) -> Iterator[Held]:
    """Yield what became of each seed that has a value."""
    for seed in range(seeds):
        condition = CONDITIONS[seed % len(CONDITIONS)]
        with TemporaryDirectory() as name:
            found = _run(Path(name), seed, condition)
        if found is not None:
            yield found


def _run(folder: Path, seed: int, condition: tuple[str, int, int, int]) -> Held | None:
    recipe = folder / "recipe.yaml"
    recipe.write_text(RECIPE.format(*condition), encoding="utf-8")
    screen = Unseen()
    options = SessionOptions(str(recipe), "sim", out=folder / "runs", seed=seed, overrides=WRONG_BELIEFS)
    session = screen.session = Session(options, screen)
    session.run()
    if session.folder is None:
        raise RuntimeError(f"the run did not begin: {' '.join(screen.said)}")
    with RunReader(session.folder) as reader:
        (row,) = results_of(reader).rows
    if not row.result.ok:
        return None
    with closing(sqlite3.connect(session.folder / "run.db")) as database:
        true = dict(database.execute("SELECT name, value FROM truth"))
    compound = true["model"] * true["condition"]
    this, r = compound * true["wheel"], row.result
    return Held(
        seed,
        condition,
        100.0 * (r.mu_corrected / this - 1.0),
        100.0 * r.expanded / this,
        abs(r.mu_corrected - this) <= r.expanded,
        abs(r.mu_corrected - compound) <= r.compound_budget.expanded,
    )
