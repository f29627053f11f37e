"""Two benches: one activity on an ideal rig that follows at once, and a whole run on the simulated rig."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import copysign, cos, hypot, inf, isfinite, radians, sin
from typing import NamedTuple

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.inputs.recipe.plan import Plan
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.control.loops import WheelState
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.activity import Activity
from tester.machine.leaps import Leaps
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import NoAttendant, RunSetup
from tester.machine.sampler import Sampler
from tester.machine.tickers import next_tick
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tester.store.sql import Batch
from tests.tester.inputs.recipe.texts import load_recipe, rig

COLUMN = {name: i for i, name in enumerate(QUANTITIES.names)}

SHORT = """\
recipe: short
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 14 rev
  soak: {within: 2 degC, for: 2 s}
grids:
  - name: one
    slip_velocity: 300 mm/s
    load: 200 N
    temperature: 25 degC
"""
"""A recipe of five minutes of rig time, four of them to warm by 3 K: no pre-grinding, no rest, one condition."""

AT_ONCE = SHORT.replace("25 degC", "23 degC")
"""The same in a minute: the simulated room's 22 degC are within its band. Without noise the band can be left early."""

QUIET = ("sim.noise=0", "sim.scatter=0", "sim.running_in=0")
"""Overrides for a rig whose coefficient is steady from the first turn."""

HOT = ("sim.friction_heat_fraction=0.5", "sim.belt_conductance=0.3")
"""The hot rig: two kelvin take a fraction of a second."""


def plan_of(text: str = SHORT, config: RigConfig | None = None) -> Plan:
    """Return the plan of a recipe text."""
    used = config or rig()
    return expand(load_recipe(text, PART, "r.yaml").recipe, used)


def condition_of(text: str = SHORT) -> WheelCondition:
    """Return the first condition of a recipe text."""
    return next(plan_of(text).conditions())


class Notes(NullRecorder):
    """A record in memory: samples, events, and every statement in order."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: list[tuple[float, ...]] = []
        self.events: list[tuple[float, str, str, str]] = []
        self.statements: list[tuple[str, tuple[object, ...]]] = []

    def sample(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        self.events.append((t_s, kind, text, severity))
        super().event(t_s, kind, text, severity, data)

    def _put(self, batch: Batch) -> None:
        self.statements += batch.statements
        super()._put(batch)

    def texts(self, kind: str) -> list[str]:
        """Return the texts of all events of a kind."""
        return [text for _, found, text, _ in self.events if found == kind]

    def written(self, start: str) -> list[tuple[object, ...]]:
        """Return the values of every statement that begins with ``start``."""
        return [values for sql, values in self.statements if sql.startswith(start)]

    def fields(self, start: str) -> list[dict[str, object]]:
        """Return the values of every statement that begins with ``start``, by column (an UPDATE: also its WHERE)."""
        return [
            dict(zip(columns_named(sql), values, strict=False))
            for sql, values in self.statements
            if sql.startswith(start)
        ]


def columns_named(sql: str) -> list[str]:
    """Return the columns of an INSERT, or those that an UPDATE sets and then compares, in order."""
    if sql.startswith("INSERT"):
        return [name.strip() for name in sql.partition("(")[2].partition(")")[0].split(",")]
    return re.findall(r"(\w+) = \?", sql)


class Cell:
    """A load cell that keeps its tare."""

    def __init__(self) -> None:
        self.tare = (0.0, 0.0, 0.0, 0.0)

    def set_tare(self, values: tuple[float, float, float, float]) -> None:
        self.tare = values


@dataclass
class Bench:
    """A context, and readings that follow its demand at once: an ideal rig."""

    ctx: Context
    notes: Notes
    cell: Cell
    sampler: Sampler
    surface_c: float = 24.0
    mu: float = 0.7
    follow: bool = True
    zero_n: float = 0.0
    """What the unloaded cell shows of the normal force without a tare, N."""
    pressed_mm: float = 11.0
    """Press position in contact, mm."""
    off_n: float = 0.0
    """Error of the load in contact, N."""
    warming_k_s: float = 0.0
    """How fast the surface warms in slip, K/s."""
    returning_k_s: float = 0.0
    """How fast it returns to the demanded temperature, K/s."""
    demands: list[Demand] = field(default_factory=list[Demand])
    """The sent demand of every scan; equal successive ones are one object."""
    _demand: Demand = field(default_factory=Demand)

    @property
    def now(self) -> float:
        return self.ctx.now

    def scan(self, activity: Activity[Context], dt: float = 0.01) -> bool:
        """Do one scan; return whether the activity is done."""
        ctx, r = self.ctx, self.ctx.readings
        ctx.now += dt
        ctx.dt = dt
        was_in_contact = ctx.contact.in_contact
        if self.follow:
            self._follow(r, ctx.demand, dt)
        if ctx.contact.in_contact != was_in_contact:
            ctx.gates.touched_s = ctx.now if ctx.contact.in_contact else inf
        ctx.moving = False
        ctx.gate = ctx.gates.update(r, dt)
        done = activity.step(ctx)
        self.sampler.record(ctx, Setpoints())
        if not self.demands or self.demands[-1] != ctx.demand:
            self._demand = replace(ctx.demand, positions=dict(ctx.demand.positions))
        self.demands.append(self._demand)
        return done

    def run(self, activity: Activity[Context], at_most_s: float = 60.0, dt: float = 0.01) -> float:
        """Step an activity to its end and return the seconds it took."""
        began = self.ctx.now
        while not self.scan(activity, dt):
            assert self.ctx.now - began < at_most_s, f"not done after {at_most_s:g} s"
        return self.ctx.now - began

    def until(
        self, activity: Activity[Context], reached: Callable[[], bool], at_most_s: float = 600.0, dt: float = 0.01
    ) -> None:
        """Step an activity until a condition holds; fail if it is done before."""
        began = self.ctx.now
        while not reached():
            assert not self.scan(activity, dt) and self.ctx.now - began < at_most_s

    def hold(self, activity: Activity[Context], seconds: float, dt: float = 0.01) -> None:
        """Step an activity for a while; fail if it is done."""
        for _ in range(round(seconds / dt)):
            assert not self.scan(activity, dt)

    def _follow(self, r: Readings, d: Demand, dt: float) -> None:
        r.now_s = self.ctx.now
        r.wheel_at_s = r.belt_at_s = r.press_at_s = r.positions_at_s = r.now_s
        r.cell_at_s = r.surface_at_s = r.jacket_at_s = r.inputs_at_s = r.now_s
        r.drives_enabled, r.drives_disabled = d.enabled, not d.enabled
        r.wheel_speed_m_s = d.wheel_speed_m_s if d.enabled else 0.0
        r.belt_speed_m_s = d.belt_speed_m_s if d.enabled else 0.0
        r.positions.update(d.positions)
        r.yaw_reached = True
        angle = radians(r.positions["sideslip"])
        r.slip_m_s = hypot(r.wheel_speed_m_s - r.belt_speed_m_s * cos(angle), r.belt_speed_m_s * sin(angle))
        r.wheel_angle_rev += r.wheel_speed_m_s * dt / (r.diameter_mm * 3.141592653589793e-3)
        touching = d.press is Press.LOAD and d.enabled
        self.ctx.contact.in_contact = touching
        r.press_mm = self.pressed_mm if touching else 0.0
        r.force_z_n = d.load_n + self.off_n if touching else self.zero_n - self.cell.tare[2]
        along = r.wheel_speed_m_s - r.belt_speed_m_s * cos(angle)
        r.force_x_n = self.mu * r.force_z_n * copysign(1.0, along) if touching else 0.0
        if touching and r.slip_m_s > 0.1:
            self.surface_c += self.warming_k_s * dt
        elif isfinite(d.surface_c):
            missing = d.surface_c - self.surface_c
            self.surface_c += max(-self.returning_k_s * dt, min(self.returning_k_s * dt, missing))
        r.surface_c = self.surface_c
        r.hub_c = self.surface_c


def make_bench(config: RigConfig | None = None, *, automatic: bool = True) -> Bench:
    """Return a bench at standstill, drives off, everything in order."""
    used = config or rig()
    notes, cell, diameter = Notes(), Cell(), used.geometry.wheel_diameter_mm
    readings = Readings(
        cold_mm=diameter, diameter_mm=diameter, wheel_speed_m_s=0.0, belt_speed_m_s=0.0, press_mm=0.0,
        slip_m_s=0.0, force_x_n=0.0, force_y_n=0.0, force_z_n=0.0, moment_z_nm=0.0, cell_valid=True,
        surface_c=24.0, surface_valid=True, hub_c=24.0, heat_percent=0.0, jacket_valid=True, safety_chain=True,
        guard_closed=True,
    )  # fmt: skip
    view = InterlockInputs(state=WheelState(used.loops.heat.hub_min_c), rig=used)
    ctx = Context(used, readings, Prompts(automatic=automatic), notes, NoAttendant(), cell, view)
    return Bench(ctx, notes, cell, Sampler(notes, QUANTITIES))


class Scan(NamedTuple):
    """The inputs of a scan."""

    at_s: float
    title: str
    drives_disabled: bool
    slip_m_s: float
    press: Press


class Simulation:
    """A run on the simulated rig, ticked by hand."""

    def __init__(
        self,
        text: str = SHORT,
        overrides: Sequence[str] = (),
        *,
        seed: int = 0,
        accept_risk: str = "",
        config: RigConfig | None = None,
    ) -> None:
        config = config or rig(*overrides, accept_risk=accept_risk)
        ports, world, attendant = simulated_ports(config, seed, None)
        self.plan = plan_of(text, config)
        self.notes = Notes()
        assert isinstance(world, WheelRig)
        self.world = world
        self.run: Run = build_run(
            RunSetup(config, self.plan, ports, attendant, self.notes, Prompts(automatic=True))
        )
        self.now = 0.0
        self.ticks: list[float] = []
        self.truth: list[tuple[float, float]] = []
        """(time, surface temperature of the plant), tick by tick."""
        self.scans: list[Scan] = []
        self.leaps: Leaps | None = None

    def leaping(self) -> Simulation:
        """Leap time in which only heat flows, from now on."""
        self.leaps = Leaps(self.run.engine, self.world)
        return self

    def tick(self) -> None:
        """Do one tick, as the ticker of simulated time does."""
        now = self.now
        self.world.advance(now)
        self.ticks.append(now)
        self.truth.append((now, self.world.plant.surface_c))
        later = next_tick(now, self.run.tick(now), self.world.urgent_s)
        self.now = later if self.leaps is None else self.leaps.after(now, later)
        engine = self.run.engine
        if engine.last_scan_s == now:
            r = self.ctx.readings
            slip = abs(r.wheel_speed_m_s - r.belt_speed_m_s)
            self.scans.append(Scan(now, self.ctx.progress.title, r.drives_disabled, slip, self.ctx.demand.press))

    def until(self, condition: Callable[[Simulation], bool], at_most_s: float = 3600.0) -> Simulation:
        """Tick until ``condition`` holds; fail where the run ends or time is up before."""
        while not condition(self):
            assert not self.run.finished, f"{self.run.outcome}: {self.run.reason}"
            assert self.now < at_most_s
            self.tick()
        return self

    def to_the_end(self, at_most_s: float = 20_000.0) -> Simulation:
        """Tick until the run has ended."""
        while not self.run.finished:
            assert self.now < at_most_s
            self.tick()
        return self

    @property
    def ctx(self) -> Context:
        return self.run.engine.ctx

    def column(self, name: str) -> list[float]:
        """Return one column of everything recorded."""
        i = COLUMN[name]
        return [row[i] for row in self.notes.rows]

    def rows(self, **having: float) -> list[dict[str, float]]:
        """Return recorded samples by name, those with the given values."""
        found = (dict(zip(QUANTITIES.names, row, strict=True)) for row in self.notes.rows)
        return [row for row in found if all(row[name] == value for name, value in having.items())]


def in_burst(simulation: Simulation) -> bool:
    """Return whether a burst is under way and counts."""
    ctx = simulation.ctx
    return ctx.burst > 0 and ctx.gate == 0


def in_contact(simulation: Simulation) -> bool:
    """Return whether the wheel carries its load."""
    return simulation.ctx.readings.force_z_n > 150.0
