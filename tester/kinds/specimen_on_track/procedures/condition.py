"""One condition: the air at its temperature before each of its repeats."""

from __future__ import annotations

from math import inf

from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.procedures.slide import MeasureTrackRepeat
from tester.kinds.specimen_on_track.recipe.plan_steps import TrackCondition
from tester.machine.condition import MeasureCondition
from tester.machine.measured import ConditionEnd, Ending
from tester.machine.result_keeping import StoredResults


class TrackResults(StoredResults[TrackContext]):
    """Results of a specimen on a track."""

    def mounted(self, ctx: TrackContext) -> int:
        """Return the specimen's number."""
        return ctx.on.number

    def record_mounted(self, ctx: TrackContext) -> None:
        """Put the distance that the specimen has slid on record."""
        self.recorder.piece_state(ctx.on.number, float("nan"), ctx.on.sliding_m, ctx.now)


class MeasureTrackCondition(MeasureCondition[TrackContext, TrackCondition, MeasureTrackRepeat]):
    """State object of one condition."""

    def __init__(self, step: TrackCondition, results: TrackResults) -> None:
        """``results``: where repeats go."""
        super().__init__(step, results)
        self.waits_since_s = inf

    def ready(self, ctx: TrackContext) -> bool:
        """Return whether the air is at the condition's temperature; end the condition where it does not get there."""
        step, r = self.condition, ctx.readings
        wanted_c = held_by(step.setpoint).temperature_c
        if ctx.rig.chamber:
            ctx.demand.chamber_c = wanted_c
        if r.air_valid and abs(r.air_c - wanted_c) <= step.temperature_band_k:
            self.waits_since_s = inf
            return True
        ctx.progress.phase = f"temper {r.air_c:.1f} of {wanted_c:.1f} degC"
        self.waits_since_s = min(self.waits_since_s, ctx.now)
        waited_s = ctx.now - self.waits_since_s
        if waited_s > step.soak.at_most_s:
            text = f"air at {r.air_c:.1f} degC after {waited_s / 60:.0f} min"
            self.end = ConditionEnd(Ending.NOT_REACHED, text)
        return False

    def begin(self, ctx: TrackContext, attempt: int) -> MeasureTrackRepeat:
        """Return the repeat; a specimen's first zero is its reference."""
        ctx.attendant.begin_repeat(self.condition.row, self.repeat, attempt)
        return MeasureTrackRepeat(self.condition, ctx, "repeat" if ctx.demand.tared else "reference")
