"""Checks of the wheel's diameter: by rolling at a light load, or by a person's measurement.

In rolling at equal load, the press is deeper by the lost radius. Other causes of its motion are corrected or limited:
the load in the check (its mean is corrected to the nominal load by the contact's stiffness), the cell's zero (a tare
just before), runout (whole turns), and growth by heat: every check is corrected to the reference temperature with the
rig file's ``wear.growth``, so that cold diameters are compared. A wheel's first roll check is the reference of its
later checks.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isfinite, pi, sqrt
from typing import Final

from tester.analysis.wear_rate import NO_CONDITION, WearCheck
from tester.kinds.wheel_on_belt.budget import ROLL_CHECK_N, ROLL_CHECK_TURNS, roll_check_u_mm
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import NAN
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, TakeTare, Turn
from tester.kinds.wheel_on_belt.procedures.operator_access import AskAtRest
from tester.kinds.wheel_on_belt.procedures.thermal_steps import Straighten
from tester.kinds.wheel_on_belt.procedures.wheel_life import CheckReference, WheelLife, rubber_c
from tester.kinds.wheel_on_belt.recipe.measured_wheels import INSTALLED_MM
from tester.machine.motions import Power, Sequence, Settle

TARE_WAIT_S: Final = 0.4
"""Time from lifted to the first reading of the tare, s [A]: the cell's filter."""
TARE_S: Final = 1.0
LARGER_BY: Final = 3.0
"""A check is not used if the wheel measures larger than at the previous check by more than this many standard
uncertainties [A]."""
CLEAR_BY: Final = 4.0
"""A loss of this many standard uncertainties gives a usable wear rate, to 25 % [A]."""
QUESTION: Final = "measure the wheel's diameter and answer with it, such as 89.62 mm (yes: not measured)"


class RollCheck:
    """Measure the loss of diameter by rolling, corrected for load and temperature; ``before``: the next condition.

    Done when the check is in the record and has corrected the wheel's estimated loss.
    """

    def __init__(self, before: int = NO_CONDITION) -> None:
        """Begin without readings."""
        self.before = before
        self.hold = Load(ROLL_CHECK_N, for_s=1.0)
        self.held = False
        self.angle_rev = float("nan")
        self.sums = [0.0, 0.0, 0.0]
        self.count = 0

    def step(self, ctx: Context) -> bool:
        """Average press, load and temperature over whole turns."""
        if not self.held:
            self.held = self.hold.step(ctx)
            return False
        r = ctx.readings
        ctx.moving = True
        if not isfinite(self.angle_rev):
            self.angle_rev = r.wheel_angle_rev
        for i, value in enumerate((r.press_mm, r.force_z_n, rubber_c(r.hub_c, r.surface_c))):
            self.sums[i] += value
        self.count += 1
        if r.wheel_angle_rev - self.angle_rev < ROLL_CHECK_TURNS:
            return False
        press_mm, load_n, mean_c = (total / self.count for total in self.sums)
        if isfinite(press_mm + load_n + mean_c):
            self._conclude(ctx, press_mm, load_n, mean_c)
        else:
            ctx.journal.event(ctx.now, "wear", "roll check without value: a reading was missing", "warning")
        return True

    def _conclude(self, ctx: Context, press_mm: float, load_n: float, mean_c: float) -> None:
        wear, wheel = ctx.rig.wear, ctx.wheel
        stiffness = ctx.rig.loops.load.stiffness_n_per_mm
        off_mm = depth_mm(load_n, stiffness) - depth_mm(ROLL_CHECK_N, stiffness)
        u_mm = roll_check_u_mm(ctx.rig, off_mm)
        cold_mm = press_mm - off_mm + 0.5 * wear.growth_mm(mean_c)
        reference = wheel.reference
        if reference is None:
            reference = wheel.reference = CheckReference(ctx.now, cold_mm, wheel.loss_mm)
        loss_mm = reference.loss_mm + 2.0 * (cold_mm - reference.press_mm)
        conclude(
            ctx, self.before, "roll", loss_mm, u_mm, reference_s=reference.at_s, rubber_c=mean_c, press_mm=press_mm,
            load_n=load_n,
        )  # fmt: skip


class CheckByRolling:
    """The whole check: lift, tare, roll at matched speeds under the light load, measure."""

    def __init__(self, wheel_speed_m_s: float, reference_tare: list[float], before: int = NO_CONDITION) -> None:
        """``reference_tare``: the wheel's first zero."""
        self.wheel_speed_m_s = wheel_speed_m_s
        self.reference_tare = reference_tare
        self.before = before
        self.moves: Sequence | None = None

    def resume(self, ctx: Context) -> None:
        """Start again after a hold."""
        self.moves = None

    def step(self, ctx: Context) -> bool:
        """Done when the check is in the record."""
        if self.moves is None:
            speed = self.wheel_speed_m_s
            # A zero that has drifted too far is not taken: the tare of the next repeat then ends the run.
            tare = TakeTare(TARE_S, self.reference_tare, ends_run=False)
            self.moves = Sequence(
                Power(True), Lift(), Straighten(), Turn(speed, speed), Settle(TARE_WAIT_S), tare, Load(ROLL_CHECK_N),
                RollCheck(self.before),
            )  # fmt: skip
        return self.moves.step(ctx)


class CheckByPerson:
    """Ask for the wheel's diameter; an answer with a number is a check, any other answer means no measurement."""

    def __init__(self, before: int = NO_CONDITION) -> None:
        """``before``: the next condition."""
        self.before = before
        self.ask = AskAtRest(QUESTION, unit="mm")

    def resume(self, ctx: Context) -> None:
        """Resume stopping."""
        self.ask.resume(ctx)

    def step(self, ctx: Context) -> bool:
        """Done when it is answered; after an impossible diameter the question is repeated."""
        if not self.ask.step(ctx):
            return False
        prompt = self.ask.prompt(ctx)
        found_mm, wheel = prompt.quantity, ctx.wheel
        if found_mm is None:
            ctx.journal.event(ctx.now, "wear", f'no diameter measured: "{prompt.answer}"')
            return True
        layer_mm = 2.0 * ctx.rig.observer.wheel.rubber_layer
        least_mm, most_mm = wheel.installed_mm - layer_mm, wheel.installed_mm + MORE_THAN_NEW_MM
        if not least_mm <= found_mm <= most_mm:
            text = f"{found_mm:g} mm cannot be the wheel's diameter (expected {least_mm:g} to {most_mm:g} mm)"
            ctx.journal.event(ctx.now, "wear", text, "warning")
            self.ask = AskAtRest(f"{text}: {QUESTION}", unit="mm")
            return False
        r, wear = ctx.readings, ctx.rig.wear
        mean_c = rubber_c(r.hub_c, r.surface_c)
        if not isfinite(wheel.by_hand_s):
            wheel.by_hand_s = ctx.now
        u_mm = hypot(wear.gauge_mm, wear.growth_mm_per_k * wear.check_rubber_k)
        loss_mm = wheel.installed_mm - (found_mm - wear.growth_mm(mean_c))
        differs = _compared(ctx, loss_mm, u_mm)
        if differs:
            ctx.journal.event(ctx.now, "wear", differs, "warning")
        conclude(ctx, self.before, "person", loss_mm, u_mm, reference_s=wheel.by_hand_s, rubber_c=mean_c)
        return True


def _compared(ctx: Context, loss_mm: float, u_mm: float) -> str:
    """Return in words by how much a measured diameter differs from the believed one, "" within their uncertainty."""
    wheel = ctx.wheel
    off_mm = wheel.loss_mm - loss_mm
    most_mm = 2.0 * hypot(u_mm, wheel.u_mm, INSTALLED_MM / sqrt(3.0))
    if abs(off_mm) <= most_mm:
        return ""
    found_mm = wheel.installed_mm - loss_mm
    off = f"{off_mm:+.2f} mm, more than their uncertainty of {most_mm:.2f} mm"
    return f"{found_mm:.2f} mm measured at wheel {wheel.wheel}, {wheel.cold_mm:.2f} mm believed: {off}"


MORE_THAN_NEW_MM: Final = 2.0
"""Greatest excess of a wheel over the rig file's new wheel, mm [A]: moulds differ."""


def conclude(
    ctx: Context, before: int, method: str, loss_mm: float, u_mm: float, *, reference_s: float, rubber_c: float,
    press_mm: float = NAN, load_n: float = NAN,
) -> None:  # fmt: skip
    """Record a check, and use its loss of diameter from now on if the check is trustworthy.

    ``loss_mm``, ``u_mm``: loss of diameter since ``reference_s``, and its standard uncertainty.
    """
    wheel, wear = ctx.wheel, ctx.rig.wear
    check = WearCheck(
        piece=wheel.wheel,
        method=method,
        t_s=ctx.now,
        reference_s=reference_s,
        before=before,
        after=wheel.condition,
        diameter_mm=wheel.installed_mm - loss_mm,
        u_mm=u_mm,
        rubber_c=rubber_c,
        u_growth_mm_k=wear.growth_uncertainty_mm_per_k,
        press_mm=press_mm,
        load_n=load_n,
        sliding_m=wheel.sliding_m,
        exposure_n_m=wheel.exposure_n_m,
        width_mm=wheel.width_mm,
        u_rate_percent=wear.rate_uncertainty_percent,
        used=1,
        expected_mm=wheel.cold_mm,
    )
    doubt = _doubt(ctx, check)
    text = f"loss of diameter {loss_mm:.3f} mm by {method} check (u {u_mm:.3f} mm)"
    text += f", {wheel.loss_mm:.3f} mm estimated"
    ctx.journal.wear_check(replace(check, used=int(not doubt)))
    if doubt:
        ctx.journal.event(ctx.now, "wear", f"{text}; not used: {doubt}", "warning")
        return
    ctx.journal.event(ctx.now, "wear", text)
    _learn_rate(wheel, check)
    wheel.last_check = check
    wheel.loss_mm = max(loss_mm, 0.0)
    wheel.estimate.measured(wheel.loss_mm, u_mm)
    ctx.journal.piece_state(wheel.wheel, wheel.cold_mm, wheel.sliding_m, ctx.now)


def _learn_rate(wheel: WheelLife, check: WearCheck) -> None:
    """Use the wear rate between two checks if the loss clearly exceeds their uncertainty.

    A wrong rate causes unseen slip at matched speeds, because the line speed is computed from the estimated diameter.
    """
    last = wheel.last_check
    if last is None or last.reference_s != check.reference_s or check.exposure_n_m <= last.exposure_n_m:
        return
    lost_mm = last.diameter_mm - check.diameter_mm
    u_mm = hypot(check.u_mm, last.u_mm, check.u_growth_mm_k * (check.rubber_c - last.rubber_c))
    if lost_mm > CLEAR_BY * u_mm:
        volume_mm3 = 0.25 * pi * check.width_mm * (last.diameter_mm**2 - check.diameter_mm**2)
        wheel.rate_mm3_per_n_m = volume_mm3 / (check.exposure_n_m - last.exposure_n_m)


def _doubt(ctx: Context, check: WearCheck) -> str:
    """Return why a check is not used, "" if it is."""
    wheel, last = ctx.wheel, ctx.wheel.last_check
    left_mm = check.diameter_mm - (wheel.installed_mm - 2.0 * ctx.rig.observer.wheel.rubber_layer)
    if left_mm < 0.0:
        return "more than the whole rubber layer"
    if last is None or last.reference_s != check.reference_s:
        return ""
    grown_mm = check.diameter_mm - last.diameter_mm
    u_mm = hypot(check.u_mm, last.u_mm, check.u_growth_mm_k * (check.rubber_c - last.rubber_c))
    return f"{grown_mm:.3f} mm larger than at the check before" if grown_mm > LARGER_BY * u_mm else ""
