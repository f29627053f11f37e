"""A check of the load cell's zero after long contact: between two steps in contact, never in a repeat or a soak.

Every repeat lifts and takes its zero first; heating up, soaks and pre-grinding keep the contact throughout.
"""

from __future__ import annotations

from math import inf
from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.procedures.motions import Lift, TakeTare, Turn
from tester.kinds.wheel_on_belt.procedures.wear_estimate import loss_per_n_m
from tester.machine.activity import MoveFailedError
from tester.machine.motions import Sequence, Settle

TARE_S: Final = 1.0
"""Averaging time of the zero, s [A]: about three turns."""
DEEPER_SHARE: Final = 0.5
"""Share of the depth that "contact too deep" allows: the wheel is touched again beyond it."""
LEARNING_SHARE: Final = 0.25
"""... while its wear rate is unknown."""
KNOWN_SHARE: Final = 0.1
"""A rate counts as known with this relative standard uncertainty [A]: half of what a wheel's life allows."""
INFORMS_MM: Final = 0.2
"""Standard uncertainty of the loss since the last touch from which a new one pays, mm of diameter [A]: four times that
of a touch."""
TOUCH_AGAIN_S: Final = 15.0
"""Least time from one touch to the next, s [A]: a run with soft rubber gets on all the same."""
SETTLE_S: Final = 0.4
"""Settling time of the cell after lifting, s [A]."""


def contact_s(ctx: Context) -> float:
    """Return the time of uninterrupted contact so far, s; 0 without contact."""
    return max(0.0, ctx.now - ctx.gates.touched_s)


def is_due(ctx: Context) -> bool:
    """Return whether to lift, check the zero and touch again before the contact continues."""
    return contact_s(ctx) > ctx.rig.interlocks.zero_check_every_s or deeper(ctx)


def informs(ctx: Context) -> bool:
    """Return whether a touch would tell a wear rate that is unlike the believed one and not known yet.

    One touch after a long grind cannot tell wear from the dent that its load has left; several on the way can, because
    the dent stays and the wear grows.
    """
    wheel, estimate = ctx.wheel, ctx.wheel.estimate
    if contact_s(ctx) < TOUCH_AGAIN_S or estimate.u_rate <= KNOWN_SHARE * estimate.rate_mm3_per_n_m:
        return False
    unsure_mm = estimate.u_rate * estimate.since(wheel.exposure_n_m) * loss_per_n_m(wheel.cold_mm, wheel.width_mm)
    return unsure_mm > INFORMS_MM and (wheel.followed or deeper(ctx, LEARNING_SHARE))


def deeper(ctx: Context, share: float = DEEPER_SHARE) -> bool:
    """Return whether the press is deeper than its load needs, by a share of what "contact too deep" allows.

    The wheel wears faster than believed, or its rubber gives way: a new touch shows where it begins now. A cell that
    reads too little touches at the old place, and the interlock trips.
    """
    if contact_s(ctx) < TOUCH_AGAIN_S:
        return False
    r, p = ctx.readings, ctx.rig.interlocks
    needed_mm = depth_mm(r.force_z_n, ctx.rig.loops.load.stiffness_n_per_mm)
    allowed_mm = (p.depth_factor - 1.0) * needed_mm + p.depth_margin_mm
    return r.press_mm - ctx.view.contact_mm > needed_mm + share * allowed_mm


class ZeroCheck:
    """Lift at matched speeds, let the cell settle, take its zero, and record its drift."""

    def __init__(self, wheel_speed_m_s: float, reference_tare: list[float]) -> None:
        """``reference_tare``: the wheel's first zero."""
        self.wheel_speed_m_s = wheel_speed_m_s
        self.reference_tare = reference_tare
        self.after_s = -inf
        self.tare: TakeTare | None = None
        self.moves = Sequence()

    def step(self, ctx: Context) -> bool:
        """Done when lifted with the new zero; raises MoveFailedError if the zero has drifted too far."""
        if self.tare is None:
            self.after_s = contact_s(ctx)
            speed = self.wheel_speed_m_s
            self.tare = TakeTare(TARE_S, self.reference_tare)
            self.moves = Sequence(Turn(speed, speed), Lift(), Settle(SETTLE_S), self.tare)
        if not self.moves.step(ctx):
            return False
        drift_n, stop_n = self.tare.drift_n, ctx.rig.interlocks.zero_stop_n
        text = f"zero checked after {self.after_s / 60:.0f} min of contact: {drift_n:.1f} N off, at most {stop_n:g} N"
        ctx.journal.event(ctx.now, "tare", text)
        if self.tare.failed:
            raise MoveFailedError(self.tare.failed)
        return True

    def resume(self, ctx: Context) -> None:
        """Start again after a hold."""
        self.tare = None
