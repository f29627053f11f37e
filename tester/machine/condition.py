"""The measurement of one condition on any machine: its repeats, each committed before the next begins."""

from __future__ import annotations

from typing import Final, Generic, TypeVar

from tester.analysis.stability import REPEAT_WINDOWS
from tester.base.deriving import mypyc_attr
from tester.inputs.recipe.plan import ConditionStep
from tester.machine.context import AnyContext
from tester.machine.measured import ConditionEnd, Ending, MeasuredRepeat, RepeatOutcome
from tester.machine.result_keeping import StoredResults

LAST: Final = (Ending.ZERO_DRIFT, Ending.CANNOT_HOLD, Ending.NOT_REACHED)
"""A repeat with one of these endings ends its condition."""


ContextT = TypeVar("ContextT", bound=AnyContext)
StepT = TypeVar("StepT", bound=ConditionStep)
RepeatT = TypeVar("RepeatT", bound=MeasuredRepeat)


@mypyc_attr(allow_interpreted_subclasses=True)
class MeasureCondition(Generic[ContextT, StepT, RepeatT]):
    """The activity of one condition. A kind implements ``begin`` (the repeat) and ``ready`` (the work before it)."""

    def __init__(self, step: StepT, results: StoredResults[ContextT]) -> None:
        """``results`` judges and commits the repeats."""
        self.condition = step
        self.results = results
        self.done_before = results.repeats_done(step)
        """Number of repeats that an earlier stretch of the run committed."""
        self.repeat = self.done_before
        self.voided = 0
        """Number of attempts at the present repeat that a hold interrupted."""
        self.key = 0
        self.measuring: RepeatT | None = None
        self.outcome: RepeatOutcome | None = None
        self.end: ConditionEnd | None = None
        """How the condition ended; None while it is being measured."""
        self.failed = ""
        """Why the zero of the load cell is not trustworthy, which ends the run; "" if it is."""
        self._looked = False
        self._planned = step.repeats * step.scheme.repeats_each

    @property
    def in_repeat(self) -> bool:
        """Whether a repeat is under way, or is being committed."""
        return self.measuring is not None

    # -- by a kind ------------------------------------------------------------------------------------------

    def ready(self, ctx: ContextT) -> bool:
        """Return whether the next repeat may begin; set ``end`` if it can never begin."""
        return True

    def begin(self, ctx: ContextT, attempt: int) -> RepeatT:
        """Return the repeat that begins now; ``attempt`` counts from 1."""
        raise NotImplementedError

    def finish(self, ctx: ContextT, measured: RepeatT) -> None:
        """Reduce and commit a repeat that has ended."""
        self.outcome = self.results.finish_repeat(ctx, self.condition, self.key, self.repeat, measured)
        ctx.repeat_key = ctx.burst = 0
        ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: {self.outcome.text}")

    def resume(self, ctx: ContextT) -> None:
        """Void a repeat that a hold has interrupted, so that it is measured again; keep a repeat that is being
        committed.
        """
        if self.outcome is None and self.measuring is not None:
            self.results.void_repeat(ctx, self.key, "held by the operator")
            ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: void, held by the operator")
            self.measuring = None
            self.repeat -= 1
            self.voided += 1

    # -------------------------------------------------------------------------------------------------------

    def step(self, ctx: ContextT) -> bool:
        """Advance by one scan; return True when the condition is committed."""
        progress, step = ctx.progress, self.condition
        progress.condition, progress.repeat = step.condition, self.repeat
        progress.repeats = self._planned if self._planned > self.repeat else self.repeat
        if self.outcome is not None:
            return self._committed(ctx)
        if self.measuring is None:
            if not self._looked:
                self._looked, self.end = True, self.results.over(step)
            if self.end is None and self.ready(ctx):
                self._begin(ctx)
            if self.end is not None:
                return self._close(ctx, self.end)
        if self.measuring is not None and self.measuring.step(ctx):
            self.finish(ctx, self.measuring)
        return False

    def _begin(self, ctx: ContextT) -> None:
        step = self.condition
        self.repeat += 1
        attempt = self.results.attempt(step, self.repeat) + self.voided
        self.measuring = self.begin(ctx, attempt)
        ctx.repeat_key = self.key = self.results.begin_repeat(ctx, step, self.repeat, attempt)
        ctx.progress.revolutions_wanted = REPEAT_WINDOWS * (step.window.revolutions or 0.0)

    def _committed(self, ctx: ContextT) -> bool:
        """Wait until the repeat is on disk; then begin the next, or close the condition."""
        assert self.outcome is not None and self.measuring is not None
        if not self.outcome.ticket.done:
            return False
        measured, self.measuring, self.outcome = self.measuring, None, None
        self.voided = 0
        if measured.ending is Ending.ZERO_DRIFT:
            self.failed = measured.detail
        if measured.ending in LAST:
            end = ConditionEnd(measured.ending, measured.detail, measured.warming_k_s, measured.holdable_band_k)
            return self._close(ctx, end)
        return not self.results.another(self.condition) and self._close(ctx, ConditionEnd())

    def _close(self, ctx: ContextT, end: ConditionEnd) -> bool:
        text = self.results.finish_condition(ctx, self.condition, end)
        ctx.journal.event(ctx.now, "condition", text, "warning" if self.results.lost else "info")
        return True
