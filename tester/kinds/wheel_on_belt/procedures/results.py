"""What a repeat leaves on record of the wheel beside its result, and what a condition will cost of it."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.recipe.estimate import predicted_loss_mm
from tester.kinds.wheel_on_belt.recipe.steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.results import StoredResults


class WheelResults(StoredResults[Context]):
    """Results of a wheel on a belt."""

    def mounted(self, ctx: Context) -> int:
        """Return the wheel's number."""
        return ctx.wheel.wheel

    def record_mounted(self, ctx: Context) -> None:
        """Put the wheel's diameter and the distance it has slid on record."""
        wheel = ctx.wheel
        self.recorder.piece_state(wheel.wheel, wheel.cold_mm, wheel.sliding_m, ctx.now)

    def predicted_loss_mm(self, step: WheelCondition, rig: RigConfig) -> float:
        """Return the loss of diameter that a condition is expected to cost, mm."""
        return predicted_loss_mm(step, rig)
