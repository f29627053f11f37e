"""Manual mode of this machine: its axes, their steps, and the reasons for refusing a step.

Single speeds and angles move only while lifted: under load a wheel that turns faster than its belt grinds.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, isfinite
from typing import Final

from tester.base.screen import HandAxis
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.control.loops import UNLOADED_N as STANDING_LOAD_N
from tester.kinds.wheel_on_belt.control.permissives import Bounds, rig_bounds
from tester.kinds.wheel_on_belt.image.axes import POSITIONED, straight
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.motions import TakeTare
from tester.kinds.wheel_on_belt.recipe.limits import least_load_n
from tester.kinds.wheel_on_belt.served.left_on_rig import WheelLeft
from tester.machine.hand import Hand
from tester.machine.run import Run

SPEED_STEP_M_S: Final = 0.05
LOAD_STEP_N: Final = 10.0
HEAT_STEP_K: Final = 1.0
UNLOADED_N: Final = 5.0
STANDING_M_S: Final = 0.02
TARE_S: Final = 2.0

POSITION_STEPS: Final = {axis.name: axis.step for axis in POSITIONED}

HAND: Final = (
    HandAxis("wheel", "Wheel speed", "0.05 m/s a step, lifted"),
    HandAxis("belt", "Belt speed", "0.05 m/s a step, lifted"),
    HandAxis("both", "Both speeds", "0.05 m/s a step"),
    HandAxis("press", "Load", "10 N a step, speeds equal"),
    *(HandAxis(axis.name, axis.name.capitalize(), f"{axis.step:g}{axis.symbol} a step, lifted") for axis in POSITIONED),
    HandAxis("heat", "Heating", "1 K a step, turning"),
)
"""Axes of manual mode, in the order of the screen."""


@dataclass(slots=True)
class Asked:
    """The state that the person has requested."""

    wheel_m_s: float = 0.0
    belt_m_s: float = 0.0
    load_n: float = 0.0
    positions: dict[str, float] = field(default_factory=straight)
    surface_c: float = float("nan")


class WheelHand(Hand):
    """Turns a person's steps into demands."""

    def __init__(self, bounds: Bounds) -> None:
        """Begin at rest and lifted. ``bounds``: for the person and control."""
        super().__init__()
        self.wanted = Asked()
        self.bounds = bounds
        self.reference_tare: list[float] = []
        self.old = (0.0, 0.0, 0.0, 0.0)

    def demand(self, ctx: Context) -> None:
        """Write the demand for the requested state."""
        demand, wanted = ctx.demand, self.wanted
        demand.wheel_speed_m_s, demand.belt_speed_m_s = wanted.wheel_m_s, wanted.belt_m_s
        demand.press = Press.LOAD if wanted.load_n > 0.0 else Press.LIFT
        demand.load_n = wanted.load_n
        demand.positions.update(wanted.positions)
        demand.surface_c = wanted.surface_c

    def tare(self, ctx: Context) -> str:
        """Begin a tare; return "", or the reason for refusing."""
        r = ctx.readings
        if self.wanted.load_n > 0.0 or ctx.contact.in_contact:
            return "the wheel is in contact: lift it first"
        if abs(r.wheel_speed_m_s) > STANDING_M_S or abs(r.belt_speed_m_s) > STANDING_M_S:
            return "the rig moves: stop wheel and belt first"
        self.old = ctx.cell.tare
        self.taring = TakeTare(TARE_S, list(self.reference_tare), ends_run=False)
        return ""

    def step(self, ctx: Context, axis: str, sign: float) -> str:
        """Take one step of an axis; return "", or the reason for refusing."""
        wanted, bounds, r = self.wanted, self.bounds, ctx.readings
        loaded = wanted.load_n > 0.0 or not r.force_z_n < UNLOADED_N
        if loaded and axis in ("wheel", "belt", *wanted.positions):
            return f"{axis} moves only with the wheel lifted; under load use both speeds together"
        if axis == "wheel":
            wanted.wheel_m_s = _within(wanted.wheel_m_s + sign * SPEED_STEP_M_S, 0.0, bounds.wheel_speed_m_s)
        elif axis == "belt":
            wanted.belt_m_s = _within(wanted.belt_m_s + sign * SPEED_STEP_M_S, 0.0, bounds.belt_speed_m_s)
        elif axis == "both":
            return self._turn(ctx, sign)
        elif axis in wanted.positions:
            position, most = wanted.positions[axis] + sign * POSITION_STEPS[axis], bounds.positions[axis]
            wanted.positions[axis] = _within(position, -most, most)
        elif axis == "press":
            return self._load(ctx, sign)
        elif axis == "heat":
            return self._warm(ctx, sign)
        return ""

    def _turn(self, ctx: Context, sign: float) -> str:
        """Bring wheel and belt to another speed together, within the limits of both."""
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
        """Change the load by a step: from none to the least load that can be held, and back to none."""
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

    def zero(self, ctx: Context) -> str:
        """Return the zeros of the forces and of the moment, and their changes, N and N m."""
        new = ctx.cell.tare
        self.reference_tare = list(new)
        named = zip(("Fx", "Fy", "Fz", "Mz"), self.old, new, strict=True)
        return ", ".join(f"{name} {b:.2f} ({b - a:+.2f})" for name, a, b in named)


def take_over(run: Run, left: WheelLeft | None = None) -> tuple[WheelHand, str]:
    """Let a person command the run instead of its recipe; ``left``: the mounted wheel, None for a new wheel.

    A simulated rig gets this wheel. Return the hand, and the assumed wheel in words.
    """
    ctx, control = run.engine.ctx, run.engine.control
    control.bounds = rig_bounds(ctx.rig)
    worn = left.wheel if left is not None else None
    if worn is None:
        ctx.attendant.install(1, 1, "1#", new_specimen=True)
    else:
        ctx.attendant.remount(1, 1, "1#", worn.diameter_mm, worn.sliding_m)
        ctx.wheel.installed_mm = worn.installed_diameter_mm
        ctx.wheel.loss_mm = worn.installed_diameter_mm - worn.diameter_mm
        ctx.wheel.sliding_m = worn.sliding_m
    return WheelHand(control.bounds), taken_for(left, ctx.wheel.cold_mm)


def taken_for(left: WheelLeft | None, diameter_mm: float) -> str:
    """Return the assumed wheel on the rig, for people; ``diameter_mm``: the assumed diameter."""
    known = f"as {left.run} left it" if left is not None else "a new one: no run on this rig shows otherwise"
    return f"the wheel is taken to have {diameter_mm:.2f} mm, {known}"


def _within(value: float, low: float, high: float) -> float:
    """Return a value limited to a range, rounded so that repeated steps stay on their grid."""
    return round(min(max(value, low), high), 6)
