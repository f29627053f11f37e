"""The proofs before every run: both drives follow, brake alike, and every drive stops without our heartbeat.

They run unloaded: ``tester.kinds.wheel_on_belt.procedures.lift_check`` ensures that, and keeps watching.
"""

from __future__ import annotations

from enum import Enum
from math import inf

from drivers.canopen import objects as o
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.lift_check import LIFTED_MM, Unloaded, loaded
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.wheel_rig import EQUAL_DECELERATIONS
from tester.machine.connect import Arming
from tester.machine.proof import ProofStage, WatchdogProof

BUMP_S = 0.3
"""Time for ramp and lag: 25 ms at 2 m/s2 to 0.05 m/s [A]."""
BUMP_SHARE = 0.3
"""Tolerance of a speed as a share of its target, and of the other drive's standstill [A]."""
PRESS_BUMP_MM_S = 2.0
PRESS_BUMP_MM = 0.2
"""Least motion of the press in the bump test, away from rest and back [A]."""


class Bump(Enum):
    """The drive that the bump test moves."""

    WHEEL = "turn the wheel"
    BELT = "turn the belt"
    PRESS = "move the press"


class Proof(WatchdogProof):
    """Proves that wheel, belt and press follow, each alone, and that they stop without our heartbeat."""

    unloaded = ("lifted and unloaded", "decelerations equal")

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Move nothing before the first ``step``."""
        arming = rig.arming
        super().__init__(devices, follow=arming.bump_test, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
        self.axes = devices.axes
        self.lease = devices.jacket.has_lease
        self.heat_off = rig.devices["jacket"].heat_off
        self.creep_m_s = arming.creep_m_s
        self.bump = Bump.WHEEL
        self.pressed_from_mm = 0.0
        self.radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
        self.failure = unequal_decelerations(devices, self.radius_m)

    def watchdogs(self, shown: list[str], left_out: list[str]) -> None:
        """Sort the watchdogs of drives and jacket into proved and unproved ones."""
        super().watchdogs(shown, left_out)
        if self.lease or self.heat_off != "fallback":
            (shown if self.lease else left_out).append("jacket's lease set and read back")
        else:
            shown.append("the setpoint that the jacket falls back to set and read back")
            left_out.append("that it falls back")

    def still(self) -> bool:
        """Return whether wheel and belt stand."""
        axes, least = self.axes, 0.1 * self.creep_m_s
        return abs(axes.wheel.actual) * self.radius_m < least and abs(axes.belt.actual) < least

    def begin(self, now: float) -> None:
        """Turn the wheel; turn both if no proof that each follows is needed."""
        self.bump = Bump.WHEEL
        self._creep(belt=not self.follow)

    def _creep(self, *, belt: bool) -> None:
        axes, creep = self.axes, self.creep_m_s
        axes.wheel.target = creep / self.radius_m
        axes.belt.target = creep if belt else 0.0

    def move(self, now: float, elapsed: float) -> bool:
        """Check that each drive follows, one after the other."""
        if elapsed < BUMP_S:
            return False
        if self.bump is Bump.PRESS:
            return self._pressed()
        axes, creep = self.axes, self.creep_m_s
        wheel, belt = axes.wheel.actual * self.radius_m, axes.belt.actual
        second = self.bump is Bump.BELT or not self.follow
        near = BUMP_SHARE * creep
        if not abs(wheel - creep) <= near:
            self.failure = f"the wheel turns at {wheel:.3f} m/s, asked for {creep:g} m/s"
        elif not abs(belt - (creep if second else 0.0)) <= near:
            asked = f"{creep:g} m/s" if second else "standstill"
            self.failure = f"the belt runs at {belt:.3f} m/s, asked for {asked}"
        elif not second:
            self._creep(belt=True)
            self._next(Bump.BELT, now)
        elif self.follow:
            self.pressed_from_mm = axes.press.actual
            axes.press.target = PRESS_BUMP_MM_S
            self._next(Bump.PRESS, now)
        else:
            return True
        return False

    def _next(self, bump: Bump, now: float) -> None:
        self.bump = bump
        self.enter(ProofStage.MOVE, now)

    def _pressed(self) -> bool:
        press = self.axes.press
        moved = press.actual - self.pressed_from_mm
        press.target = 0.0
        if not moved >= PRESS_BUMP_MM:
            self.failure = f"the press moved by {moved:.2f} mm, asked for {BUMP_S * PRESS_BUMP_MM_S:.2f} mm"
        return True


def unequal_decelerations(devices: Devices, radius_m: float) -> str:
    """Return "", or the difference of the ramps read back from wheel and belt, m/s2."""
    wheel, belt = devices.axes.wheel, devices.axes.belt
    for index, name in ((o.PROFILE_DECELERATION, "deceleration"), (o.QUICK_STOP_DECELERATION, "quick stop")):
        at_rim = wheel.parameters.get((index, 0), 0) / wheel.config.acceleration_counts * radius_m
        of_belt = belt.parameters.get((index, 0), 0) / belt.config.acceleration_counts
        if not abs(at_rim - of_belt) <= EQUAL_DECELERATIONS * of_belt:
            return f"{name}: wheel {at_rim:.3g} m/s2 at the rim, belt {of_belt:.3g} m/s2: must be equal within 5 %"
    return ""


class WheelArming(Arming[Devices, RigConfig]):
    """Lifts the press, checks the load cell, and proves that the drives follow, and stop without our heartbeat."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Send nothing."""
        super().__init__(devices, rig)
        self._least_n, self._most_n = inf, -inf

    def at_rest(self) -> str:
        """Return the load on the cell, or its noise where that looks like a touch; a press that is down counts for
        nothing, because a run lifts it first.
        """
        devices, touch_n = self.devices, self.rig.loops.load.touch_load_n
        if not devices.axes.press.actual <= LIFTED_MM:
            return ""
        force_n = devices.cell.raw[2]
        self._least_n, self._most_n = min(self._least_n, force_n), max(self._most_n, force_n)
        shown = loaded(devices.cell.raw, self.rig)
        if shown or not 0.5 * (self._most_n - self._least_n) > touch_n:
            return shown
        return (
            f"the load cell's Fz is noisy, {self._least_n:.1f} to {self._most_n:.1f} N at rest: a press that approaches"
            f" would take it for a touch, {touch_n:g} N (loops.load.touch_load)"
        )

    def renew(self) -> None:
        """Renew the jacket's lease; it stays in standby."""
        self.devices.jacket.set_setpoint(self.rig.loops.heat.hub_min_c)

    def lift(self) -> Unloaded:
        """Lift the press, and check the load cell."""
        return Unloaded(self.devices, self.rig)

    def prove(self) -> Proof:
        """Begin the proof of the drives."""
        return Proof(self.devices, self.rig)
