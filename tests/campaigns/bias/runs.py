"""Runs on the simulated rig whose coefficients are compared with the rig's own truth.

A compound at a temperature is one run: three loads in both directions of slip, and one further load in one direction.
The wheel wears three times as fast as believed, heat and belt differ by 30 % from control's assumptions, and the cell's
channels have errors of sensitivity of up to 0.5 % [A]. Each seed runs twice, the second time with mirrored sensor
errors. The known deviation of each repeat (``sim.record_truth``) is subtracted: the session's error and noise remain.
"""

from __future__ import annotations

import sqlite3
from collections import defaultdict
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

from tester.results.run_results import results_of
from tester.results.table_rows import Measured
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.sweep.case import Unseen
from tester.store.run_reader import RunReader
from tests.campaigns.budget.twin import WRONG_BELIEFS

COMPOUNDS, TEMPERATURES_C, LOADS_N = ("1#", "2#", "3#"), (25, 55, 85), (100, 200, 300)
OVERRIDES: Final = (*WRONG_BELIEFS, "sim.sensors.cell_sensitivity=0.5 %", "sim.running_in=0")
HOT: Final = ("sim.friction_heat_fraction=0.5", "sim.belt_conductance=0.3 W/K")
"""The rig that friction warms fast: a condition that cannot be held there has no value."""
ONE_WAY_MM_S, BOTH_MM_S, ONE_WAY_N = 205, 200, 200
"""Slip of the one-direction condition; it differs from the others' because a condition is measured in one way only."""
RECIPE = """recipe: bias
specimens: [{{compound: "{0}"}}]
measure:
  {{wheel_speed: 0.8 m/s, repeats: 3, window: 10 rev, temperature_band: 2 degC, soak: {{within: 1 K, for: 20 s}}}}
grids:
  - {{name: both, slip_velocity: {2} mm/s, load: [100 N, 200 N, 300 N], temperature: {1} degC, both_directions: true}}
  - {{name: one way, slip_velocity: {3} mm/s, load: {4} N, temperature: {1} degC}}
"""


class Case(NamedTuple):
    """One run to make."""

    compound: str
    temperature_c: int
    seed: int
    mirrored: bool
    hot: bool = False


class Cell(NamedTuple):
    """A compound at a temperature and a load, in both directions or in one."""

    compound: str
    temperature_c: int
    load_n: int
    both: bool

    def __str__(self) -> str:
        """Return it as text."""
        return f"{self.compound}, {self.temperature_c} degC, {self.load_n} N"


@dataclass(frozen=True, slots=True)
class Off:
    """Error of a coefficient, per cent, and the largest of the instruments' terms in its budget."""

    cell: Cell
    seed: int
    percent: float
    largest: str
    status: str


def run(case: Case) -> tuple[Case, list[Off]]:
    """Make one run; return the results of its conditions."""
    with TemporaryDirectory(prefix="bias-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        recipe = folder / "recipe.yaml"
        held = case.compound, case.temperature_c, BOTH_MM_S, ONE_WAY_MM_S, ONE_WAY_N
        recipe.write_text(RECIPE.format(*held), encoding="utf-8")
        overrides = (*OVERRIDES, *(HOT if case.hot else ()), f"sim.mirrored={str(case.mirrored).lower()}")
        screen = Unseen()
        options = SessionOptions(str(recipe), "sim", out=folder / "runs", seed=case.seed, overrides=overrides,
                                 samples=False)  # fmt: skip
        session = screen.session = Session(options, screen)
        session.run()
        if session.folder is None:
            raise RuntimeError(f"the run did not begin: {' '.join(screen.messages)}")
        with RunReader(session.folder) as reader:
            measured = list(results_of(reader).conditions())
        return case, list(_judged(case, measured, session.folder / "run.db"))


def _judged(case: Case, measured: list[Measured], record: Path) -> Iterator[Off]:
    known: dict[tuple[int, int, int], dict[str, float]] = defaultdict(dict)
    with closing(sqlite3.connect(record)) as database:
        for condition, repeat, attempt, name, value in database.execute(
            "SELECT condition, repeat, attempt, name, value FROM truth"
        ):
            known[condition, repeat, attempt][name] = value
    for one in measured:
        info, r = one.info, one.result
        cell = Cell(case.compound, case.temperature_c, round(info.setpoint.number("load")), info.both_directions)
        if not r.ok:
            yield Off(cell, case.seed, float("nan"), "", f"{r.status.value}: {r.reason}")
            continue
        truths = [known[repeat.target] for repeat in one.repeats if not one.exclusion(repeat)]
        true = sum(t["model"] * t["condition"] * t["wheel"] * t["run"] for t in truths) / len(truths)
        chain = [term for term in r.budget.contributions if term.common]
        largest = max(chain, key=lambda term: term.standard).name
        yield Off(cell, case.seed, 100.0 * (r.mu / true - 1.0), largest, "ok")
