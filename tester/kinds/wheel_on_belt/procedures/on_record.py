"""Records the wheel's state after a repeat, and predicts the wear of a condition."""

from __future__ import annotations

from tester.inputs.recipe.plan import ConditionStep
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.recipe.estimate import predicted_loss_mm
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.result_keeping import StoredResults
from tester.store.recorder import Recorder
from tester.store.records import Travel


def record_state(recorder: Recorder, ctx: Context, now_s: float) -> None:
    """Record the wheel's wear at a rig time, and the travel of belt and wheel."""
    wheel = ctx.wheel
    recorder.piece_state(wheel.wheel, wheel.cold_mm, wheel.sliding_m, now_s)
    recorder.travelled(wheel.wheel, travel_of(ctx))


def travel_of(ctx: Context) -> Travel:
    """Return how far the belt has travelled under load, and the wheel has slid."""
    return Travel(ctx.belt_travel_m, ctx.wheel.sliding_m)


class WheelResults(StoredResults[Context]):
    """Results of a wheel on a belt."""

    def begin_repeat(self, ctx: Context, step: ConditionStep, repeat: int, attempt: int) -> int:
        """Open a repeat, with how far belt and wheel have come; return the key that its samples carry."""
        key = super().begin_repeat(ctx, step, repeat, attempt)
        self.recorder.travelled(ctx.wheel.wheel, travel_of(ctx), key)
        return key

    def mounted(self, ctx: Context) -> int:
        """Return the wheel's number."""
        return ctx.wheel.wheel

    def record_mounted(self, ctx: Context) -> None:
        """Record the wheel's diameter and the distances."""
        record_state(self.recorder, ctx, ctx.now)

    def predicted_loss_mm(self, step: WheelCondition, rig: RigConfig) -> float:
        """Return the loss of diameter that a condition is expected to cost, mm."""
        return predicted_loss_mm(step, rig)
