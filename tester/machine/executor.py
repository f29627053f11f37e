"""Walk the plan: one activity after the other, each a small state object stepped once a scan."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Generic, TypeVar

from tester.inputs.recipe.plan import Plan, Step
from tester.machine.activity import Activity, MoveFailedError, Resumable
from tester.machine.context import AnyContext

ContextT = TypeVar("ContextT", bound=AnyContext)


class Unforeseen(Generic[ContextT]):
    """What has to be done that the plan does not say: an activity, steps put before those to come, or nothing more."""

    def __init__(
        self,
        activity: Activity[ContextT] | None = None,
        title: str = "",
        steps: Sequence[Step] = (),
        failed: str = "",
    ) -> None:
        """``title``: of the activity, "" where it belongs to the step before. ``failed``: why the run ends here."""
        self.activity = activity
        self.title = title
        self.steps = tuple(steps)
        self.failed = failed


class Procedures(Generic[ContextT]):
    """Which activity serves which step: what a kind of machine says."""

    def title(self, step: Step) -> str:
        """Return a line that says what a step does."""
        raise NotImplementedError

    def activity(self, step: Step, to_come: Sequence[Step], ctx: ContextT) -> Activity[ContextT]:
        """Return what serves a step; ``to_come``: the steps behind it."""
        raise NotImplementedError

    def before(self, step: Step, ctx: ContextT) -> Unforeseen[ContextT] | None:
        """Return what has to be done before a step may begin; None where it may. It is asked again after that."""
        return None

    def after(
        self, activity: Activity[ContextT], to_come: Sequence[Step], ctx: ContextT
    ) -> Unforeseen[ContextT] | None:
        """Return what an activity that has ended leads to; None where the plan goes on."""
        return None

    def number_after(self, last: int) -> None:
        """Number what the plan did not foresee from behind ``last``: the plan may be a part of one."""

    def resumed(self, ctx: ContextT) -> None:
        """Demand what a step may begin anew from after a hold, before the activity in progress is resumed."""

    def measuring(self, activity: Activity[ContextT]) -> bool:
        """Tell whether an activity measures repeats at the moment: they tell how long it still takes."""
        return False


class Executor(Generic[ContextT]):
    """The steps still to do, the one in progress, and whether the run is finished."""

    def __init__(self, plan: Plan, procedures: Procedures[ContextT]) -> None:
        """Begin before the first step."""
        self.plan = plan
        self.procedures = procedures
        self.steps: deque[Step] = deque(plan.steps)
        self.activity: Activity[ContextT] | None = None
        self.finished = False
        self.failed = ""

    @property
    def measuring(self) -> bool:
        """Repeats of a condition are under way."""
        return self.activity is not None and self.procedures.measuring(self.activity)

    def hold(self, ctx: ContextT) -> None:
        """Note that the rig is held: what is recorded meanwhile belongs to no repeat."""
        ctx.burst = ctx.repeat_key = 0

    def resume(self, ctx: ContextT) -> None:
        """Go on after a hold: a repeat that was cut off is void and done again."""
        self.procedures.resumed(ctx)
        if isinstance(self.activity, Resumable):
            self.activity.resume(ctx)

    def step(self, ctx: ContextT) -> None:
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

    def _begin(self, step: Step, ctx: ContextT) -> Activity[ContextT]:
        found = self.procedures.before(step, ctx)
        if found is None:
            self._announce(self.procedures.title(step), ctx)
            return self.procedures.activity(step, self.steps, ctx)
        self.steps.appendleft(step)
        self.steps.extendleft(reversed(found.steps))
        if found.activity is None:
            return self._begin(self.steps.popleft(), ctx)
        self._announce(found.title, ctx)
        return found.activity

    def _end(self, activity: Activity[ContextT], ctx: ContextT) -> None:
        found = self.procedures.after(activity, self.steps, ctx)
        if found is None:
            return
        self.failed = found.failed
        if found.title:
            self._announce(found.title, ctx)
        self.steps.extendleft(reversed(found.steps))
        self.activity = found.activity

    def _announce(self, text: str, ctx: ContextT) -> None:
        """Tell what is done next."""
        ctx.progress.step += 1
        ctx.progress.steps = ctx.progress.step + len(self.steps)
        ctx.progress.repeat = ctx.progress.repeats = 0
        ctx.progress.title, ctx.progress.phase = text, ""
        ctx.journal.event(ctx.now, "step", ctx.progress.title)
        ctx.journal.flush()
