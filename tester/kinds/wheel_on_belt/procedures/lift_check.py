"""Lifts the press before anything else moves, and proves with the load cell that the wheel is free.

The press's position alone proves nothing: its encoder's zero may be wrong, and the press is never homed. The cell is
read without tare, since a tare taken under load would hide that load from everything after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from math import hypot, inf, nan

from drivers.cia402 import Goal, State
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.connect import Lifting
from tester.machine.proof import ENABLE_S

LIFT_S = 6.0
"""Longest time for lifting [A]: the press's whole travel at its lifting speed takes 3 s."""
LIFTED_MM = 0.3
SETTLE_S = 0.3
"""Age from which a reading counts after the lift, s [A]: a press at 10 mm/s is at rest 0.2 s after the command."""
SILENT_S = 1.0
"""Time without a valid reading after which the cell counts as silent, s [A]: it is read with every tick."""


class LiftStage(Enum):
    """Stage of the lifting."""

    ENABLE = "enable the press"
    LIFT = "lift the press"
    ASK = "ask the load cell"
    WATCH = "lifted"


class Unloaded(Lifting):
    """Lifts the press, with one call of ``step`` per scan; ``trouble`` then reports whether it stays unloaded.

    ``failure``: the reason why the rig may be loaded; "" for none.
    """

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Move nothing before the first ``step``; only the press's drive is enabled here."""
        self.devices = devices
        self.rig = rig
        self.done = False
        self.stage = LiftStage.ENABLE
        self.since_s = nan
        self.good_s = -inf
        """When the last valid reading arrived."""
        self.first_n = nan
        """Normal force before the press moved."""

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""
        if self.since_s != self.since_s:
            self.since_s = now
        self._note()
        elapsed = now - self.since_s
        if self.stage is LiftStage.ENABLE:
            self._enable(now, elapsed)
        elif self.stage is LiftStage.LIFT:
            self._lift(now, elapsed)
        elif self.stage is LiftStage.ASK:
            self._ask(elapsed)
        self.done = self.stage is LiftStage.WATCH or bool(self.failure)
        if self.failure:
            self.stop()

    def trouble(self, now: float) -> str:
        """Return "", or the reason why the rig, once found unloaded, may be loaded again."""
        if self.stage is not LiftStage.WATCH:
            return ""
        self._note()
        bounds = self.rig.interlocks
        if not now - self.good_s <= bounds.stale_cell_s + bounds.stale_cell_delay_s:
            return "load cell silent: a touching wheel would go unnoticed"
        return self._shown()

    def stop(self) -> None:
        """Cut the press's power; the other drives have none."""
        press = self.devices.axes.press
        press.target = 0.0
        press.goal = Goal.DISABLED

    def _note(self) -> None:
        cell = self.devices.cell
        if cell.valid:
            self.good_s = cell.stamp_s

    def _enter(self, stage: LiftStage, now: float) -> None:
        self.stage = stage
        self.since_s = now

    def _enable(self, now: float, elapsed: float) -> None:
        press = self.devices.axes.press
        press.target = 0.0
        press.goal = Goal.ENABLED
        if press.state is State.OPERATION_ENABLED:
            self.first_n = abs(self.devices.cell.raw[2])
            self._enter(LiftStage.LIFT, now)
        elif elapsed > ENABLE_S:
            self.failure = f"the press is not enabled after {ENABLE_S:g} s"

    def _lift(self, now: float, elapsed: float) -> None:
        press, force_n = self.devices.axes.press, abs(self.devices.cell.raw[2])
        if press.actual <= LIFTED_MM:
            press.target = 0.0
            self._enter(LiftStage.ASK, now)
        elif not force_n <= self.first_n + self.rig.arming.unloaded_n:
            self.failure = (
                f"the force rose from {self.first_n:.0f} N to {force_n:.0f} N while the press was to lift:"
                " does the press move the other way?"
            )
        elif elapsed > LIFT_S:
            self.failure = f"the press is at {press.actual:.1f} mm, not lifted, after {LIFT_S:g} s"
        else:
            press.target = -self.rig.loops.load.lift_speed_mm_s

    def _ask(self, elapsed: float) -> None:
        if self.good_s > self.since_s + SETTLE_S:
            self.failure = self._shown()
            if not self.failure:
                self.stage = LiftStage.WATCH
        elif elapsed > SETTLE_S + SILENT_S:
            self.failure = f"the load cell gave no valid reading for {SILENT_S:g} s with the press lifted"

    def _shown(self) -> str:
        shown = loaded(self.devices.cell.raw, self.rig)
        if not shown:
            return ""
        return (
            f"{shown}, and the press shows {self.devices.axes.press.actual:.1f} mm (0 = lifted):"
            " the press's zero is wrong, the cell's zero is wrong, or the wheel touches"
        )


def loaded(raw: Sequence[float], rig: RigConfig) -> str:
    """Return "", or the load on a cell that should be unloaded; ``raw``: Fx, Fy, Fz in N, Mz in N m, without tare."""
    fx, fy, fz, _ = raw
    friction_n, bound_n = hypot(fx, fy), rig.arming.unloaded_n
    if abs(fz) <= bound_n and friction_n <= bound_n:
        return ""
    return (
        f"the load cell shows Fz {fz:.1f} N and friction {friction_n:.1f} N without tare,"
        f" unloaded it is {bound_n:g} N at most (arming.unloaded)"
    )
