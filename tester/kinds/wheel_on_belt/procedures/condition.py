"""One condition: soak in rolling contact, then its repeats, each committed before the next begins."""

from __future__ import annotations

from math import isfinite
from typing import Protocol

from tester.analysis.stability import REPEAT_WINDOWS
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.kinds.wheel_on_belt.procedures.bursts import MeasureRepeat
from tester.kinds.wheel_on_belt.procedures.run_in import run_in_m, slides_reversed
from tester.kinds.wheel_on_belt.procedures.soak_check import soak_check
from tester.kinds.wheel_on_belt.procedures.thermal_steps import SoakTo, roll, soak_within_k
from tester.kinds.wheel_on_belt.procedures.wear_check import CheckByRolling
from tester.kinds.wheel_on_belt.procedures.zero_check import ZeroCheck, is_due
from tester.kinds.wheel_on_belt.recipe.steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.measured import ConditionEnd, Ending, RepeatOutcome
from tester.machine.motions import Sequence


class Results(Protocol):
    """Where repeats and conditions go: reduction and store behind one door."""

    def repeats_done(self, step: WheelCondition) -> int:
        """Return how many repeats of a condition an earlier stretch of the run committed."""
        ...

    def over(self, step: WheelCondition) -> ConditionEnd | None:
        """Return how the last of these ended the condition; None where it goes on."""
        ...

    def another(self, step: WheelCondition) -> bool:
        """Tell whether a further repeat is to be made, after those committed so far."""
        ...

    def attempt(self, step: WheelCondition, repeat: int) -> int:
        """Return the number of the next attempt at a repeat, from 1."""
        ...

    def begin_repeat(self, ctx: Context, step: WheelCondition, repeat: int, attempt: int) -> int:
        """Open a repeat; return the key that its samples carry."""
        ...

    def finish_repeat(
        self, ctx: Context, step: WheelCondition, key: int, repeat: int, measured: MeasureRepeat
    ) -> RepeatOutcome:
        """Reduce and commit a repeat."""
        ...

    def void_repeat(self, ctx: Context, key: int, reason: str) -> None:
        """Record that a repeat was cut off; a further attempt follows."""
        ...

    def finish_condition(self, ctx: Context, step: WheelCondition, end: ConditionEnd) -> str:
        """Sum a condition up from its repeats and commit it; return a line for people."""
        ...

    def predicted_loss_mm(self, step: WheelCondition, rig: RigConfig) -> float:
        """Return the loss of diameter that a condition is expected to cost, mm."""
        ...


class MeasureCondition:
    """State object of one condition."""

    def __init__(self, step: WheelCondition, results: Results, reference_tare: list[float]) -> None:
        """``reference_tare``: the wheel's first zero."""
        self.condition = step
        self.results = results
        self.reference_tare = reference_tare
        self.before: Sequence | None = None
        self.soak: SoakTo | None = None
        self.soaked = False
        self.done_before = results.repeats_done(step)
        self.repeat = self.done_before
        self.voided = 0
        """Attempts at the present repeat that a hold cut off."""
        self.key = 0
        self.measuring: MeasureRepeat | None = None
        self.outcome: RepeatOutcome | None = None
        self.offset_k = float("nan")
        self.failed = ""

    def resume(self, ctx: Context) -> None:
        """Condition again after a hold; a repeat that was cut off is void, and done again from its tare."""
        if self.outcome is not None:
            return  # measured to its end, and on its way to the disk
        if self.measuring is not None:
            self.results.void_repeat(ctx, self.key, "held by the operator")
            ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: void, held by the operator")
            self.measuring = None
            self.repeat -= 1
            self.voided += 1
        self.before = self.soak = None
        self.soaked = False

    def step(self, ctx: Context) -> bool:
        """Advance by one scan; done when the condition is committed."""
        progress = ctx.progress
        progress.condition, progress.repeat = self.condition.condition, self.repeat
        progress.repeats = max(self.condition.repeats * self.condition.scheme.repeats_each, self.repeat)
        if not self.soaked:
            return self._soak(ctx)
        if self.outcome is not None:
            return self._committed(ctx)
        if self.measuring is None:
            self._begin(ctx)
        assert self.measuring is not None
        if self.measuring.step(ctx):
            self._finish(ctx, self.measuring)
        return False

    # -- soak -----------------------------------------------------------------------------------------------

    def _soak(self, ctx: Context) -> bool:
        step, sp = self.condition, held_by(self.condition.setpoint)
        if self.before is None or self.soak is None:
            over = self.results.over(step)
            if over is not None:
                return self._close(ctx, over)
            pulsed = abs(sp.slip_velocity_m_s) > 1e-9 or sp.yawed
            if not isfinite(self.offset_k):
                self.offset_k = ctx.rig.loops.heat.rolling_offset_k
            target = sp.temperature_c - (self.offset_k if pulsed else 0.0)
            within = soak_within_k(step.soak, sp.temperature_c, ctx.ambient_c, step.temperature_band_k)
            self.soak = SoakTo(target, within, step.soak.for_s, step.soak.at_most_s)
            checked = (ZeroCheck(sp.wheel_speed_m_s, self.reference_tare),) if is_due(ctx) else ()
            # A condition that goes on after a hold has had its check.
            self.before = Sequence(*checked, roll(sp.wheel_speed_m_s, sp.load_n))
            if step.wear_check == "each_condition" and self.repeat == self.done_before and not self.voided:
                check = CheckByRolling(sp.wheel_speed_m_s, self.reference_tare, step.condition)
                self.before = Sequence(check, roll(sp.wheel_speed_m_s, sp.load_n))
        ctx.demand.surface_c = self.soak.target_c
        ctx.demand.freeze_heat = False
        if self.before.parts:
            self.before.step(ctx)
            return False
        if not self.soak.step(ctx):
            return False
        self.soaked = True
        if self.soak.reached:
            self._check_soak(ctx)
            return False
        text = f"surface at {ctx.gates.surface.slow_c:.1f} degC after {step.soak.at_most_s / 60:g} min of soak"
        return self._close(ctx, ConditionEnd(Ending.NOT_REACHED, text))

    def _check_soak(self, ctx: Context) -> None:
        """Put on record whether thermometer and hub agree, and say so where they do not."""
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

    # -- repeats --------------------------------------------------------------------------------------------

    def _begin(self, ctx: Context) -> None:
        self.repeat += 1
        attempt = self.results.attempt(self.condition, self.repeat) + self.voided
        ctx.attendant.begin_repeat(self.condition.row, self.repeat, attempt, self.condition.setpoint.numbers())
        self.key = self.results.begin_repeat(ctx, self.condition, self.repeat, attempt)
        ctx.repeat_key = self.key
        self.measuring = MeasureRepeat(
            self.condition,
            self.reference_tare,
            self.offset_k,
            ctx.quantities,
            reversed_slip=slides_reversed(self.condition, self.repeat),
            run_in_m=run_in_m(self.condition, self.repeat),
        )
        ctx.progress.revolutions_wanted = REPEAT_WINDOWS * (self.condition.window.revolutions or 0.0)

    def _finish(self, ctx: Context, measured: MeasureRepeat) -> None:
        self.offset_k = measured.offset_k
        self.outcome = self.results.finish_repeat(ctx, self.condition, self.key, self.repeat, measured)
        ctx.repeat_key = 0
        ctx.burst = 0
        ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: {self.outcome.text}")

    def _committed(self, ctx: Context) -> bool:
        """Wait, lifted, until the repeat is on disk; then go on to the next one or close the condition."""
        assert self.outcome is not None and self.measuring is not None
        if not self.outcome.ticket.done:
            return False
        measured, self.measuring, self.outcome = self.measuring, None, None
        self.voided = 0
        if measured.ending is Ending.ZERO_DRIFT:
            self.failed = measured.detail
        if measured.ending in (Ending.ZERO_DRIFT, Ending.CANNOT_HOLD, Ending.NOT_REACHED):
            end = ConditionEnd(measured.ending, measured.detail, measured.warming_k_s, measured.holdable_band_k)
            return self._close(ctx, end)
        if self.results.another(self.condition):
            return False
        return self._close(ctx, ConditionEnd())

    def _close(self, ctx: Context, end: ConditionEnd) -> bool:
        text = self.results.finish_condition(ctx, self.condition, end)
        ctx.journal.event(ctx.now, "condition", text)
        return True
