"""One condition: soak in rolling contact, then its repeats, each committed before the next begins."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite
from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.kinds.wheel_on_belt.procedures.burst_state import run_in_m, slides_reversed
from tester.kinds.wheel_on_belt.procedures.bursts import MeasureRepeat
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults, soak_check
from tester.kinds.wheel_on_belt.procedures.thermal_steps import SoakTo, roll, soak_within_k
from tester.kinds.wheel_on_belt.procedures.wear_check import CheckByRolling
from tester.kinds.wheel_on_belt.procedures.wheel_life import SURE_U
from tester.kinds.wheel_on_belt.procedures.zero_check import ZeroCheck, is_due
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.machine.condition import MeasureCondition
from tester.machine.measured import ConditionEnd, Ending
from tester.machine.motions import Sequence

REPEAT_MARGIN: Final = 1.5
"""A repeat may wear off this times what the last repeat did [A]: it may take more pulses."""


class MeasureWheelCondition(MeasureCondition[Context, WheelCondition, MeasureRepeat]):
    """The activity of one condition."""

    def __init__(
        self, step: WheelCondition, results: WheelResults, reference_tare: list[float], most_mm: float = inf
    ) -> None:
        """``reference_tare``: the wheel's first zero; ``most_mm``: the loss of diameter that the wheel may reach."""
        super().__init__(step, results)
        self.repeat = self.done_before = max(self.done_before, results.repeats_kept(step))
        self.most_mm = most_mm
        self.worn_out = False
        """Another repeat would wear the wheel beyond that: the condition continues on a new wheel."""
        self.begun_n_m = self.rubbed_n_m = 0.0
        """Load times distance when the last repeat began, and in it; the latter is 0 once it has been looked at."""
        self.reference_tare = reference_tare
        self.before: Sequence | None = None
        self.soak: SoakTo | None = None
        self.soaked = False
        self.offset_k = float("nan")

    def resume(self, ctx: Context) -> None:
        """Soak again after a hold; an interrupted repeat restarts at its tare."""
        super().resume(ctx)
        if self.outcome is None:
            self.before = self.soak = None
            self.soaked = False

    def ready(self, ctx: Context) -> bool:
        """Return whether the rubber is soaked; end the condition if it does not reach its temperature."""
        if self.soaked:
            return True
        step, sp = self.condition, held_by(self.condition.setpoint)
        if self.before is None or self.soak is None:
            pulsed = abs(sp.slip_velocity_m_s) > 1e-9 or sp.yawed
            if not isfinite(self.offset_k):
                self.offset_k = ctx.rig.loops.heat.rolling_offset_k
            target = sp.temperature_c - (self.offset_k if pulsed else 0.0)
            within = soak_within_k(step.soak, sp.temperature_c, ctx.rig.ambient_c, step.temperature_band_k)
            self.soak = SoakTo(target, within, step.soak.for_s, step.soak.at_most_s)
            checked = (ZeroCheck(sp.wheel_speed_m_s, self.reference_tare),) if is_due(ctx) else ()
            # After a hold the condition has already had its check.
            self.before = Sequence(*checked, roll(sp.wheel_speed_m_s, sp.load_n))
            if step.wear_check == "each_condition" and self.repeat == self.done_before and not self.voided:
                check = CheckByRolling(sp.wheel_speed_m_s, self.reference_tare, step.condition)
                self.before = Sequence(check, roll(sp.wheel_speed_m_s, sp.load_n))
        ctx.demand.surface_c = self.soak.target_c
        ctx.demand.freeze_heat = False
        if self.before.parts:
            self.before.step(ctx)
        elif self.soak.step(ctx):
            self.soaked = True
            if self.soak.reached:
                self._check_soak(ctx)
            else:
                text = f"surface at {ctx.gates.surface.slow_c:.1f} degC after {step.soak.at_most_s / 60:g} min of soak"
                self.end = ConditionEnd(Ending.NOT_REACHED, text)
        return False

    def _check_soak(self, ctx: Context) -> None:
        """Record whether thermometer and hub agree, and report a disagreement."""
        check = soak_check(ctx, self.condition.condition)
        if check is None:
            return
        ctx.journal.soaked(check)
        if not check.agrees:
            text = (
                f"thermometer at {check.surface_c:.1f} degC; by the hub's sensor, {check.hub_c:.1f} degC, the surface"
                f" is at {check.model_c:.1f} degC; {check.allowed_k:.1f} K are allowed"
            )
            ctx.journal.event(ctx.now, "soak", text, "warning")

    def begin(self, ctx: Context, attempt: int) -> MeasureRepeat:
        """Return the repeat; it takes the start offset that the previous repeat learned."""
        step, repeat = self.condition, self.repeat
        self.begun_n_m = ctx.wheel.exposure_n_m
        ctx.attendant.begin_repeat(step.row, repeat, attempt, step.setpoint.numbers())
        return MeasureRepeat(
            step, self.reference_tare, self.offset_k, ctx.quantities,
            reversed_slip=slides_reversed(step, repeat), run_in_m=run_in_m(step, repeat),
        )  # fmt: skip

    def step(self, ctx: Context) -> bool:
        """Advance by one scan; return True when the condition is committed, or a repeat has worn the wheel out."""
        if self.measuring is None and self.rubbed_n_m > 0.0:
            wheel = ctx.wheel
            next_mm = REPEAT_MARGIN * wheel.loss_of(self.rubbed_n_m, ctx.rig.wear.rate_mm3_per_n_m)
            self.worn_out = wheel.loss_mm + next_mm + SURE_U * wheel.u_mm > self.most_mm
            self.rubbed_n_m = 0.0
        return self.worn_out or super().step(ctx)

    def finish(self, ctx: Context, measured: MeasureRepeat) -> None:
        """Reduce and commit a repeat; keep its start offset, and what it has worn off."""
        self.offset_k = measured.offset_k
        self.rubbed_n_m = ctx.wheel.exposure_n_m - self.begun_n_m
        if self.repeat == self.done_before + 1 and self.condition.wear_check == "never":
            touched = ctx.wheel.touched
            if touched is not None:
                ctx.journal.wear_check(replace(touched, before=self.condition.condition))
        super().finish(ctx, measured)
