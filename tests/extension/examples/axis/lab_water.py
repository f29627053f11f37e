"""The wheel on a belt with one axis more: a condition has a dry or a wet belt, and a person wets it."""

from tester.base.axes import Axis
from tester.inputs.recipe.plan import PromptStep, Step
from tester.kinds import wheel_on_belt
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.procedures.steps import WheelProcedures
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED
from tester.kinds.wheel_on_belt.run.runs import WheelRuns
from tester.machine.executor import Unforeseen

INTERFACE = Axis("interface", "", "interface", "", 1.0, "interface", "Interface", "Interface", "", "dry", False,
                 choices=("dry", "wet"))  # fmt: skip


class WetProcedures(WheelProcedures):
    """Ask a person before a condition with another state of the belt."""

    interface = "dry"
    """State of the belt; a run begins, and resumes, with a dry one."""

    def before(self, step: Step, ctx: Context) -> Unforeseen[Context] | None:
        """Ask for the belt first, then do what any condition needs."""
        wanted = str(step.setpoint.value("interface")) if isinstance(step, WheelCondition) else self.interface
        if wanted == self.interface:
            return super().before(step, ctx)
        self.interface = wanted
        return Unforeseen(steps=[PromptStep(INSERTED, f"the belt is to be {wanted}")])


class WetRuns(WheelRuns):
    """Runs with those procedures."""

    procedures = WetProcedures


KIND = wheel_on_belt.KIND.extended(
    "lab_water:KIND", "rubber wheel on a belt that is dry or wet", axes=[INTERFACE], runs=WetRuns
)
