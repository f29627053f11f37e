"""Executes the plan: one activity after the other, each stepped once a scan."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Generic, Protocol, TypeVar

from tester.base.deriving import mypyc_attr
from tester.inputs.recipe.plan import Plan, Step
from tester.machine.activity import Activity, MoveFailedError, Resumable
from tester.machine.condition import MeasureCondition
from tester.machine.context import AnyContext

ContextT = TypeVar("ContextT", bound=AnyContext)


class Hands(Protocol):
    """An attendant that works beside the scan: at a simulated machine in another process."""

    failed: str
    """Why something was not done; "" if all was."""

    def busy(self, now: float) -> bool:
        """Return whether something asked for is not done yet at ``now``, s."""
        ...


class Unforeseen(Generic[ContextT]):
    """Work that the plan does not contain: an activity, steps inserted before the remaining ones, or the end of the
    run.
    """

    def __init__(
        self,
        activity: Activity[ContextT] | None = None,
        title: str = "",
        steps: Sequence[Step] = (),
        failed: str = "",
    ) -> None:
        """``title``: of the activity; "" if it belongs to the previous step. ``failed``: why the run ends here."""
        self.activity = activity
        self.title = title
        self.steps = tuple(steps)
        self.failed = failed


@mypyc_attr(allow_interpreted_subclasses=True)
class Procedures(Generic[ContextT]):
    """Selects the activity for each step; a kind of machine implements it."""

    def activity(self, step: Step, to_come: Sequence[Step], ctx: ContextT) -> Activity[ContextT]:
        """Return the activity for a step; ``to_come``: the steps after it."""
        raise NotImplementedError

    def before(self, step: Step, ctx: ContextT) -> Unforeseen[ContextT] | None:
        """Return unplanned work needed before a step; None if it may begin. Called again after that work."""
        return None

    def after(
        self, activity: Activity[ContextT], to_come: Sequence[Step], ctx: ContextT
    ) -> Unforeseen[ContextT] | None:
        """Return unplanned work that follows an activity; None if the plan continues.

        A condition whose load cell has no trustworthy zero ends the run.
        """
        if isinstance(activity, MeasureCondition) and activity.failed:
            return Unforeseen(failed=activity.failed)
        return None

    def number_after(self, last: int) -> None:
        """Number unplanned steps from ``last`` + 1: the plan may be part of a larger one."""

    def resumed(self, ctx: ContextT) -> None:
        """Set the demand with which a step may resume after a hold; called before the present activity resumes."""


class Executor(Generic[ContextT]):
    """The remaining steps, the present activity, and whether the run is finished."""

    def __init__(self, plan: Plan, procedures: Procedures[ContextT]) -> None:
        """Begin before the first step of the plan."""
        self.plan = plan
        self.procedures = procedures
        self.steps: deque[Step] = deque(plan.steps)
        self.activity: Activity[ContextT] | None = None
        self.finished = False
        self.failed = ""
        self.hands: Hands | None = None
        """While it is busy, no activity advances."""

    @property
    def measuring(self) -> bool:
        """Whether repeats of a condition are under way, whose pace predicts the time left."""
        activity = self.activity
        return isinstance(activity, MeasureCondition) and activity.in_repeat

    def hold(self, ctx: ContextT) -> None:
        """Record that the rig is held: samples taken during the hold belong to no repeat."""
        ctx.burst = ctx.repeat_key = 0

    def resume(self, ctx: ContextT) -> None:
        """Resume after a hold: an interrupted repeat is void and is measured again."""
        self.procedures.resumed(ctx)
        if isinstance(self.activity, Resumable):
            self.activity.resume(ctx)

    def step(self, ctx: ContextT) -> None:
        """Advance the run by one scan."""
        while not self.finished:
            hands = self.hands
            if hands is not None:
                if hands.busy(ctx.now):
                    return
                if hands.failed:
                    self.failed, self.finished = f"{ctx.progress.title}: {hands.failed}", True
                    return
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

    def _begin(self, step: Step, ctx: ContextT) -> Activity[ContextT]:
        extra = self.procedures.before(step, ctx)
        if extra is None:
            self._announce(step.title, ctx)
            return self.procedures.activity(step, self.steps, ctx)
        self.steps.appendleft(step)
        self.steps.extendleft(reversed(extra.steps))
        if extra.activity is None:
            return self._begin(self.steps.popleft(), ctx)
        self._announce(extra.title, ctx)
        return extra.activity

    def _end(self, activity: Activity[ContextT], ctx: ContextT) -> None:
        extra = self.procedures.after(activity, self.steps, ctx)
        if extra is None:
            return
        self.failed = extra.failed
        if extra.title:
            self._announce(extra.title, ctx)
        self.steps.extendleft(reversed(extra.steps))
        self.activity = extra.activity

    def _announce(self, text: str, ctx: ContextT) -> None:
        """Report to people that the next activity begins."""
        ctx.progress.step += 1
        ctx.progress.steps = ctx.progress.step + len(self.steps)
        ctx.progress.repeat = ctx.progress.repeats = 0
        ctx.progress.title, ctx.progress.phase = text, ""
        ctx.journal.event(ctx.now, "step", ctx.progress.title)
        ctx.journal.flush()
