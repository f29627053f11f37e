"""Manual mode: a person moves the rig in bounded steps. Control's limits and interlocks stand as in a run.

A terminal cannot see a key being released, so a key press is one step and nothing moves on by itself. The mode ends by
itself when nobody has pressed a key for a minute, and when the client that armed it is gone.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, isfinite
from pathlib import Path

from tester import clock
from tester.campaign.folder import make_folder
from tester.campaign.latch import MANUAL_RUNS
from tester.campaign.part_run import Unsampled
from tester.control.load_loop import UNLOADED_N as STANDING_LOAD_N
from tester.control.permissives import Bounds, rig_bounds
from tester.engine.context import Context
from tester.engine.executor import Executor
from tester.engine.moves import TakeTare
from tester.engine.results import StoredResults
from tester.engine.run import Run
from tester.process import Press
from tester.provenance import accepted_risks
from tester.recipe.limits import least_load_n
from tester.recipe.plan import Plan
from tester.rig import RigConfig
from tester.service.commands import JogAxis
from tester.store.reader import DATABASE
from tester.store.recorder import Recorder
from tester.store.records import RunInfo, WheelInfo
from tester.store.writer import RunWriter

NAME = "manual mode"
ARMED_S = 60.0
"""Manual mode disarms after this long without a step."""
STEPS_PER_S = 5.0
"""More key presses a second are refused [A]: an auto-repeating key makes 30."""
SPEED_STEP_M_S = 0.05
LOAD_STEP_N = 10.0
ANGLE_STEP_DEG = 1.0
HEAT_STEP_K = 1.0
UNLOADED_N = 5.0
STANDING_M_S = 0.02
TARE_S = 2.0
MOVING_S = 2.0
"""After a step scans come at the sliding rate for this long, s [A]."""


@dataclass(slots=True)
class Wanted:
    """What the person has asked for so far."""

    wheel_m_s: float = 0.0
    belt_m_s: float = 0.0
    load_n: float = 0.0
    sideslip_deg: float = 0.0
    camber_deg: float = 0.0
    surface_c: float = float("nan")


class ManualExecutor(Executor):
    """Stands in the executor's place: what it demands is what a person asked for."""

    def __init__(self, recorder: Recorder, bounds: Bounds) -> None:
        """Nothing is wanted: drives enabled, standing, lifted. ``bounds``: how far a person may go, control's too."""
        super().__init__(Plan(NAME, (), (), (), 0.0, 1), StoredResults(recorder), hardware=False)
        self.wanted = Wanted()
        self.bounds = bounds
        self.taring: TakeTare | None = None
        self.tare_text = ""
        self.used_s = float("nan")
        self.pressed_s = float("-inf")
        self.moved_s = float("-inf")
        self.old = (0.0, 0.0, 0.0, 0.0)

    def left_s(self, now: float) -> float:
        """Return for how many more seconds the mode stays armed."""
        return ARMED_S if not isfinite(self.used_s) else max(ARMED_S - (now - self.used_s), 0.0)

    def step(self, ctx: Context) -> None:
        """Demand what is wanted; the run ends when nobody has asked for anything for a minute."""
        if not isfinite(self.used_s):
            self.used_s = ctx.now
            ctx.progress.title = NAME
        self.expire(ctx.now)
        if self.finished:
            return
        demand, wanted = ctx.demand, self.wanted
        demand.enabled = True
        demand.wheel_speed_m_s, demand.belt_speed_m_s = wanted.wheel_m_s, wanted.belt_m_s
        demand.press = Press.LOAD if wanted.load_n > 0.0 else Press.LIFT
        demand.load_n = wanted.load_n
        demand.sideslip_deg, demand.camber_deg = wanted.sideslip_deg, wanted.camber_deg
        demand.surface_c = wanted.surface_c
        ctx.moving = ctx.now - self.moved_s < MOVING_S
        if self.taring is not None and self.taring.step(ctx):
            self._tared(ctx, self.taring)

    def expire(self, now: float) -> None:
        """End the mode when nobody has asked for anything for a minute, in a hold as well."""
        if self.left_s(now) <= 0.0:
            self.disarm()

    def disarm(self) -> None:
        """End the mode: a controlled stop follows."""
        self.finished = True

    # -- what a person may do ---------------------------------------------------------------------------------

    def jog(self, ctx: Context, axis: JogAxis, direction: int) -> str:
        """Take one step; return "" or why not."""
        refusal = self._busy(ctx)
        if refusal:
            return refusal
        if ctx.now - self.pressed_s < 1.0 / STEPS_PER_S:
            return f"no more than {STEPS_PER_S:g} steps a second"
        refusal = self._step(ctx, axis, float(direction))
        if not refusal:
            self.used_s = self.pressed_s = self.moved_s = ctx.now
        return refusal

    def tare(self, ctx: Context) -> str:
        """Begin a tare; return "" or why not."""
        refusal = self._busy(ctx)
        if refusal:
            return refusal
        r = ctx.readings
        if self.wanted.load_n > 0.0 or ctx.contact.in_contact:
            return "the wheel is in contact: lift it first"
        if abs(r.wheel_speed_m_s) > STANDING_M_S or abs(r.belt_speed_m_s) > STANDING_M_S:
            return "the rig moves: stop wheel and belt first"
        limits = ctx.rig.interlocks
        self.old = ctx.cell.tare
        reference = list(self.reference_tare)
        self.taring = TakeTare(TARE_S, reference, limits.zero_warn_n, limits.zero_stop_n, ends_run=False)
        self.used_s = ctx.now
        return ""

    def _busy(self, ctx: Context) -> str:
        if not ctx.readings.drives_enabled:
            return "the drives are not on yet"
        return "the load cell is being tared" if self.taring is not None else ""

    def _step(self, ctx: Context, axis: JogAxis, sign: float) -> str:
        wanted, bounds, r = self.wanted, self.bounds, ctx.readings
        loaded = wanted.load_n > 0.0 or not r.force_z_n < UNLOADED_N
        if axis in ("sideslip", "camber", "wheel", "belt") and loaded:
            return f"{axis} moves only with the wheel lifted; under load use both speeds together"
        if axis == "wheel":
            wanted.wheel_m_s = _within(wanted.wheel_m_s + sign * SPEED_STEP_M_S, 0.0, bounds.wheel_speed_m_s)
        elif axis == "belt":
            wanted.belt_m_s = _within(wanted.belt_m_s + sign * SPEED_STEP_M_S, 0.0, bounds.belt_speed_m_s)
        elif axis == "both":
            return self._turn(ctx, sign)
        elif axis == "sideslip":
            sideslip_deg = wanted.sideslip_deg + sign * ANGLE_STEP_DEG
            wanted.sideslip_deg = _within(sideslip_deg, -bounds.sideslip_deg, bounds.sideslip_deg)
        elif axis == "camber":
            camber_deg = wanted.camber_deg + sign * ANGLE_STEP_DEG
            wanted.camber_deg = _within(camber_deg, -bounds.camber_deg, bounds.camber_deg)
        elif axis == "press":
            return self._load(ctx, sign)
        elif axis == "heat":
            return self._warm(ctx, sign)
        return ""

    def _turn(self, ctx: Context, sign: float) -> str:
        """Take wheel and belt to another speed together, neither beyond what both can do."""
        wanted, bounds = self.wanted, self.bounds
        step = sign * SPEED_STEP_M_S
        pressed = wanted.load_n > 0.0 or not ctx.readings.force_z_n < STANDING_LOAD_N
        if pressed and min(wanted.wheel_m_s, wanted.belt_m_s) + step < SPEED_STEP_M_S - 1e-9:
            return f"under load wheel and belt turn at {SPEED_STEP_M_S:g} m/s at least: lift the wheel first"
        most = min(bounds.wheel_speed_m_s, bounds.belt_speed_m_s)
        wanted.wheel_m_s = _within(wanted.wheel_m_s + step, 0.0, max(most, wanted.wheel_m_s))
        wanted.belt_m_s = _within(wanted.belt_m_s + step, 0.0, max(most, wanted.belt_m_s))
        return ""

    def _load(self, ctx: Context, sign: float) -> str:
        """Take another load; from none to the first step that can be held, and from that to none."""
        wanted, least_n = self.wanted, least_load_n(ctx.rig)
        if sign > 0.0 and (wanted.wheel_m_s < 2.0 * STANDING_M_S or wanted.wheel_m_s != wanted.belt_m_s):
            return "load only with wheel and belt turning at the same speed"
        load_n = wanted.load_n + sign * LOAD_STEP_N
        if 0.0 < load_n < least_n:
            load_n = ceil(least_n / LOAD_STEP_N) * LOAD_STEP_N if sign > 0.0 else 0.0
        wanted.load_n = _within(load_n, 0.0, self.bounds.load_n)
        return ""

    def _warm(self, ctx: Context, sign: float) -> str:
        wanted, surface = self.wanted, ctx.readings.surface_c
        if wanted.wheel_m_s < 2.0 * STANDING_M_S:
            return "heat only with the wheel turning"
        if not isfinite(wanted.surface_c):
            if sign < 0.0 or not isfinite(surface):
                return "the heating is off"
            wanted.surface_c = float(round(surface))
        wanted.surface_c = min(wanted.surface_c + sign * HEAT_STEP_K, self.bounds.surface_c)
        if wanted.surface_c < ctx.rig.ambient_c:
            wanted.surface_c = float("nan")
        return ""

    def _tared(self, ctx: Context, tare: TakeTare) -> None:
        """Say what the tare has changed."""
        if tare.failed:
            self.tare_text = f"not taken: {tare.failed}"
        else:
            new = ctx.cell.tare
            self.reference_tare = list(new)
            shifts = ", ".join(
                f"{name} {b:.2f} ({b - a:+.2f})"
                for name, a, b in zip(("Fx", "Fy", "Fz", "Mz"), self.old, new, strict=True)
            )
            self.tare_text = f"zero from {tare.count} readings: {shifts}"
        ctx.journal.event(ctx.now, "tare", self.tare_text)
        self.taring = None


def take_over(run: Run, worn: WheelInfo | None = None) -> ManualExecutor:
    """Put a person in the place of the run's recipe, bounded by the rig alone; ``worn``: the wheel, None for a new one.

    A simulated rig gets such a wheel.
    """
    ctx, control = run.engine.ctx, run.engine.control
    control.bounds = rig_bounds(ctx.rig)
    hand = ManualExecutor(ctx.journal, control.bounds)
    run.engine.executor = hand
    if worn is None:
        ctx.attendant.install(1, 1, "1#", new_specimen=True)
    else:
        ctx.attendant.remount(1, 1, "1#", worn.diameter_mm, worn.sliding_m)
        ctx.wheel.installed_mm = worn.installed_diameter_mm
        ctx.wheel.loss_mm = worn.installed_diameter_mm - worn.diameter_mm
        ctx.wheel.sliding_m = worn.sliding_m
    return hand


def empty_plan() -> Plan:
    """Return the plan of a run without a recipe."""
    return Plan(NAME, (), (), (), 0.0, 1)


def open_record(runs: Path, rig: RigConfig, operator: str, accept_risk: str = "") -> RunWriter:
    """Return the journal of one stay in manual mode: a record of its own, without samples, in ``runs/.manual``.

    It is no run: it holds commands, modes, trips and tares, and no listing of runs shows it. Raises OSError,
    sqlite3.Error, StoreError.
    """
    folder = make_folder(runs / MANUAL_RUNS, NAME)
    writer = Unsampled(folder / DATABASE, clock=clock.monotonic, utc=clock.utc_now)
    started_utc = clock.utc_now()
    info = RunInfo(folder.name, NAME, "", rig.text, started_utc, rig.simulated, operator=operator,
                   metadata=accepted_risks(rig, accept_risk))  # fmt: skip
    writer.begin_run(info, [], [])
    return writer


def _within(value: float, low: float, high: float) -> float:
    """Return a value held between two limits, on a grid that steps cannot leave."""
    return round(min(max(value, low), high), 6)
