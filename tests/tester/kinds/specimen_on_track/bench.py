"""A specimen on a simulated track, ticked by hand: results stay in a list."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import nan

from sim.machines.specimen_on_track.rig import TrackRig
from tester.analysis.results import Burst, RepeatResult
from tester.inputs.recipe.plan import Plan
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.runs import RUNS
from tester.machine.leaps import Leaps
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import next_tick
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tester.store.sql import Judged, Ticket
from tests.tester.inputs.recipe.texts import load_recipe

GROSCH = """\
recipe: a block
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 0.4 mm, soak: {within: 1 K, for: 5 s}}
grids:
  - {name: one, load: 20 N, temperature: 23 degC, track_speed: [0.1 mm/s, 3 mm/s]}
"""
DISC = """\
recipe: a pin
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 100 mm, temperature_band: 5 K, soak: {within: 3 K, for: 1 s}}
grids:
  - {name: one, interface: [dry, wet], load: 10 N, temperature: 23 degC, track_speed: 0.2 m/s}
"""


def one_track(text: str, surface: str = "silicon carbide", interface: str = "dry") -> str:
    """Return the text of the packaged recipe grosch with one of its tracks alone."""
    clean, found, talc = text.partition("  - name: talc\n")
    assert found and "[wavy glass, silicon carbide]" in clean
    if interface == "talc":
        return clean[: clean.index("  - name: clean")] + found + talc
    return clean.replace("[wavy glass, silicon carbide]", surface)


FOUR_RUBBERS = ("SBR", "ABR", "INR", "butyl")
"""Grosch's."""
RECIPE_C = tuple(-40.0 + 10.0 * i for i in range(11))
"""Temperatures of the packaged recipe grosch, degC."""
LOWEST_C = {"ABR": -15.0}
"""Lowest temperature of a rubber where it is not the recipe's: at -40 degC ABR is a glass, and Grosch slid it from
-15 degC (paper S, Fig 3)."""


def temperatures_of(compound: str) -> tuple[float, ...]:
    """Return the eleven temperatures at which a rubber slides, degC."""
    return tuple(LOWEST_C.get(compound, RECIPE_C[0]) + at - RECIPE_C[0] for at in RECIPE_C)


def with_rubber(text: str, compound: str) -> str:
    """Return the text of the packaged recipe grosch with a rubber, and the rubber's temperatures for all of its own."""
    assert "compound: SBR" in text
    stated, own = (", ".join(f"{at:g} degC" for at in row) for row in (RECIPE_C, temperatures_of(compound)))
    return text.replace("compound: SBR", f"compound: {compound}").replace(stated, own)


@dataclass
class Kept(NullRecorder):
    """Keeps results, trips, warnings and events."""

    results: list[tuple[int, RepeatResult]] = field(default_factory=list[tuple[int, RepeatResult]])
    trips: list[str] = field(default_factory=list[str])
    events: list[tuple[float, str, str]] = field(default_factory=list[tuple[float, str, str]])
    tares: list[float] = field(default_factory=list[float])

    def __post_init__(self) -> None:
        super().__init__()
        self._condition = 0

    def begin_repeat(self, condition: int, repeat: int, attempt: int, t_s: float = nan, piece: int = 0) -> int:
        self._condition = condition
        return super().begin_repeat(condition, repeat, attempt, t_s, piece)

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        self.results.append((self._condition, result))
        return Ticket(done=True)

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = nan, limit: float = nan, unit: str = ""
    ) -> int:
        self.trips.append(interlock)
        return len(self.trips)

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        self.events.append((t_s, kind, text))

    def tare(self, t_s: float, kind: str, zeros: Mapping[str, float], repeat_key: int = 0) -> None:
        self.tares.append(zeros["friction_n"])


class TrackBench:
    """A run on a simulated rig; nothing is sent before the first ``tick``."""

    def __init__(self, rig: str = "grosch", recipe: str = "", overrides: Iterable[str] = (), seed: int = 0) -> None:
        self.config = TrackConfig.of(load_rig(rig, tuple(overrides)))
        text = recipe or (GROSCH if rig == "grosch" else DISC)
        self.plan: Plan = PART.expand(load_recipe(text, PART, "bench.yaml").recipe, self.config)
        ports, world, attendant = simulated_ports(self.config, seed, None)
        assert isinstance(world, TrackRig)
        self.world = world
        self.kept = Kept()
        self.prompts = Prompts(automatic=True)
        self.run: Run = RUNS.build(RunSetup(self.config, self.plan, ports, attendant, self.kept, self.prompts))
        self.now = 0.0
        self.leaps: Leaps | None = None

    def leaping(self) -> TrackBench:
        """Leap time in which only heat flows, from now on."""
        self.leaps = Leaps(self.run.engine, self.world)
        return self

    def tick(self) -> None:
        """Let the rig live until the next tick and do it."""
        self.world.advance(self.now)
        later = next_tick(self.now, self.run.tick(self.now), self.world.urgent_s)
        self.now = later if self.leaps is None else self.leaps.after(self.now, later)

    def until(self, reached: Callable[[TrackBench], bool], at_most_s: float) -> TrackBench:
        """Tick until a condition holds; fails on time-out."""
        while not reached(self):
            assert self.now < at_most_s and not self.run.finished, (self.now, self.run.reason, self.kept.events[-5:])
            self.tick()
        return self

    def phase(self, name: str, at_most_s: float = 600.0) -> TrackBench:
        """Tick until a phase of the run has begun."""
        return self.until(lambda one: one.run.engine.ctx.progress.phase.partition(" ")[0] == name, at_most_s)

    def to_the_end(self, at_most_s: float = 1e6) -> TrackBench:
        """Tick until the run is over."""
        while not self.run.finished:
            assert self.now < at_most_s
            self.tick()
        return self
