"""Walk the plan: one activity after the other, each a small state object stepped once a scan."""

from __future__ import annotations

from collections import deque
from typing import Final

from tester.analysis.wear_check import NO_CONDITION
from tester.axes import condition_words
from tester.engine.activity import Activity, MoveFailedError, Resumable
from tester.engine.attended import AskAtRest
from tester.engine.condition import MeasureCondition, Results
from tester.engine.context import Context
from tester.engine.thermal_steps import CoolDown, HeatUp, RestStep
from tester.engine.wear_check import CheckByPerson, CheckByRolling
from tester.engine.wheel_steps import InstallWheel, PreGrindStep, ShowContact
from tester.process import Press
from tester.recipe.plan import (
    ConditionStep,
    Cool,
    Heat,
    Install,
    Plan,
    PreGrind,
    Prompt,
    Rest,
    Step,
)
from tester.recipe.wheel_change import INSERTED, wheel_change

DEFAULT_SPEED_M_S: Final = 0.8
"""Wheel speed for heating when no condition follows (the paper's)."""
DEFAULT_LOAD_N: Final = 200.0
WEAR_CHECK: Final = "check the wheel's diameter and wear"


class Executor:
    """The steps still to do, the one in progress, and what is finished."""

    def __init__(self, plan: Plan, results: Results, *, hardware: bool) -> None:
        """``hardware``: people are asked where a simulated rig just goes on."""
        self.plan = plan
        self.results = results
        self.hardware = hardware
        self.steps: deque[Step] = deque(plan.steps)
        self.activity: Activity | None = None
        self.finished = False
        self.failed = ""
        self.reference_tare: list[float] = []
        self.conditions = sum(1 for _ in plan.conditions())
        self.wheels = max((step.wheel for step in plan.steps if isinstance(step, Install)), default=0)
        """Highest wheel number in use: one that the plan did not foresee gets the next."""
        self.unchecked: ConditionStep | None = None
        """A condition whose wear nothing has measured yet, though its recipe asks for it."""
        self.checked = 0
        """The last condition before which a person has looked at the wheel."""
        self.measured_wheel = 0
        """The wheel of the last condition. A new one measures at least one condition, else changing never ends."""

    def hold(self, ctx: Context) -> None:
        """Note that the rig is held: what is recorded meanwhile belongs to no repeat."""
        ctx.burst = ctx.repeat_key = 0

    def resume(self, ctx: Context) -> None:
        """Go on after a hold, lifted and without slip: a repeat that was cut off is void and done again."""
        demand = ctx.demand
        demand.press, demand.load_n, demand.freeze_heat = Press.LIFT, 0.0, False
        demand.belt_speed_m_s = demand.wheel_speed_m_s
        if isinstance(self.activity, Resumable):
            self.activity.resume(ctx)

    def step(self, ctx: Context) -> None:
        """Advance the run by one scan."""
        while not self.finished:
            if self.activity is None:
                if not self.steps:
                    self.finished = True
                    return
                self.activity = self._begin(self.steps.popleft(), ctx)
            try:
                if not self.activity.step(ctx):
                    return
            except MoveFailedError as failed:
                self.failed = f"{ctx.progress.title}: {failed}"
                self.finished = True
                return
            ended, self.activity = self.activity, None
            self._end(ended, ctx)
            if self.failed:
                self.finished = True

    def _begin(self, step: Step, ctx: Context) -> Activity:
        if isinstance(step, ConditionStep) and self._wheel_too_worn(step, ctx) and self.unchecked is not None:
            self.steps.appendleft(step)
            return self._last_check(self.unchecked, ctx)
        if isinstance(step, ConditionStep) and (before := self._steps_before(step, ctx)):
            self.steps.appendleft(step)
            self.steps.extendleft(reversed(before))
            step = self.steps.popleft()
        self._announced(title(step), ctx)
        return self._activity(step, ctx)

    def _announced(self, text: str, ctx: Context) -> None:
        """Tell what is done next."""
        ctx.progress.step += 1
        ctx.progress.steps = ctx.progress.step + len(self.steps)
        ctx.progress.conditions = self.conditions
        ctx.progress.repeat = ctx.progress.repeats = 0
        ctx.progress.title, ctx.progress.phase = text, ""
        ctx.journal.event(ctx.now, "step", ctx.progress.title)
        ctx.journal.flush()

    def _activity(self, step: Step, ctx: Context) -> Activity:
        match step:
            case Install():
                return InstallWheel(step, self.reference_tare)
            case PreGrind():
                return PreGrindStep(step, self.reference_tare)
            case Rest():
                return RestStep(step, ask_when_late=self.hardware)
            case Heat():
                return self._heat(step, ctx)
            case ConditionStep():
                self.measured_wheel = ctx.wheel.wheel
                return MeasureCondition(step, self.results, self.reference_tare)
            case Cool():
                return CoolDown(step, ctx.rig.interlocks.cooldown_speed_m_s)
            case Prompt() if step.text == WEAR_CHECK:
                follower = self.steps[0] if self.steps else None
                return CheckByPerson(follower.condition if isinstance(follower, ConditionStep) else NO_CONDITION)
            case Prompt():
                return AskAtRest(step.text)

    def _heat(self, step: Heat, ctx: Context) -> HeatUp:
        """Heat under the load and at the speed of the condition that follows: it soaks there next."""
        loop = ctx.rig.loops.heat
        for follower in self.steps:
            if isinstance(follower, ConditionStep):
                sp = follower.setpoint
                return HeatUp(step, sp.wheel_speed_m_s, sp.load_n, follower.soak.within_k, loop.rolling_offset_k)
        return HeatUp(step, DEFAULT_SPEED_M_S, DEFAULT_LOAD_N, 1.0, loop.rolling_offset_k)

    def _end(self, activity: Activity, ctx: Context) -> None:
        if isinstance(activity, CheckByRolling | CheckByPerson):
            self.unchecked = None
        if isinstance(activity, MeasureCondition | InstallWheel | ShowContact):
            self.failed = activity.failed
        if isinstance(activity, InstallWheel) and not self.failed:
            self._mounted(activity, ctx)
        if isinstance(activity, MeasureCondition):
            self._measured(activity.condition, ctx)
        elif isinstance(activity, AskAtRest | CheckByPerson) and self.steps:
            follower = self.steps[0]
            if self.reference_tare and not isinstance(follower, Install | Prompt):
                # The wheel may have been off, the belt another one: before anything else the contact is shown again.
                self.activity = ShowContact(self.reference_tare)
            if isinstance(follower, ConditionStep):
                # A person has been at the wheel, and it has cooled: nothing is measured before it is warm again.
                self.steps.appendleft(Heat(INSERTED, follower.setpoint.temperature_c))

    # -- checks of the wheel -----------------------------------------------------------------------------------

    def _mounted(self, activity: InstallWheel, ctx: Context) -> None:
        """Check a new wheel as it is mounted, before it is ground in: then its diameter is known."""
        first = next((one for one in self.steps if isinstance(one, ConditionStep | Install)), None)
        new = activity.install.worn is None
        if new and isinstance(first, ConditionStep) and first.wear_check == "each_condition":
            self._announced(WEAR_CHECK, ctx)
            self.activity = CheckByRolling(first.setpoint.wheel_speed_m_s, self.reference_tare)

    def _measured(self, step: ConditionStep, ctx: Context) -> None:
        """Note that a condition is over; check the wheel where no check of the next condition will."""
        ctx.wheel.condition = step.condition
        self.unchecked = step if step.wear_check != "never" else None
        follower = next((one for one in self.steps if isinstance(one, ConditionStep | Install)), None)
        checked_next = isinstance(follower, ConditionStep) and follower.wear_check == step.wear_check
        if self.unchecked is None or self.failed or checked_next:
            return
        if step.wear_check == "prompt":
            self.steps.appendleft(Prompt(INSERTED, WEAR_CHECK))
        else:
            self.activity = self._last_check(step, ctx)

    def _last_check(self, step: ConditionStep, ctx: Context) -> Activity:
        """Return the check after a wheel's last condition."""
        self.unchecked = None
        self._announced(WEAR_CHECK, ctx)
        if step.wear_check == "prompt":
            return CheckByPerson()
        return CheckByRolling(step.setpoint.wheel_speed_m_s, self.reference_tare)

    # -- what the plan did not foresee ------------------------------------------------------------------------

    def _steps_before(self, step: ConditionStep, ctx: Context) -> list[Step]:
        """Return what has to be done before a condition can begin: a wheel changed, a look at it."""
        if self._wheel_too_worn(step, ctx):
            return self._change_steps(step)
        if step.wear_check != "prompt" or step.condition == self.checked or self.results.over(step) is not None:
            return []
        self.checked = step.condition
        return [Prompt(INSERTED, WEAR_CHECK)]

    def _wheel_too_worn(self, step: ConditionStep, ctx: Context) -> bool:
        """Tell whether what is left of the wheel does not cover this condition's predicted wear."""
        left_mm = self.plan.replace_after_mm - ctx.wheel.loss_mm
        return ctx.wheel.wheel == self.measured_wheel and self.results.predicted_loss_mm(step, ctx.rig) > left_mm

    def _change_steps(self, step: ConditionStep) -> list[Step]:
        self.wheels += 1
        specimen = self.plan.specimen(step.specimen)
        return list(wheel_change(self.plan, step, specimen, self.wheels))


def title(step: Step) -> str:
    """Return a line that says what a step does."""
    match step:
        case Install():
            return f"install wheel {step.wheel} ({step.compound})"
        case PreGrind():
            return f"pre-grind {step.duration_s / 60:g} min at {step.load_n:g} N"
        case Rest():
            return f"rest {step.at_least_s / 60:g} min"
        case Heat():
            return f"heat to {step.temperature_c:g} degC"
        case ConditionStep():
            return condition_words(step.setpoint)
        case Cool():
            return f"cool the hub to {step.hub_below_c:g} degC"
        case Prompt():
            return step.text
