"""The source of an armed rig's demand during commissioning."""

from __future__ import annotations

from typing import Any, Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.machine.activity import Activity, MoveFailedError
from tester.machine.executor import Executor, Procedures

COMMISSIONING: Final = "commissioning"
"""Name of the plan, which has no steps."""


class MovesExecutor(Executor[Any]):
    """Runs the activities that a procedure sets, one after the other; between activities the demand stays."""

    def __init__(self) -> None:
        """Begin without a demand."""
        super().__init__(WheelPlan(COMMISSIONING, (), (), 1), Procedures())
        self.watch: Activity[Context] | None = None

    def step(self, ctx: Context) -> None:
        """Advance the activity in progress."""
        if self.activity is None:
            return
        try:
            if self.activity.step(ctx):
                self.activity = None
        except MoveFailedError as failed:
            self.failed = str(failed)
            self.finished = True
