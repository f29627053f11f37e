"""One condition and one repeat. A condition brings the air to its temperature before each repeat. A repeat tares with
the arm raised, lowers it, slides a stated way with stationary friction, there and back, and raises the arm.

A linear track slides forward and back, so that a shift of the cell's zero cancels in the mean; it turns back before the
end of its travel. A disc slides one way. The way is counted in stretches. Friction is stationary, and samples count,
once its means of three stretches in a row differ by less than ``gates.stationary``.
"""

from __future__ import annotations

from enum import Enum
from math import ceil, inf, nan
from typing import Final

from tester.analysis.blocks import BlockCounter
from tester.analysis.stability import REPEAT_WINDOWS, filled
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.context import TrackContext, TrackTarget
from tester.kinds.specimen_on_track.interlocks.witness import least_stated
from tester.kinds.specimen_on_track.procedures.motions import ComeToStand, GoTo, TakeTrackTare, arm
from tester.kinds.specimen_on_track.recipe.plan_steps import STRETCHES, TrackCondition
from tester.machine.activity import Activity
from tester.machine.condition import MeasureCondition
from tester.machine.measured import ConditionEnd, Ending, MeasuredRepeat
from tester.machine.motions import Power, Sequence, Settle
from tester.machine.result_keeping import StoredResults
from tester.machine.soak import SoakWait

ALIKE: Final = 2
"""Number of small differences in a row that make friction stationary: three stretches have two."""
LONGEST: Final = 60
"""Stretches after which friction is collected even if it is not stationary [A]."""
MOST_WAYS: Final = 8
"""Greatest number of ways, forward and back, in a repeat [A]."""
STOP_MM: Final = 5.0
"""Distance before its soft end at which the track turns back, mm [A]: its ramp takes 2.5 mm, two scans 1 mm."""
BLIND: Final = 5.0
"""Time without a counted block, in stretches, after which a repeat ends incomplete [A]."""


class SlidePhase(Enum):
    """Phase of a repeat."""

    TARE = "tare"
    LOWER = "lower"
    SETTLE = "settle"
    SLIDE = "slide"
    LIFT = "lift"


class Stationary:
    """Detects stationary friction from the means of consecutive stretches of one way."""

    def __init__(self, percent: float) -> None:
        """``percent``: greatest difference of the means."""
        self.share = 0.01 * percent
        self.begin(nan)

    def begin(self, stretch: float) -> None:
        """Start a way at this count of stretches (NaN: at the first reading)."""
        self.origin = stretch
        self.number = 0
        self.total = self.before = 0.0
        self.count = self.alike = 0

    def add(self, stretch: float, friction_n: float) -> bool:
        """Process a reading; return whether friction is stationary."""
        number = int(abs(stretch - self.origin))
        if number > self.number:
            mean = self.total / self.count if self.count else nan
            small = abs(mean - self.before) <= self.share * abs(mean) and mean > 0.0
            self.alike = self.alike + 1 if small and self.number else 0
            self.number, self.before, self.total, self.count = number, mean, 0.0, 0
        self.total += friction_n
        self.count += 1
        return self.alike >= ALIKE or self.number >= LONGEST


class MeasureTrackRepeat(MeasuredRepeat):
    """State object of one repeat."""

    def __init__(self, step: TrackCondition, ctx: TrackContext, tare_kind: str) -> None:
        """``tare_kind``: kind of the zero in the record."""
        super().__init__(BlockCounter(ctx.quantities))
        self.condition = step
        held = held_by(step.setpoint)
        self.least_mu = least_stated(step.least_mu, held.interface, ctx.rig.interlocks.lost_share)
        ctx.demand.least_mu = 0.0
        self.speed_m_s = held.track_m_s
        self.stretch_m = step.way_m(held.track_m_s) / STRETCHES
        self.target = TrackTarget(
            temperature_c=held.temperature_c, band_k=step.temperature_band_k, stretch_m=self.stretch_m
        )
        self.stationary = Stationary(ctx.rig.gates.stationary_percent)
        self.both = ctx.rig.linear
        wanted = REPEAT_WINDOWS * STRETCHES
        self.a_way = ceil(wanted / 2.0) if self.both else ceil(wanted)
        """Stretches to count in each way."""
        self.tare = TakeTrackTare(tare_kind)
        self.phase = SlidePhase.TARE
        self.moves = self._tare(ctx)
        self.way = 0
        self.before = 0
        """Blocks counted before the present way."""
        self.sample: tuple[float, ...] = ()
        self.counted_s = inf

    def step(self, ctx: TrackContext) -> bool:
        """Advance by one scan; done when the arm is raised and ``ending`` is set."""
        progress = ctx.progress
        progress.phase, progress.burst = self.phase.value, self.way
        progress.revolutions = float(len(self.counter.blocks))
        if self.phase is SlidePhase.SLIDE:
            self._slide(ctx)
        elif self.moves.step(ctx):
            return self._next(ctx)
        return False

    # -- the phases -------------------------------------------------------------------------------------------

    def _tare(self, ctx: TrackContext) -> Sequence:
        going: list[Activity[TrackContext]] = []
        if self.both:
            limits = ctx.rig.limits
            middle_mm = 0.5 * (limits.travel_low_mm + limits.travel_high_mm)
            if abs(ctx.readings.track_mm - middle_mm) > 0.25 * (limits.travel_high_mm - limits.travel_low_mm):
                going = [GoTo(middle_mm), ComeToStand()]
        return Sequence(*arm(ctx, lowered=False), Power(True), ComeToStand(), *going, Settle(0.3), self.tare)

    def _next(self, ctx: TrackContext) -> bool:
        """Begin the next phase; return whether the last phase is over."""
        if self.phase is SlidePhase.TARE:
            if self.tare.failed:
                self._end(ctx, Ending.ZERO_DRIFT, self.tare.failed)
            else:
                self.phase, self.moves = SlidePhase.LOWER, Sequence(*arm(ctx, lowered=True))
        elif self.phase is SlidePhase.LOWER:
            self.phase, self.moves = SlidePhase.SETTLE, Sequence(Settle(ctx.rig.gates.settle_s))
        elif self.phase is SlidePhase.SETTLE:
            self.phase = SlidePhase.SLIDE
            ctx.target = self.target
            ctx.demand.least_mu = self.least_mu
            self._go(ctx)
        else:
            return True
        return False

    def _go(self, ctx: TrackContext) -> None:
        """Begin a way, alternately forward and back."""
        self.way += 1
        ctx.burst = self.way
        speed = self.speed_m_s if self.way % 2 or not self.both else -self.speed_m_s
        ctx.demand.track_m_s = self.target.track_m_s = speed
        self.target.stationary = False
        self.stationary.begin(nan)
        self.before = len(self.counter.blocks)
        self.counted_s = ctx.now

    # -- sliding ----------------------------------------------------------------------------------------------

    def _slide(self, ctx: TrackContext) -> None:
        r, target = ctx.readings, self.target
        if not target.stationary:
            self._settle(ctx)
        if ctx.sample is not self.sample:
            self.sample = ctx.sample
            if self.counter.add(ctx.sample) is not None:
                self.counted_s = ctx.now
        here = len(self.counter.blocks) - self.before
        late = ctx.now - self.counted_s > max(BLIND * self.stretch_m / self.speed_m_s, 5.0)
        counter, window = self.counter, self.condition.window
        if len(counter.blocks) >= window.extend_to or (filled(counter, window) and (self.way > 1 or not self.both)):
            self._end(ctx, Ending.COMPLETE, "")
        elif target.stationary and late:
            self._end(ctx, Ending.INCOMPLETE, f"nothing counted for {ctx.now - self.counted_s:.0f} s")
        elif self.both and (here >= self.a_way or self._at_end(ctx, r.track_mm)):
            if self.way >= MOST_WAYS:
                self._end(ctx, Ending.INCOMPLETE, f"{len(self.counter.blocks)} stretches in {self.way} ways")
            else:
                self._go(ctx)

    def _settle(self, ctx: TrackContext) -> None:
        r, stationary = ctx.readings, self.stationary
        if abs(r.track_m_s - self.target.track_m_s) > 0.01 * ctx.rig.gates.speed_percent * self.speed_m_s:
            stationary.begin(nan)
            self.counted_s = ctx.now
            return
        if stationary.origin != stationary.origin:
            stationary.begin(r.stretch)
        if stationary.add(r.stretch, r.friction_n):
            self.target.stationary = True
        self.counted_s = ctx.now

    def _at_end(self, ctx: TrackContext, place_mm: float) -> bool:
        """Return whether the track must turn back before the end of its travel."""
        limits = ctx.rig.limits
        if self.target.track_m_s > 0.0:
            return place_mm >= limits.travel_high_mm - STOP_MM
        return place_mm <= limits.travel_low_mm + STOP_MM

    def _end(self, ctx: TrackContext, ending: Ending, detail: str) -> None:
        ctx.burst = 0
        ctx.demand.least_mu = 0.0
        self.ending, self.detail = ending, detail
        ctx.target = TrackTarget()
        self.phase = SlidePhase.LIFT
        self.moves = Sequence(ComeToStand(), *arm(ctx, lowered=False))


class MeasureTrackCondition(MeasureCondition[TrackContext, TrackCondition, MeasureTrackRepeat]):
    """State object of one condition."""

    def __init__(self, step: TrackCondition, results: StoredResults[TrackContext]) -> None:
        """``results`` takes the repeats."""
        super().__init__(step, results)
        self.wait: SoakWait | None = None

    def ready(self, ctx: TrackContext) -> bool:
        """Return whether the air is at the condition's temperature; end the condition if it never gets there."""
        step, r = self.condition, ctx.readings
        wanted_c = held_by(step.setpoint).temperature_c
        wait = self.wait = self.wait or SoakWait(wanted_c, step.temperature_band_k, 0.0, step.soak.at_most_s)
        if ctx.rig.chamber:
            ctx.demand.chamber_c = wanted_c
        if not wait.over(ctx, "temper", r.air_c, valid=r.air_valid):
            return False
        if not wait.reached:
            text = f"air at {r.air_c:.1f} degC after {(ctx.now - wait.began_s) / 60:.0f} min"
            self.end = ConditionEnd(Ending.NOT_REACHED, text)
        self.wait = None
        return wait.reached

    def begin(self, ctx: TrackContext, attempt: int) -> MeasureTrackRepeat:
        """Return the repeat; a specimen's first zero is its reference."""
        ctx.attendant.begin_repeat(self.condition.row, self.repeat, attempt)
        return MeasureTrackRepeat(self.condition, ctx, "repeat" if ctx.demand.tared else "reference")
