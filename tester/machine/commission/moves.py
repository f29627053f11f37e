"""The source of an armed rig's demand during commissioning."""

from __future__ import annotations

from typing import Any, Final

from tester.inputs.recipe.plan import Plan
from tester.machine.activity import MoveFailedError
from tester.machine.executor import Executor, Procedures

COMMISSIONING: Final = "commissioning"
"""Name of the plan, which has no steps."""


class MovesExecutor(Executor[Any]):
    """Runs the activities that a procedure sets, one after the other; between activities the demand stays."""

    def __init__(self, plan: Plan) -> None:
        """Begin without a demand; ``plan``: without steps."""
        super().__init__(plan, Procedures())

    def step(self, ctx: Any) -> None:
        """Advance the activity in progress."""
        if self.activity is None:
            return
        try:
            if self.activity.step(ctx):
                self.activity = None
        except MoveFailedError as failed:
            self.failed = str(failed)
            self.finished = True
