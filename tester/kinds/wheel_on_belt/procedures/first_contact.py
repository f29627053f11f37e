"""A wheel's first contact: at a small load the belt goes above and below the wheel's speed; friction must reverse.

Friction is zero while the wheel rolls as fast as the belt. If it keeps its sign while the belt goes from slightly
faster to slightly slower than the wheel, one of the speeds is wrong: a drive turns the wrong way, its scale is wrong,
or the wheel has another diameter. The check finds each at a load that a hand could hold.
"""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Turn
from tester.kinds.wheel_on_belt.recipe.measured_wheels import off_place_mm
from tester.kinds.wheel_on_belt.recipe.twin_law import CLEAR_SHARE, LEAST_N
from tester.machine.activity import MoveFailedError
from tester.machine.motions import Power, Sequence

OFF: Final = "speed ratio of wheel and belt is off (direction, scale or diameter)"
SETTLE_S: Final = 0.4
"""Time from the belt's new speed to the first reading that counts, s [A]: its ramp, and the build-up of the contact."""
AVERAGE_S: Final = 0.6
"""Averaging time of friction, s [A]: about one turn of the runout at 0.4 m/s."""
TOUCH_AT_MOST_S: Final = 60.0
"""Longest time for a first touch, s [A]; after it the wheel is not found."""


APPROACH: Final = 2.0
"""Factor of the load that sets the speed of approach far from the wheel's expected place [A]."""
NEAR: Final = 1.2
"""The approach is slow within this many tolerances of the expected place [A]: from 0.3 mm before the tolerance on."""


class Touch:
    """Press to a small load; the wheel must be at the place given by its diameter."""

    def __init__(self, load_n: float, off_mm: float) -> None:
        """``off_mm``: allowed distance of the first touch from its expected place."""
        self.load_n = load_n
        self.off_mm = off_mm
        self.touched_s = float("nan")
        self.began_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Done when the load is reached; raises MoveFailedError for a wheel of another diameter."""
        ctx.moving = True
        if not isfinite(self.began_s):
            self.began_s = ctx.now
        r = ctx.readings
        expected_mm = ctx.rig.geometry.touch_at_mm(r.diameter_mm)
        touched_mm = ctx.contact.contact_mm
        place_mm = touched_mm if ctx.contact.in_contact and isfinite(touched_mm) else r.press_mm
        near = ctx.contact.in_contact or not place_mm < expected_mm - NEAR * self.off_mm
        # The speed of the approach follows the wanted load: farther from the wheel it may be higher.
        load_n = self.load_n if near else APPROACH * self.load_n
        ctx.demand.press, ctx.demand.load_n, ctx.demand.quick_touch = Press.LOAD, load_n, False
        ctx.gates.target.load_n = self.load_n
        early = ctx.contact.in_contact and not place_mm >= expected_mm - self.off_mm
        if early or not place_mm <= expected_mm + self.off_mm:
            what = "touched" if ctx.contact.in_contact else "not touched yet"
            raise MoveFailedError(f"{OFF}: the wheel is {what} at {place_mm:.2f} mm, expected at {expected_mm:.2f} mm")
        if ctx.now - self.began_s > TOUCH_AT_MOST_S:
            raise MoveFailedError(f"the wheel is not touched after {TOUCH_AT_MOST_S:g} s")
        if ctx.contact.in_contact and not isfinite(self.touched_s):
            self.touched_s = ctx.now
        return ctx.contact.in_contact and ctx.now - self.touched_s >= SETTLE_S


class Friction:
    """Average friction and load at a speed of the wheel and another speed of the belt."""

    def __init__(self, wheel_m_s: float, belt_m_s: float) -> None:
        """Both speeds, m/s."""
        self.turn = Turn(wheel_m_s, belt_m_s)
        self.reached_s = float("nan")
        self.friction_n = self.load_n = 0.0
        self.count = 0

    def step(self, ctx: Context) -> bool:
        """Done when there are enough readings."""
        ctx.moving = True
        if not isfinite(self.reached_s):
            if self.turn.step(ctx):
                self.reached_s = ctx.now
            return False
        past_s = ctx.now - self.reached_s
        if past_s >= SETTLE_S:
            self.friction_n += ctx.readings.force_x_n
            self.load_n += ctx.readings.force_z_n
            self.count += 1
        return past_s >= SETTLE_S + AVERAGE_S and self.count > 0

    @property
    def sign(self) -> float:
        """Direction of friction on the wheel: 1 back, -1 forward, 0 unclear."""
        mean_n = self.friction_n / self.count
        clear_n = max(LEAST_N, CLEAR_SHARE * self.load_n / self.count)
        return 1.0 if mean_n > clear_n else -1.0 if mean_n < -clear_n else 0.0


class SpeedSweep:
    """Bring the belt above and below the wheel's speed; friction must reverse in between."""

    def __init__(self, wheel_m_s: float, sweep_m_s: float) -> None:
        """The wheel's speed, and the belt's greatest difference to either side, m/s."""
        self.wheel_m_s = wheel_m_s
        self.faster = Friction(wheel_m_s, wheel_m_s + sweep_m_s)
        self.slower = Friction(wheel_m_s, wheel_m_s - sweep_m_s)
        self.moves = Sequence(self.faster, self.slower)

    def step(self, ctx: Context) -> bool:
        """Done when friction has reversed; raises MoveFailedError if it has not."""
        if not self.moves.step(ctx):
            return False
        faster, slower = self.faster, self.slower
        text = (
            f"Fx {faster.friction_n / faster.count:.1f} N with the belt at {faster.turn.belt_m_s:.3f} m/s,"
            f" {slower.friction_n / slower.count:.1f} N at {slower.turn.belt_m_s:.3f} m/s,"
            f" wheel at {self.wheel_m_s:g} m/s"
        )
        if not (faster.sign < 0.0 < slower.sign):
            raise MoveFailedError(f"{OFF}: {text}")
        ctx.journal.event(ctx.now, "first contact", f"friction turns round with the slip: {text}")
        return True


class FirstContact:
    """The whole first contact: touch, sweep slowly, then faster, lift. The wheel is free before and after it.

    The first sweep is slow: drives that turn against each other then make little slip.
    """

    def __init__(self) -> None:
        """Move nothing before the first step."""
        self.moves: Sequence | None = None

    def resume(self, ctx: Context) -> None:
        """Start again after a hold."""
        self.moves = None

    def step(self, ctx: Context) -> bool:
        """Done when lifted again; raises MoveFailedError if a check fails."""
        ctx.progress.phase = "first contact"
        if self.moves is None:
            p = ctx.rig.interlocks
            share, creep = p.first_contact_sweep, p.first_contact_creep_m_s
            slow, fast = p.first_contact_slow_m_s, p.first_contact_fast_m_s
            off_mm = off_place_mm(ctx.rig, ctx.readings.diameter_mm)
            self.moves = Sequence(
                Power(True), Lift(), Turn(slow, slow), Touch(p.first_contact_load_n, off_mm),
                SpeedSweep(slow, share * slow + creep), SpeedSweep(fast, share * fast + creep),
                Turn(fast, fast), Lift(), Turn(0.0, 0.0),
            )  # fmt: skip
        return self.moves.step(ctx)

