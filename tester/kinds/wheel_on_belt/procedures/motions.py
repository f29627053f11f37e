"""The moves of this machine: lift, turn, load, yaw, tare. Common moves are in ``tester.machine.motions``.

An activity's ``step`` writes the demand it needs and returns True in the scan in which it is done. An activity keeps
its state in plain attributes, so that it can be copied while it runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import CELL, Press, Readings
from tester.kinds.wheel_on_belt.procedures.lift_check import loaded
from tester.machine.motions import Move, ZeroOfCell

SPEED_SHARE: Final = 0.01
SPEED_FLOOR_M_S: Final = 0.003
"""A speed counts as reached within the greater of 1 % and this [A]."""

NEAR: Final = 0.05
"""Tolerance of a positioned axis, in its unit (deg) [A]."""
LIFTED_N: Final = 5.0
"""Below this force the wheel counts as lifted [A]."""
LIFTED_MM: Final = 0.3
"""... or within this distance of the lifted position: the cell's zero may have drifted by more than that force [A]."""


class Lift(Move):
    """Take the wheel off the belt."""

    limit_s = 30.0  # [A]; the whole travel takes 3 s
    name = "lifting"

    def step(self, ctx: Context) -> bool:
        """Done when the force is gone, or the press is back: the cell then shows only its zero."""
        ctx.demand.press = Press.LIFT
        ctx.demand.load_n = 0.0
        ctx.moving = True
        if ctx.contact.in_contact:
            return False
        force, lifted_mm = ctx.readings.force_z_n, ctx.contact.lifted_mm(ctx.rig.loops.load)
        return force < LIFTED_N or (isfinite(force) and ctx.readings.press_mm <= lifted_mm + LIFTED_MM)


class Turn(Move):
    """Bring wheel and belt to their speeds (m/s)."""

    limit_s = 30.0  # [A]; the ramps take under a second
    name = "reaching the speeds"

    def __init__(self, wheel_m_s: float, belt_m_s: float) -> None:
        """Line speeds of wheel and belt."""
        self.wheel_m_s = wheel_m_s
        self.belt_m_s = belt_m_s

    def step(self, ctx: Context) -> bool:
        """Done when both are reached."""
        ctx.demand.wheel_speed_m_s = self.wheel_m_s
        ctx.demand.belt_speed_m_s = self.belt_m_s
        ctx.moving = True
        return speeds_reached(ctx)


def speeds_reached(ctx: Context) -> bool:
    """Return whether both measured speeds are at their demands."""
    r, d = ctx.readings, ctx.demand
    return abs(r.wheel_speed_m_s - d.wheel_speed_m_s) <= max(
        SPEED_SHARE * abs(d.wheel_speed_m_s), SPEED_FLOOR_M_S
    ) and abs(r.belt_speed_m_s - d.belt_speed_m_s) <= max(SPEED_SHARE * abs(d.belt_speed_m_s), SPEED_FLOOR_M_S)


class Load(Move):
    """Press to a load (N) and wait until it stays within ``percent`` for ``for_s`` seconds."""

    limit_s = 180.0  # [A]; a first touch takes 15 s
    name = "loading"

    def __init__(self, load_n: float, *, percent: float = 2.0, for_s: float = 1.0, quick: bool = False) -> None:
        """``quick``: the fast approach to a known contact."""
        self.load_n = load_n
        self.percent = percent
        self.for_s = for_s
        self.quick = quick
        self.since_s = float("inf")

    def step(self, ctx: Context) -> bool:
        """Done when the averaged load has been in band long enough."""
        ctx.demand.press = Press.LOAD
        ctx.demand.load_n = self.load_n
        ctx.demand.quick_touch = self.quick
        ctx.gates.target.load_n = self.load_n
        ctx.moving = True
        inside = abs(ctx.gates.load.value - self.load_n) <= 0.01 * self.percent * self.load_n
        self.since_s = min(self.since_s, ctx.now) if inside else float("inf")
        return ctx.now - self.since_s >= self.for_s


def straight(r: Readings) -> dict[str, float]:
    """Return the straight position of each positioned axis, 0, by name."""
    return dict.fromkeys(r.positions, 0.0)


def near(r: Readings, positions: Mapping[str, float]) -> bool:
    """Return whether positioned axes are at positions, by name."""
    return all(abs(r.positions[name] - wanted) < NEAR for name, wanted in positions.items())


class Yaw(Move):
    """Bring positioned axes to positions, by name, in their units; only while unloaded."""

    limit_s = 60.0  # [A]; 30 degrees take 2 s
    name = "reaching the angles"

    def __init__(self, positions: Mapping[str, float] | None = None) -> None:
        """``positions``: the targets; None: zero for all, straight."""
        self.positions = positions
        self.began_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Done when the axes report their targets reached at the wanted positions."""
        wanted = self.positions if self.positions is not None else straight(ctx.readings)
        ctx.demand.positions.update(wanted)
        ctx.moving = True
        return near(ctx.readings, wanted) and ctx.readings.yaw_reached


class TakeTare(ZeroOfCell):
    """Average the unloaded load cell over whole turns and make that its zero.

    The reference zero (the first of this wheel) is kept: a later zero that differs by more than
    ``interlocks.zero_stop`` means a damaged or touching cell. A reference beyond the limit for an unloaded cell
    (``arming.unloaded``) is not taken.
    """

    def __init__(self, seconds: float, reference: list[float], *, ends_run: bool = True) -> None:
        """``reference``: shared list, empty until the first tare fills it.

        ``ends_run``: a zero that has drifted too far ends the run. The run stops with the new zero: with the previous
        zero its stop would mistake the cell's drift for a load. Without ``ends_run`` the new zero is not used.
        """
        super().__init__(seconds)
        self.reference = reference
        self.ends_run = ends_run
        self.drift_n = 0.0
        """Drift of the zero from the reference, N: the greatest of the forces."""

    def step(self, ctx: Context) -> bool:
        """Done when the average is taken; ``failed``: why the zero is not trustworthy."""
        r = ctx.readings
        if not self.averaged(ctx, r.cell_at_s, r.cell, valid=r.cell_valid):
            return bool(self.failed)
        new = self.zero(ctx.cell.tare)
        if not self.reference:
            # The first tare has no reference: a bound on its size keeps it from hiding a load.
            self.failed = loaded(new, ctx.rig)
            if not self.failed:
                self.reference.extend(new)
                self._take(ctx, "reference", new)
            return True
        self.failed = self._wandered(ctx, new)
        if self.ends_run or not self.failed:
            self._take(ctx, "repeat", new)
        return True

    def _take(self, ctx: Context, kind: str, new: tuple[float, ...]) -> None:
        ctx.cell.set_tare(new)
        ctx.journal.tare(ctx.now, kind, dict(zip(CELL, new, strict=True)), ctx.repeat_key)

    def _wandered(self, ctx: Context, new: tuple[float, ...]) -> str:
        """Return "", or a zero's excessive deviation from the reference; journal a deviation beyond ``zero_warn_n``."""
        limits = ctx.rig.interlocks
        self.drift_n = drift = max(abs(n - r) for n, r in zip(new[:3], self.reference[:3], strict=True))
        text = f"load cell zero drifted by {drift:.1f} N since the wheel's reference tare"
        if drift > limits.zero_warn_n:
            ctx.journal.event(ctx.now, "tare", text, "warning")
        return text if drift > limits.zero_stop_n else ""
