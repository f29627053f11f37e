"""A condition's record beside its samples: the wheel's state after a repeat, the check after a soak.

In rolling without slip, heat loss to the air makes the surface colder than the hub. The thermal observer computes this
difference from the hub's sensor alone (``control.observer``), so the check compares thermometer and hub. They may
differ by the sum of three assumed errors: the thermometer's bias as in the budget, the hub sensor's bias, and the
observer's error, a share of the drop from hub to surface.
"""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.analysis.flags import SLIP_UNSURE
from tester.analysis.results import SoakCheck
from tester.inputs.recipe.plan import ConditionStep
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.kinds.wheel_on_belt.recipe.estimate import predicted_loss_mm
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.result_keeping import StoredResults
from tester.store.recorder import Recorder
from tester.store.records import Travel


def record_state(recorder: Recorder, ctx: Context, now_s: float) -> None:
    """Record the wheel's wear, and the travel of belt and wheel, at a rig time."""
    wheel = ctx.wheel
    recorder.piece_state(wheel.wheel, wheel.cold_mm, wheel.sliding_m, now_s)
    recorder.travelled(wheel.wheel, travel_of(ctx))


def travel_of(ctx: Context) -> Travel:
    """Return the travel of the belt that is on, under load, and the wheel's sliding distance."""
    return Travel(ctx.belts.travel_m, ctx.wheel.sliding_m)


class WheelResults(StoredResults[Context]):
    """Results of a wheel on a belt."""

    def begin_repeat(self, ctx: Context, step: ConditionStep, repeat: int, attempt: int) -> int:
        """Open a repeat with the distances of belt and wheel; return the key of its samples."""
        key = super().begin_repeat(ctx, step, repeat, attempt)
        self.recorder.travelled(ctx.wheel.wheel, travel_of(ctx), key)
        return key

    def mounted(self, ctx: Context) -> int:
        """Return the wheel's number."""
        return ctx.wheel.wheel

    def record_mounted(self, ctx: Context) -> None:
        """Record the wheel's diameter and the distances."""
        record_state(self.recorder, ctx, ctx.now)

    def repeats_kept(self, step: WheelCondition) -> int:
        """Return how many repeats of the present condition are committed: it may continue on a new wheel."""
        return len(self.repeats) if self.condition == step.condition else 0

    def doubts(self, ctx: Context, step: ConditionStep) -> tuple[str, ...]:
        """Return a flag where the wheel's diameter leaves the slip more uncertain than is allowed."""
        held, wheel = held_by(step.setpoint), ctx.wheel
        off_m_s = held.wheel_speed_m_s * wheel.u_mm / wheel.cold_mm
        return (SLIP_UNSURE,) if off_m_s > max(SLIP_SHARE * abs(held.slip_velocity_m_s), SLIP_M_S) else ()

    def predicted_loss_mm(self, step: WheelCondition, rig: RigConfig) -> float:
        """Return the expected loss of diameter in a condition, mm."""
        return predicted_loss_mm(step, rig)


SLIP_M_S: Final = 0.003
SLIP_SHARE: Final = 0.02
"""A slip velocity may be off by the greater of both, m/s and a share; else its repeats are flagged [A]."""
THERMOMETER_K: Final = next(term.bound for term in TERMS if term.name == "thermometer")
"""Greatest bias of the thermometer, K."""
HUB_K: Final = 0.5
"""Greatest error of the hub's sensor, K [A]: Pt100 class B at 60 degC is 0.6 K; other checks cover the line through the
slip ring."""
MODEL_SHARE: Final = 0.15
"""Tolerance of the observer's drop from hub to surface, a share [A]: a fifth more air film changes it by 12 %."""


def allowed_k(hub_c: float, model_c: float) -> float:
    """Return the allowed difference of thermometer and model, K, at these hub and model temperatures, degC."""
    return THERMOMETER_K + HUB_K + MODEL_SHARE * abs(hub_c - model_c)


def soak_check(ctx: Context, condition: int) -> SoakCheck | None:
    """Return the readings of thermometer and model at the end of a soak; None if either is unknown."""
    r, observer = ctx.readings, ctx.observer
    if not r.jacket_valid or not isfinite(observer.surface_c):
        return None
    surface_c, model_c = ctx.gates.surface.slow_c, observer.surface_c
    if not isfinite(surface_c):
        return None
    return SoakCheck(condition, ctx.now, surface_c, model_c, r.hub_c, allowed_k(r.hub_c, model_c))
