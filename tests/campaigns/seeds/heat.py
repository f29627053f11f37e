"""Rigs whose heat differs from their file's beliefs, over successive runs: a history must not cause false trips.

A run's record of its heatings is handed to the next run on the same rig, as the store does. Only real rigs can have air
colder or warmer than believed: a simulated one knows its air, so twin and belief are two rigs here.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Final

import recipes as shipped
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY, KnownRatio
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.kinds.wheel_on_belt.run.past_runs import KIND, known_from, ratios_of
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import run_simulated
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tests.campaigns.acceptance.figure import Figure, equal, holds
from tests.campaigns.seeds.sweeps import Sweeps
from tests.tester.inputs.recipe.texts import load_recipe

HOT: Final = """\
recipe: hot
specimens: [{compound: "3#"}]
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 10 rev
  temperature_band: 2 degC
  soak: {within: 2 degC, for: 60 s}
grids:
  - name: temperature
    slip_velocity: 200 mm/s
    load: 300 N
    temperature: [40 degC, 62 degC, 85 degC]
"""
"""Three heatings up to the hottest surface: its first run makes a history."""
UNLIKE: Final = {
    "as believed": (),
    "hub capacity -25 %": ("sim.thermal.hub_capacity=315 J/K",),
    "hub capacity +25 %": ("sim.thermal.hub_capacity=525 J/K",),
    "heater power -20 %": ("observer.thermal.jacket_power=250 W",),
    "air 6 K colder": ("sim.ambient=17 degC",),
    "air 6 K warmer": ("sim.ambient=29 degC",),
    "losses +15 %": (
        "sim.thermal.film_rotating=16.1 W/(m2 K)", "sim.thermal.film_sides=9.2 W/(m2 K)",
        "sim.thermal.hub_to_shaft=0.1725 W/K", "sim.belt_conductance=0.069 W/K",
    ),
}  # fmt: skip
"""Differences of the twin's heat (``sim``) from the file's belief, or other beliefs (``observer``). An air error of 8 K
trips "surface off model" before anything is heated. Losses of +20 % at 85 degC trip "hub hotter than shown": they look
like a hub sensor and a thermometer that both read low."""

SAMPLED: Final = ("as believed", "hub capacity -25 %", "heater power -20 %", "losses +15 %")
"""Lives of a sample. Each of the others learns a ratio that is near that of one of these."""


class HeatRecorder(NullRecorder):
    """Stores a run's heat data and trips."""

    def __init__(self) -> None:
        super().__init__()
        self.heatings: list[str] = []
        self.trips: list[str] = []

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Store the data of a heating."""
        if kind == KIND and data:
            self.heatings.append(data)

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = 0.0, limit: float = 0.0, unit: str = ""
    ) -> int:
        """Store the row and the values it compared."""
        self.trips.append(f"{interlock} at {t_s:.0f} s ({value:.3g}, limit {limit:.3g} {unit})")
        return len(self.trips)


@dataclass(frozen=True, slots=True)
class Life:
    """Successive runs of one rig: its trips, each with its run, and the knowledge at the last."""

    name: str
    seed: int
    trips: tuple[str, ...]
    known: KnownRatio
    share: float


def live(name: str, seed: int) -> Life:
    """Run the hot recipe, the quickstart, and the hot recipe again, on a rig that differs from its file."""
    rig = load_rig("sim", [one for one in UNLIKE[name] if one.startswith("observer.")])
    twin = load_rig("sim", UNLIKE[name])
    known, ratios, trips = NO_HISTORY, list[float](), list[str]()
    quickstart = shipped.find("quickstart").read_text(encoding="utf-8")
    for number, text in enumerate((HOT, quickstart, HOT), start=1):
        ports, world, attendant = simulated_ports(twin, 10 * seed + number, None)
        recorder = HeatRecorder()
        known = known_from(ratios, rig)
        plan = expand(load_recipe(text, PART, "heat.yaml").recipe, rig)
        run = build_run(RunSetup(rig, plan, ports, attendant, recorder, Prompts(automatic=True)), known)
        run_simulated(run, world, lapse=None, poll=lambda _now_s: None)
        trips += (f"run {number}: {trip}" for trip in recorder.trips)
        if not recorder.trips:
            ratios += ratios_of(recorder.heatings, rig)
    limits = rig.interlocks
    return Life(name, seed, tuple(trips), known, known.share(limits.heat_share, limits.heat_share_known))


def figures(sweeps: Sweeps) -> Iterator[Figure]:
    """Yield the knowledge of every life in its last run, and the number of trips."""
    cases = [(name, seed) for seed in range(5) for name in UNLIKE] if sweeps.full else [(name, 0) for name in SAMPLED]
    names, numbers = zip(*cases, strict=True)
    trips = 0
    with ProcessPoolExecutor(sweeps.jobs) as pool:
        for life in pool.map(live, names, numbers):
            trips += len(life.trips)
            words = f"ratio {life.known.ratio:.2f} of {life.known.heatings}, told from {100 * life.share:.0f} %"
            name = f"heat, {life.name}, seed {life.seed}"
            yield holds(name, not life.trips, "; ".join((words, *life.trips)), "no trip, with a history")
    yield equal(f"heat: trips in {len(cases)} lives of three runs", trips, 0)
