"""Lives of wheels whose compound wears differently from the rig file's belief, drawn by seed, for
``tests.campaigns.wear``.

A life is one wheel from full size to its least diameter, or to the end of its recipe. Its rubber wears by 0.02 to 0.6
mm3/(N m) where 0.08 is believed, relaxes and softens, and its growth with heat differs from the belief.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from math import exp, inf, log, nan
from random import Random
from typing import Final

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.analysis.flags import SLIP_UNSURE, flags_in
from tester.analysis.results import Burst, RepeatResult
from tester.inputs.recipe.loader import check
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.procedures.on_record import SLIP_M_S, SLIP_SHARE
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.schema import for_wheels
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import next_tick
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tester.store.sql import Judged, Ticket
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, holds
from tests.tester.inputs.recipe.texts import load_recipe

LIVES, SAMPLE_LIVES = 60, 1
RUBBER_LAYER_MM: Final = 8.0
RUBBER_EXPANSION: Final = (0.0029 / (2.0 * RUBBER_LAYER_MM), 0.0087 / (2.0 * RUBBER_LAYER_MM))
"""Radial expansion of the layer, 1/K: the range of the rubber's part of the growth of the diameter, 0.0029 to 0.0087
mm/K, that ``wear.growth_uncertainty`` covers (sim/rig.yaml)."""
COMPOUNDS: Final = ("1#", "2#", "3#")
SLOWEST, FASTEST = 0.02, 0.6
"""Range of the wear rate, mm3/(N m), drawn evenly by its logarithm."""
BELIEVED: Final = 0.08
FLAGGED: Final = 0.05
"""Maximum share of flagged repeats."""
LEARNT: Final = 0.2
"""The rate must be known to this share before half of a life."""
WHOLE_MM: Final = 3.0
"""A wheel that has lost less by the end of its recipe has not lived half of a life: its rate is judged at the end."""
LEFT_MM: Final = 2.0
"""Maximum diameter above a wheel's least diameter when a new wheel is requested [A]: a condition at 400 N."""
LONGEST_S: Final = 30_000.0
RIG: Final = RigConfig.of(load_rig("sim", ()))
RECIPE = """recipe: a wheel's life
specimens: [{{compound: "{compound}"}}]
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: {belt:.3f} m/s, load: {ground:.0f} N, duration: {minutes:.0f} min}}
measure:
  wheel_speed: 0.8 m/s
  repeats: 2
  min_valid: 1
  window: {revolutions} rev
  temperature_band: 3 degC
  soak: {{within: 1.5 degC, for: 20 s}}
wheel: {{replace_after: 12 mm}}
grids:
  - name: life
    slip_velocity: [{slips}]
    load: [{loads}]
    temperature: [{temperatures}]
"""


@dataclass(frozen=True, slots=True)
class Life:
    """The draw of a seed: the rubber, and the recipe."""

    seed: int
    rate: float
    recipe: str
    overrides: tuple[str, ...]
    words: str


@dataclass(slots=True)
class Lived:
    """The result of a life."""

    life: Life
    ended: str = ""
    """Trip or failure, or ""."""
    least_mm: float = inf
    lost_mm: float = 0.0
    left_mm: float = nan
    """True diameter above the least one when a new wheel was requested; NaN if none was."""
    valid: int = 0
    flagged: int = 0
    off: list[str] = field(default_factory=list)
    """Valid repeats without a flag whose slip error exceeded the allowed one."""
    worst: float = 0.0
    """Greatest slip error as a share of the allowed one."""
    rate: float = nan
    """Rate in use when half of the life was over, or at the end of a short life."""
    reported: bool = False

    @property
    def learnt(self) -> bool:
        """Return whether the rate was known by then."""
        return abs(self.rate / self.life.rate - 1.0) <= LEARNT


def drawn(seed: int, *, short: bool = False) -> Life:
    """Draw a life that the rig can run: ``check`` accepts its recipe. A ``short`` one has few conditions."""
    at = Random(f"life {seed}")
    while check((life := _drawn(at, seed, short=short)).recipe, RIG, PART, "life.yaml"):
        pass
    return life


def _drawn(at: Random, seed: int, *, short: bool) -> Life:
    rate = exp(at.uniform(log(SLOWEST), log(FASTEST)))
    relaxing, softening = at.uniform(0.0, 1.0), at.uniform(0.0, 1.0)
    ground, slip = at.uniform(150.0, 400.0), at.uniform(0.15, 0.4)
    # A compound that wears slowly is ground for longer: otherwise its life would never end.
    ground_mm = at.uniform(1.0, 2.0 if short else 8.0)
    minutes = min(max(ground_mm * 4241.0 / (rate * ground * slip * 60.0), 3.0), 60.0)
    loads = sorted(at.sample(range(100, 401, 50), 2 if short else 3), key=lambda _: at.random())
    slips = at.sample((100, 150, 200, 300, 400), 1 if short else 2)
    temperatures = [30] if short else at.sample((30, 45, 60, 75), 2)
    recipe = RECIPE.format(
        compound=at.choice(COMPOUNDS), belt=0.8 - slip, ground=ground, minutes=minutes,
        revolutions=at.choice((12, 20, 30)), slips=_axis(slips, "mm/s"), loads=_axis(loads, "N"),
        temperatures=_axis(temperatures, "degC"),
    )  # fmt: skip
    overrides = (
        f"sim.abrasion.wear_rate={rate:.4f}",
        f"sim.relaxation={relaxing:.3f}",
        f"sim.softening={softening:.3f}",
        f"sim.contact.rubber_expansion={at.uniform(*RUBBER_EXPANSION):.6f}",
    )
    words = f"wear {rate:.3f}, relaxing {relaxing:.2f}, softening {softening:.2f}"
    return Life(seed, rate, recipe, overrides, words)


def _axis(values: Iterable[float], unit: str) -> str:
    return ", ".join(f"{value:g} {unit}" for value in values)


class Kept(NullRecorder):
    """Stores a run's repeats by key, its trips, and its reports of wear."""

    def __init__(self) -> None:
        super().__init__()
        self.repeats: dict[int, RepeatResult] = {}
        self.trips: list[str] = []
        self.wear: list[str] = []

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Store a repeat."""
        self.repeats[key] = result
        return Ticket(done=True)

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = nan, limit: float = nan, unit: str = ""
    ) -> int:
        """Store a trip."""
        self.trips.append(f"{interlock} at {t_s:.0f} s")
        return len(self.trips)

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Store a report of wear."""
        if kind == "wear":
            self.wear.append(text)


class Living:
    """A run on the simulated rig, with the true diameter beside the one in use."""

    def __init__(self, life: Life) -> None:
        """Build the run; nothing moves before ``to_the_end``."""
        config = RigConfig.of(load_rig("sim", life.overrides))
        plan = expand(for_wheels(load_recipe(life.recipe, PART, "life.yaml").recipe), config)
        ports, world, attendant = simulated_ports(config, life.seed, None)
        assert isinstance(world, WheelRig)
        self.world, self.kept, self.lived = world, Kept(), Lived(life)
        self.least_mm = config.interlocks.least_diameter_mm
        self.run: Run = build_run(RunSetup(config, plan, ports, attendant, self.kept, Prompts(automatic=True)))
        self.slips: dict[int, tuple[int, float, float]] = {}
        """Scans that count, the sum of the slip's error in m/s, and the slip asked for, by repeat."""
        self.rates: list[tuple[float, float]] = []
        """True loss of diameter, mm, and the rate in use."""

    def to_the_end(self) -> Lived:
        """Tick until the run ends, or a second wheel is mounted."""
        run, lived, plant, ctx = self.run, self.lived, self.world.plant, self.run.engine.ctx
        new_mm, now, cold_mm = ctx.wheel.installed_mm, 0.0, plant.cold_mm
        while not run.finished and now < LONGEST_S and ctx.wheel.wheel < 2:
            self.world.advance(now)
            cold_mm = min(cold_mm, plant.cold_mm) if ctx.wheel.wheel < 2 else cold_mm
            now = next_tick(now, run.tick(now), self.world.urgent_s)
            if ctx.burst > 0 and ctx.gate == 0 and ctx.now == run.engine.last_scan_s:
                self._note_slip(plant.diameter_mm)
            if not self.rates or new_mm - cold_mm > self.rates[-1][0] + 0.01:
                wheel = ctx.wheel
                self.rates.append((new_mm - cold_mm, wheel.rate_mm3_per_n_m or BELIEVED))
        lived.least_mm, lived.lost_mm = cold_mm, new_mm - cold_mm
        if ctx.wheel.wheel >= 2:
            lived.left_mm = cold_mm - self.least_mm
        elif run.finished and run.outcome.name != "DONE":
            lived.ended = f"{run.outcome.name} {run.reason}"
        lived.ended = "; ".join(self.kept.trips) or lived.ended
        lived.reported = any("than believed" in text for text in self.kept.wear)
        until_mm = lived.lost_mm if lived.lost_mm < WHOLE_MM else 0.5 * lived.lost_mm
        lived.rate = next(rate for lost_mm, rate in reversed(self.rates) if lost_mm <= until_mm)
        self._judge_slips()
        return lived

    def _note_slip(self, true_mm: float) -> None:
        ctx = self.run.engine.ctx
        r, key = ctx.readings, ctx.repeat_key
        count, total, _ = self.slips.get(key, (0, 0.0, 0.0))
        off_m_s = r.wheel_speed_m_s * (true_mm / r.diameter_mm - 1.0)
        self.slips[key] = count + 1, total + off_m_s, ctx.gates.target.slip_m_s

    def _judge_slips(self) -> None:
        lived = self.lived
        for key, (count, total, slip_m_s) in self.slips.items():
            result = self.kept.repeats.get(key)
            if result is None or not result.valid:
                continue
            lived.valid += 1
            off_m_s, most_m_s = total / count, max(SLIP_M_S, SLIP_SHARE * slip_m_s)
            if SLIP_UNSURE in flags_in(result.flags):
                lived.flagged += 1
                continue
            lived.worst = max(lived.worst, abs(off_m_s) / most_m_s)
            if abs(off_m_s) > most_m_s:
                lived.off.append(f"{1e3 * off_m_s:+.1f} mm/s of {1e3 * slip_m_s:.0f}")


def live(life: Life) -> Lived:
    """Run a life on the simulated rig."""
    return Living(life).to_the_end()


def life_text(lived: Lived) -> str:
    """Return a life as one line."""
    life = lived.life
    what = lived.ended or ("to the least diameter" if lived.left_mm == lived.left_mm else "to the end of its recipe")
    return (
        f"life {life.seed:2}, {life.words}: {lived.lost_mm:.2f} mm, {what}; {lived.valid} valid,"
        f" {lived.flagged} flagged, slip off by {100.0 * lived.worst:.0f} % of what is allowed {lived.off or ''};"
        f" rate {lived.rate:.3f}"
    )


def figures(all_lived: Sequence[Lived]) -> Iterator[Figure]:
    """Yield every figure of the lives."""
    count, valid = len(all_lived), sum(one.valid for one in all_lived)
    ended = [one.ended for one in all_lived if one.ended]
    yield holds("lives without a trip", not ended, f"{count - len(ended)} of {count} {ended or ''}", "all")
    least_mm = min(one.least_mm for one in all_lived)
    yield at_least("least diameter of a wheel, mm", least_mm, RIG.interlocks.least_diameter_mm)
    left = [one.left_mm for one in all_lived if one.left_mm == one.left_mm]
    yield at_most(f"left of the {len(left)} wheels that were worn out, mm", max(left, default=0.0), LEFT_MM)
    yield at_least("valid repeats", valid, count, digits=0)
    off = sum(len(one.off) for one in all_lived)
    yield at_most(f"valid repeats of {valid} at another slip, without a flag", off, 0, digits=0)
    flagged = 100.0 * sum(one.flagged for one in all_lived) / max(valid, 1)
    yield at_most("repeats with a flag, %", flagged, 100.0 * FLAGGED)
    learnt = sum(one.learnt for one in all_lived)
    yield at_least(f"lives of {count} whose rate is known to 20 % by then", learnt, count, digits=0)
    far = [one for one in all_lived if one.life.rate > 2.0 * BELIEVED]
    yield at_least(f'"wears faster than believed", of {len(far)}', sum(one.reported for one in far), len(far), digits=0)
