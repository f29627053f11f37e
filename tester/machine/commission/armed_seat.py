"""A rig armed as before every run, with a commissioning's moves in place of a recipe.

Control, interlocks, limits and stops are those of a run; only the demand comes from elsewhere.
"""

from __future__ import annotations

from typing import Any

from tester.inputs.recipe.plan import Plan
from tester.machine.activity import Activity
from tester.machine.commission.commission_step import Dialogue
from tester.machine.commission.moves import MovesExecutor
from tester.machine.run import Run
from tester.machine.state import Mode


class ArmedSeat:
    """The rig during the later steps (tester.machine.commission.commission_step.Seat)."""

    def __init__(self, run: Run, plan: Plan) -> None:
        """Send nothing. ``run``: of ``plan``, which has no steps."""
        self.run = run
        self.executor = MovesExecutor(plan)
        run.engine.executor = self.executor
        self._stopped = False

    @property
    def ready(self) -> bool:
        """Whether the rig is armed and in RUN."""
        return self.run.connected and self.run.engine.control.state.mode is Mode.RUN

    @property
    def finished(self) -> bool:
        """Whether the rig is at rest and released."""
        return self.run.finished

    @property
    def reason(self) -> str:
        """Reason for an unrequested end: a refusal to arm, a trip, a failed move."""
        trip = self.run.engine.control.state.trip
        if trip is not None:
            return f"{trip.name}: {trip.text}"
        return self.executor.failed or ("" if self._stopped else self.run.reason)

    def tick(self, now: float) -> float:
        """Advance the rig by one tick."""
        return self.run.tick(now)

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Stop as a run does; a warm wheel keeps turning until it may come to rest."""
        self._stopped = True
        self.executor.activity = None
        self.run.request_stop(why, fast=fast)

    def abandon(self) -> None:
        """Send safe outputs once."""
        self.run.abandon()

    def do(self, activity: Activity[Any]) -> Dialogue:
        """Yield until an activity is done."""
        self.executor.activity = activity
        executor = self.executor
        yield lambda now_s: executor.activity is None and not executor.failed
