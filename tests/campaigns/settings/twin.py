"""Runs on the simulated rig that measure one setting four times, on two wheels, with wrong beliefs.

In each seed the believed wear has an error within its range (0.02 to 0.3 mm3/(N m) where 0.08 is believed, evenly in
its logarithm), the diameter of up to the 0.15 mm of its term, heat and belt of up to 30 %. Two measurements on one
wheel truly do not differ; those of two wheels differ only by the wheels themselves. In a changed run friction steps by
8 %, up or down by turns, as the second measurement on the first wheel begins, and is back for the second wheel.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import exp, log
from multiprocessing import get_context
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.compiled.worker import Silent

MEASUREMENTS = 4
STEP_PERCENT = 8.0
BELIEVED_WEAR, WEAR = 0.08, (0.02, 0.3)
"""The packaged rig's belief of the wear rate, and its range, mm3/(N m)."""
DIAMETER_MM, NEW_MM = 0.15, 90.0
OFF = 0.3
"""Maximum error of heat and belt, as a share."""
RECIPE = """recipe: one setting, four times
specimens: [{compound: "1#"}]
replicates: 2
measure:
  wheel_speed: 0.8 m/s
  repeats: 8
  window: 6 rev
  temperature_band: 3 degC
  soak: {within: 1.5 degC, for: 10 s}
grids:
  - {name: first, slip_velocity: 300 mm/s, load: 200 N, temperature: 30 degC}
  - {name: again, measure_again: true, slip_velocity: 300 mm/s, load: 200 N, temperature: 30 degC}
"""


@dataclass(frozen=True, slots=True)
class SettingCase:
    """A run to make; ``changed``: friction steps in it."""

    seed: int
    changed: bool


@dataclass(frozen=True, slots=True)
class SettingFound:
    """A run's result for its setting; differences in per cent with U, on the first wheel and between wheels."""

    case: SettingCase
    measurements: int
    disagrees: bool
    stands_out: int
    """Number of the condition that stands out most, 0 if none."""
    chi2: float
    limit: float
    on_one: tuple[float, float]
    between: tuple[float, float]

    @property
    def whole(self) -> bool:
        """Return whether all four measurements have a value."""
        return self.measurements == MEASUREMENTS


def beliefs(seed: int) -> tuple[str, ...]:
    """Return the differences between a seed's simulated rig and the beliefs about it, as overrides."""
    random = Random(f"one setting {seed}")
    wear = exp(random.uniform(*map(log, WEAR))) / BELIEVED_WEAR
    heat, belt = (random.uniform(1.0 - OFF, 1.0 + OFF) for _ in range(2))
    return (
        "sim.running_in=0",
        f"sim.wear={wear:.4f}",
        f"sim.friction_heat_fraction={0.06 * heat:.4f}",
        f"sim.belt_conductance={0.06 * belt:.4f} W/K",
    )


def faults(case: SettingCase) -> tuple[str, ...]:
    """Return a run's faults: a wheel of another diameter, and stepping friction."""
    off_mm = Random(f"diameter {case.seed}").uniform(-DIAMETER_MM, DIAMETER_MM)
    found = [f"t=0 s: wheel diameter {100.0 * (1.0 + off_mm / NEW_MM):.4f} %"]
    if case.changed:
        sign = 1.0 if case.seed % 2 else -1.0
        found.append(f"condition 2: friction {100.0 + sign * STEP_PERCENT:g} %")
    return tuple(found)


def found_of(cases: Sequence[SettingCase], jobs: int) -> Iterator[SettingFound]:
    """Yield each run's result."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield from pool.map(carry_out, cases)


def carry_out(case: SettingCase) -> SettingFound:
    """Run the recipe on the simulated rig."""
    with TemporaryDirectory(prefix="settings-") as name:
        recipe = Path(name) / "recipe.yaml"
        recipe.write_text(RECIPE, encoding="utf-8")
        screen = Silent()
        options = SessionOptions(
            str(recipe), out=Path(name) / "runs", seed=case.seed, overrides=beliefs(case.seed), faults=faults(case),
            samples=False,
        )  # fmt: skip
        session = Session(options, screen)
        session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            (setting,) = results_of(reader).settings
    judged = setting.found
    if judged is None or len(judged.measurements) < MEASUREMENTS:
        return SettingFound(case, len(setting.measurements), False, 0, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0))
    pairs = [
        (100.0 * off.value / first.mu, 100.0 * off.expanded / first.mu) for first, _, off in setting.differences()
    ]
    out = judged.measurements[judged.outstanding].condition if judged.outstanding is not None else 0
    return SettingFound(
        case, len(judged.measurements), setting.disagrees, out, judged.chi2, judged.limit, pairs[0], pairs[1]
    )
