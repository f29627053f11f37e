"""The activities for the steps of a plan, and for unforeseen work: a worn wheel, a person at the wheel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from tester.analysis.wear_rate import NO_CONDITION
from tester.inputs.recipe.plan import Plan, PromptStep, Step
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.procedures.condition import MeasureWheelCondition
from tester.kinds.wheel_on_belt.procedures.on_record import WheelResults
from tester.kinds.wheel_on_belt.procedures.operator_access import AskAtRest
from tester.kinds.wheel_on_belt.procedures.thermal_steps import CoolDown, HeatUp, RestStep
from tester.kinds.wheel_on_belt.procedures.wear_check import CheckByPerson, CheckByRolling
from tester.kinds.wheel_on_belt.procedures.wear_estimate import DISAGREEMENTS
from tester.kinds.wheel_on_belt.procedures.wheel_life import SURE_U
from tester.kinds.wheel_on_belt.procedures.wheel_steps import InstallWheel, PreGrindStep, PutBeltOn, ShowContact
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    ChangeBelt,
    Cool,
    Heat,
    Install,
    PreGrind,
    Rest,
    ToolPrompt,
    WheelCondition,
    WheelPlan,
)
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED, wheel_change
from tester.machine.activity import Activity
from tester.machine.executor import Procedures, Unforeseen

DEFAULT_SPEED_M_S: Final = 0.8
"""Wheel speed for heating when no condition follows (the paper's)."""
DEFAULT_LOAD_N: Final = 200.0
WEAR_CHECK: Final = "check the wheel's diameter and wear"


class WheelProcedures(Procedures[Context]):
    """The steps of this machine, and the state of wheels between steps."""

    def __init__(self, plan: Plan, results: WheelResults, *, hardware: bool) -> None:
        """``hardware``: ask a person where a simulated rig continues by itself."""
        self.plan = WheelPlan.of(plan)
        self.results = results
        self.hardware = hardware
        self.reference_tare: list[float] = []
        """The present wheel's first zero."""
        self.wheels = max((step.wheel for step in plan.steps if isinstance(step, Install)), default=0)
        """Highest wheel number in use: an unplanned wheel gets the next number."""
        self.unchecked: WheelCondition | None = None
        """A condition with a wear check still to be made."""
        self.checked = 0
        """The last condition with a person's look at the wheel before it."""
        self.measured_wheel = 0
        """The wheel of the last condition. A new wheel measures at least one condition, so that changing ends."""

    def number_after(self, last: int) -> None:
        """Give unplanned wheels numbers above ``last``."""
        self.wheels = max(self.wheels, last)

    def resumed(self, ctx: Context) -> None:
        """Resume lifted and without slip, at the wheel's speed."""
        demand = ctx.demand
        demand.press, demand.load_n, demand.freeze_heat = Press.LIFT, 0.0, False
        demand.belt_speed_m_s = demand.wheel_speed_m_s

    def activity(self, step: Step, to_come: Sequence[Step], ctx: Context) -> Activity[Context]:
        """Return the activity for a step."""
        match step:
            case Install():
                return InstallWheel(step, self.reference_tare)
            case ChangeBelt():
                return PutBeltOn(step)
            case PreGrind():
                return PreGrindStep(step, self.reference_tare)
            case Rest():
                return RestStep(step, ask_when_late=self.hardware)
            case Heat():
                return _heat(step, to_come, ctx)
            case WheelCondition():
                self.measured_wheel = ctx.wheel.wheel
                most_mm = ctx.most_loss_mm(step.setpoint.number("load"))
                return MeasureWheelCondition(step, self.results, self.reference_tare, most_mm)
            case Cool():
                return CoolDown(step, ctx.rig.interlocks.cooldown_speed_m_s)
            case PromptStep() if step.text == WEAR_CHECK:
                follower = to_come[0] if to_come else None
                return CheckByPerson(follower.condition if isinstance(follower, WheelCondition) else NO_CONDITION)
            case ToolPrompt():
                return AskAtRest(step.text, ctx.rig.limits.tool_hub_c)
            case PromptStep():
                return AskAtRest(step.text)
            case _:
                raise TypeError(f"{step.kind}: no step of this machine")

    def before(self, step: Step, ctx: Context) -> Unforeseen[Context] | None:
        """Return the work before a condition: a wheel change, or a person's look at the wheel."""
        if not isinstance(step, WheelCondition):
            return None
        if self._wheel_too_worn(step, ctx):
            if self.unchecked is not None:
                return Unforeseen(self._last_check(self.unchecked), WEAR_CHECK)
            return self._change(step, ctx)
        if step.wear_check != "prompt" or step.condition == self.checked or self.results.over(step) is not None:
            return None
        self.checked = step.condition
        return Unforeseen(steps=[PromptStep(INSERTED, WEAR_CHECK)])

    def after(self, activity: Activity[Context], to_come: Sequence[Step], ctx: Context) -> Unforeseen[Context] | None:
        """Return the work after a step: a check of the wheel, a proof of contact, or warming the wheel again."""
        if isinstance(activity, CheckByRolling | CheckByPerson):
            self.unchecked = None
        if isinstance(activity, MeasureWheelCondition | InstallWheel | ShowContact) and activity.failed:
            if isinstance(activity, MeasureWheelCondition):
                self._note_measured(activity.condition, ctx)
            return Unforeseen(failed=activity.failed)
        if isinstance(activity, InstallWheel):
            return self._mounted(activity, to_come)
        if isinstance(activity, MeasureWheelCondition):
            if activity.worn_out:
                return self._change(activity.condition, ctx, [activity.condition])
            return self._measured(activity.condition, to_come, ctx)
        if isinstance(activity, AskAtRest | CheckByPerson) and to_come:
            return self._attended(to_come[0])
        return None

    def _attended(self, follower: Step) -> Unforeseen[Context]:
        """Return the steps after a person was at the wheel."""
        # The wheel may have been off, or the belt changed: the contact is proved again first.
        shown = self.reference_tare and not isinstance(follower, Install | PromptStep | ChangeBelt)
        # The wheel has cooled meanwhile: it is warmed before any measurement.
        surface = follower.setpoint.number("temperature") if isinstance(follower, WheelCondition) else None
        warmed = [Heat(INSERTED, surface)] if surface is not None else []
        return Unforeseen(ShowContact(self.reference_tare) if shown else None, steps=warmed)

    # -- checks of the wheel -----------------------------------------------------------------------------------

    def _mounted(self, activity: InstallWheel, to_come: Sequence[Step]) -> Unforeseen[Context] | None:
        """Check a newly mounted wheel before it is ground in, while its diameter is known."""
        first = next((step for step in to_come if isinstance(step, WheelCondition | Install)), None)
        new = activity.install.worn is None
        if new and isinstance(first, WheelCondition) and first.wear_check == "each_condition":
            return Unforeseen(CheckByRolling(first.setpoint.number("wheel_speed"), self.reference_tare), WEAR_CHECK)
        return None

    def _measured(self, step: WheelCondition, to_come: Sequence[Step], ctx: Context) -> Unforeseen[Context] | None:
        """Record that a condition is over; check the wheel if the next condition will not."""
        self._note_measured(step, ctx)
        follower = next((later for later in to_come if isinstance(later, WheelCondition | Install)), None)
        checked_next = isinstance(follower, WheelCondition) and follower.wear_check == step.wear_check
        if self.unchecked is None or checked_next:
            return None
        if step.wear_check == "prompt":
            return Unforeseen(steps=[PromptStep(INSERTED, WEAR_CHECK)])
        return Unforeseen(self._last_check(step), WEAR_CHECK)

    def _note_measured(self, step: WheelCondition, ctx: Context) -> None:
        ctx.wheel.condition = step.condition
        self.unchecked = step if step.wear_check != "never" else None

    def _last_check(self, step: WheelCondition) -> Activity[Context]:
        """Return the check after a wheel's last condition."""
        self.unchecked = None
        if step.wear_check == "prompt":
            return CheckByPerson()
        return CheckByRolling(step.setpoint.number("wheel_speed"), self.reference_tare)

    # -- a wheel that the plan did not foresee ----------------------------------------------------------------

    def _wheel_too_worn(self, step: WheelCondition, ctx: Context) -> bool:
        """Return whether this condition's predicted wear, at the learnt rate, exceeds the wheel's remaining rubber."""
        wheel, believed = ctx.wheel, ctx.rig.wear.rate_mm3_per_n_m
        if wheel.wheel != self.measured_wheel:
            return False
        if wheel.estimate.disagreed >= DISAGREEMENTS:
            return True
        predicted_mm = self.results.predicted_loss_mm(step, ctx.rig)
        if believed > 0.0:
            predicted_mm *= (wheel.rate_mm3_per_n_m or believed) / believed
        most_mm = ctx.most_loss_mm(step.setpoint.number("load")) - SURE_U * wheel.u_mm
        return predicted_mm > min(self.plan.replace_after_mm, most_mm) - wheel.loss_mm

    def _change(self, step: WheelCondition, ctx: Context, more: Sequence[Step] = ()) -> Unforeseen[Context]:
        """Return the steps of a wheel change before a condition; ``more``: steps after it. Report why."""
        wheel = ctx.wheel
        why = f"{wheel.loss_mm:.2f} mm of diameter are worn off, {wheel.cold_mm:.2f} mm are left"
        if wheel.estimate.disagreed >= DISAGREEMENTS:
            why = f"its touches and the learnt wear disagree, last by {wheel.estimate.off_mm:+.2f} mm of diameter"
        ctx.journal.event(ctx.now, "wear", f"a new wheel instead of wheel {wheel.wheel}: {why}")
        self.wheels += 1
        specimen = self.plan.specimen(step.specimen)
        return Unforeseen(steps=[*wheel_change(self.plan, step, specimen, self.wheels), *more])


def _heat(step: Heat, to_come: Sequence[Step], ctx: Context) -> HeatUp:
    """Heat at the load and speed of the next condition, which soaks at them."""
    loop = ctx.rig.loops.heat
    for follower in to_come:
        if isinstance(follower, WheelCondition):
            sp = follower.setpoint
            speed_m_s, load_n = sp.number("wheel_speed"), sp.number("load")
            return HeatUp(step, speed_m_s, load_n, follower.soak.within_k, loop.rolling_offset_k)
    return HeatUp(step, DEFAULT_SPEED_M_S, DEFAULT_LOAD_N, 1.0, loop.rolling_offset_k)
