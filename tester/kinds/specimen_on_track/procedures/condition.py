"""One condition: the air at its temperature, then its repeats, each committed before the next begins."""

from __future__ import annotations

from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.procedures.slide import MeasureTrackRepeat
from tester.kinds.specimen_on_track.recipe.steps import TrackCondition
from tester.machine.measured import ConditionEnd, Ending, RepeatOutcome
from tester.machine.results import StoredResults


class TrackResults(StoredResults[TrackContext]):
    """Results of a specimen on a track."""

    def mounted(self, ctx: TrackContext) -> int:
        """Return the specimen's number."""
        return ctx.on.number

    def record_mounted(self, ctx: TrackContext) -> None:
        """Put the distance that the specimen has slid on record."""
        self.recorder.piece_state(ctx.on.number, float("nan"), ctx.on.sliding_m, ctx.now)


class MeasureTrackCondition:
    """State object of one condition."""

    def __init__(self, step: TrackCondition, results: TrackResults) -> None:
        """``results``: where repeats go."""
        self.condition = step
        self.results = results
        self.repeat = results.repeats_done(step)
        self.voided = 0
        """Attempts at the present repeat that a hold cut off."""
        self.key = 0
        self.waits_since_s = float("inf")
        self.measuring: MeasureTrackRepeat | None = None
        self.outcome: RepeatOutcome | None = None
        self.over = False
        self.failed = ""

    def resume(self, ctx: TrackContext) -> None:
        """Make a repeat that a hold cut off again, from its tare."""
        if self.outcome is None and self.measuring is not None:
            self.results.void_repeat(ctx, self.key, "held by the operator")
            ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: void, held by the operator")
            self.measuring = None
            self.repeat -= 1
            self.voided += 1

    def step(self, ctx: TrackContext) -> bool:
        """Advance by one scan; done when the condition is committed."""
        progress, step = ctx.progress, self.condition
        progress.condition, progress.repeat = step.condition, self.repeat
        progress.repeats = max(step.repeats, self.repeat)
        if self.outcome is not None:
            return self._committed(ctx)
        if self.measuring is None and not self._begin(ctx):
            return self.over
        assert self.measuring is not None
        if self.measuring.step(ctx):
            measured = self.measuring
            self.outcome = self.results.finish_repeat(ctx, step, self.key, self.repeat, measured)
            ctx.repeat_key = ctx.burst = 0
            ctx.journal.event(ctx.now, "repeat", f"repeat {self.repeat}: {self.outcome.text}")
        return False

    def _begin(self, ctx: TrackContext) -> bool:
        """Begin a repeat once the air is at its temperature; tell whether it has begun."""
        step, held = self.condition, held_by(self.condition.setpoint)
        over = self.results.over(step)
        if over is not None:
            return self._close(ctx, over)
        if ctx.rig.chamber:
            ctx.demand.chamber_c = held.temperature_c
        r = ctx.readings
        if not (r.air_valid and abs(r.air_c - held.temperature_c) <= step.temperature_band_k):
            ctx.progress.phase = f"temper {r.air_c:.1f} of {held.temperature_c:.1f} degC"
            self.waits_since_s = min(self.waits_since_s, ctx.now)
            waited_s = ctx.now - self.waits_since_s
            if waited_s <= step.soak.at_most_s:
                return False
            return self._close(
                ctx, ConditionEnd(Ending.NOT_REACHED, f"air at {r.air_c:.1f} degC after {waited_s / 60:.0f} min")
            )
        self.waits_since_s = float("inf")
        self.repeat += 1
        attempt = self.results.attempt(step, self.repeat) + self.voided
        ctx.attendant.begin_repeat(step.row, self.repeat, attempt)
        self.key = self.results.begin_repeat(ctx, step, self.repeat, attempt)
        ctx.repeat_key = self.key
        self.measuring = MeasureTrackRepeat(step, ctx, "repeat" if ctx.demand.tared else "reference")
        ctx.progress.revolutions_wanted = 1.5 * (step.window.revolutions or 0.0)
        return True

    def _committed(self, ctx: TrackContext) -> bool:
        """Wait, raised, until the repeat is on disk; then go on to the next one or close the condition."""
        assert self.outcome is not None and self.measuring is not None
        if not self.outcome.ticket.done:
            return False
        measured, self.measuring, self.outcome = self.measuring, None, None
        self.voided = 0
        if measured.ending is Ending.ZERO_DRIFT:
            self.failed = measured.detail
            return self._close(ctx, ConditionEnd(measured.ending, measured.detail)) or True
        if self.results.another(self.condition):
            return False
        self._close(ctx, ConditionEnd())
        return True

    def _close(self, ctx: TrackContext, end: ConditionEnd) -> bool:
        """Commit the condition; return False: no repeat has begun."""
        ctx.journal.event(ctx.now, "condition", self.results.finish_condition(ctx, self.condition, end))
        self.over = True
        return False
