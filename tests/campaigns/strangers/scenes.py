"""The scenes in which defects begin: recipes at the limits of both kinds of machine, resumed runs, commissioning."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

from sim.faults.can import FaultyCanWire
from tester.inputs.recipe.plan import Mounted, Stand
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.kinds.wheel_on_belt.recipe.remaining import remaining
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup
from tester.run.simulated import simulated_ports
from tester.store.resumable import ResumePoint
from tests.campaigns.faults.apart import FORKS, apart
from tests.campaigns.faults.corners import Corner, corners
from tests.campaigns.faults.moments import Moment, moments_of
from tests.campaigns.faults.stage import Stage, plan_of, rig_of
from tests.campaigns.faults.track import TrackStage

Result = TypeVar("Result")
WHEEL, TRACK = "wheel_on_belt", "specimen_on_track"
_CHANGED = """\
recipe: wheel changes at the limits
specimens:
  - compound: "{compound}"
  - compound: "{compound}"
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 s}}
rest: {{at_least: 2 s, until: 40 degC, within: 10 degC}}
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 5 rev
  soak: {{within: 2 degC, for: 2 s}}
grids:
  - name: greatest
    slip_velocity: 200 mm/s
    load: {load} N
    temperature: 26 degC
    both_directions: true
reference: {{every: 1}}
"""
"""Reversal, reference and wheel change under the greatest load."""
_TRACKS = {
    "grosch": """\
recipe: slow track at the limits
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 1 mm, at_least: 2 s, temperature_band: 5 K,
          soak: {within: 3 K, for: 2 s}}
grids:
  - {name: most, load: [10 N, 40 N], temperature: [24 degC, 60 degC], track_speed: [0.5 mm/s, 8 mm/s]}
""",
    "pin-on-disc": """\
recipe: disc at the limits
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 100 mm, at_least: 2 s, temperature_band: 5 K,
          soak: {within: 3 K, for: 2 s}}
grids:
  - {name: most, interface: [dry, wet], load: [10 N, 20 N], temperature: 23 degC, track_speed: [0.3 m/s, 1 m/s]}
""",
}


@dataclass(frozen=True, slots=True)
class Setup:
    """A recipe on a machine. ``text``: of the recipe; ``rig``: packaged; ``overrides`` of the machine; ``resumed``."""

    name: str
    kind: str
    text: str
    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    resumed: bool = False

    def stage(self) -> Stage:
        """Return a stage at the recipe's beginning."""
        if self.kind == TRACK:
            return TrackStage(self.rig, self.text, self.overrides)
        return Resumed(self.text, self.overrides) if self.resumed else Stage(self.text, self.overrides)


class Resumed(Stage):
    """A run that resumes after its first condition, with the wheel that is mounted."""

    def __init__(self, text: str, overrides: tuple[str, ...]) -> None:
        """Build a stage, then replace its run by one of the rest of the plan on a rig of its own."""
        super().__init__(text, overrides)
        config, whole = rig_of(overrides), WheelPlan.of(plan_of(text, overrides))
        first = next(step.condition for step in whole.conditions())
        wheel = Mounted(1, 1, 1, config.geometry.wheel_diameter_mm - 0.3, 200.0, ground=True, last_condition=first)
        stand = Stand(frozenset({first}), frozenset({first}), (wheel,), {"": 200.0})
        point = ResumePoint(finished=False, origin_s=0.0, stand=stand, conditions={}, reference_tare=None, session=2)
        self.plan = remaining(whole, stand)
        ports, rig, attendant = simulated_ports(config, 0, None, FaultyCanWire)
        self.rig = self.observer.rig = rig
        setup = RunSetup(config, self.plan, ports, attendant, self.ledger, Prompts(automatic=True), point)
        self.run = build_run(setup)
        self.begin(config)


def setups(kind: str, *, short: bool = False) -> dict[str, Setup]:
    """Return the recipes of a kind of machine by name; ``short``: those of a sample."""
    return {one.name: one for one in _setups(kind, short)}


@cache
def _setups(kind: str, short: bool) -> tuple[Setup, ...]:
    if kind == TRACK:
        return tuple(Setup(name, TRACK, text, name) for name, text in _TRACKS.items())
    every = list(corners().values())
    hardest = every[-1]
    if short:
        return (Setup(f"resumed, {hardest.name}", WHEEL, _changed(hardest), overrides=hardest.overrides, resumed=True),)
    hot = [Setup(one.name, WHEEL, one.text, overrides=one.overrides) for one in every]
    cold = [one for one in every if one.stiffness > 1.0]
    changed = [Setup(f"wheel change, {one.name}", WHEEL, _changed(one), overrides=one.overrides) for one in cold]
    resumed = [Setup(f"resumed, {one.name}", WHEEL, _changed(one), overrides=one.overrides, resumed=True)
               for one in cold]  # fmt: skip
    return (*hot, *changed, *resumed)


def _changed(corner: Corner) -> str:
    return _CHANGED.format(compound=corner.compound, load=corner.load_n)


def moments(setup: Setup) -> tuple[Moment, ...]:
    """Return the moments of a recipe: begin, middle and end of each step, and of the stop that follows.

    Raises ValueError if it trips without a defect, or does harm.
    """
    stage = setup.stage()
    found = moments_of(setup.name, stage, cooled=False)
    wrong = [*stage.ledger.trips, *stage.observer.found.values(), *stage.invariants.broken.values()]
    if wrong or not stage.run.engine.executor.finished:
        raise ValueError(f"{setup.name} without a defect: {'; '.join(wrong) or stage.run.reason or stage.mode}")
    return tuple(found)


def visit(setup: Setup, ticks: list[int], work: Callable[[Stage, int], Result]) -> Iterator[Result]:
    """Run a recipe once; yield what ``work`` returns for a copy of its stage before each of these ticks.

    Without forks each copy is a run of its own up to its tick.
    """
    stage = setup.stage()
    for number, tick in sorted(enumerate(ticks), key=lambda pair: pair[1]):
        if not FORKS:
            stage = setup.stage()
        while stage.ticks < tick:
            stage.tick()
        yield apart(lambda number=number: work(stage, number)) if FORKS else work(stage, number)  # noqa: B023


