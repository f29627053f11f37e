"""From a measured repeat to a committed result: reduction and store behind the executor's one door."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from tester.analysis.reduce import bursts_of, reduce_repeat, without_value
from tester.analysis.repeats import combine_repeats
from tester.analysis.results import ConditionStatus, RepeatResult, RepeatStatus
from tester.axes import condition_words
from tester.engine.bursts import Ending, MeasureRepeat
from tester.engine.condition import ConditionEnd, RepeatOutcome
from tester.engine.context import Context
from tester.recipe.estimate import predicted_loss_mm
from tester.recipe.plan import ConditionStep, Plan
from tester.rig import RigConfig
from tester.store.recorder import Recorder
from tester.store.records import ConditionInfo
from tester.store.resume import ConditionSoFar

REPEAT_STATUS: dict[Ending, RepeatStatus] = {
    Ending.CANNOT_HOLD: RepeatStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: RepeatStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: RepeatStatus.VOID,
}
"""Endings that leave no value, whatever was collected; the others are for the reduction to judge."""

CONDITION_STATUS: dict[Ending, ConditionStatus] = {
    Ending.CANNOT_HOLD: ConditionStatus.CANNOT_HOLD,
    Ending.NOT_REACHED: ConditionStatus.NOT_REACHED,
    Ending.ZERO_DRIFT: ConditionStatus.SKIPPED,
}


class StoredResults:
    """Reduces repeats from the blocks counted live (the stored samples give the same ones) and commits them."""

    def __init__(self, recorder: Recorder) -> None:
        """``recorder``: the run's store."""
        self.recorder = recorder
        self.repeats: list[RepeatResult] = []
        self.earlier: dict[int, ConditionSoFar] = {}
        """What earlier stretches of an interrupted run committed of conditions that were not over."""

    def repeats_done(self, step: ConditionStep) -> int:
        """Return how many repeats of a condition an earlier stretch of the run committed."""
        earlier = self.earlier.get(step.condition)
        return len(earlier.results) if earlier is not None else 0

    def over(self, step: ConditionStep) -> ConditionEnd | None:
        """Return how the last of these ended the condition; None where it goes on."""
        earlier = self.earlier.get(step.condition)
        if earlier is None:
            return None
        ending = next((e for e, status in REPEAT_STATUS.items() if status is earlier.over), None)
        if ending is None and len(earlier.results) < step.repeats:
            return None
        self.repeats = list(earlier.results)
        detail = earlier.results[-1].reason if ending is not None else ""
        return ConditionEnd(ending, detail, earlier.warming_k_s, earlier.holdable_band_k)

    def attempt(self, step: ConditionStep, repeat: int) -> int:
        """Return the number of the next attempt at a repeat, from 1."""
        earlier = self.earlier.get(step.condition)
        return 1 + (earlier.attempts.get(repeat, 0) if earlier is not None else 0)

    def begin_repeat(self, ctx: Context, step: ConditionStep, repeat: int, attempt: int) -> int:
        """Open a repeat; return the key that its samples carry."""
        committed = self.repeats_done(step)
        if repeat == committed + 1:
            self.repeats = list(self.earlier[step.condition].results) if committed else []
            self.recorder.begin_condition(step.condition, ctx.now)
        return self.recorder.begin_repeat(step.condition, repeat, attempt, ctx.now, ctx.wheel.wheel)

    def finish_repeat(
        self, ctx: Context, step: ConditionStep, key: int, repeat: int, measured: MeasureRepeat
    ) -> RepeatOutcome:
        """Reduce and commit a repeat."""
        assert measured.ending is not None
        blocks = measured.counter.blocks
        status = REPEAT_STATUS.get(measured.ending)
        if status is not None:
            result = without_value(status, measured.detail, ended_s=ctx.now)
        else:
            window = step.window
            result = reduce_repeat(blocks, window.revolutions, window.seconds, rolling=measured.rolling_only)
        self.repeats.append(result)
        wheel = ctx.wheel
        self.recorder.wheel_state(wheel.wheel, wheel.diameter_mm, wheel.sliding_m, ctx.now)
        if isfinite(measured.warming_k_s):
            self.recorder.condition_rate(step.condition, measured.warming_k_s, measured.holdable_band_k)
        ticket = self.recorder.commit_repeat(key, result, bursts_of(blocks))
        return RepeatOutcome(result.status, _line(result), ticket)

    def void_repeat(self, ctx: Context, key: int, reason: str) -> None:
        """Record that a repeat was cut off; a further attempt follows."""
        self.recorder.void_repeat(key, reason, ctx.now)

    def finish_condition(self, ctx: Context, step: ConditionStep, end: ConditionEnd) -> str:
        """Sum a condition up from its repeats and commit it; return a line for people."""
        status = CONDITION_STATUS.get(end.ending) if end.ending is not None else None
        if not self.repeats:
            self.recorder.begin_condition(step.condition, ctx.now)
        found = combine_repeats(self.repeats, step.repeats, step.min_valid, status, end.detail)
        self.repeats = []
        # A condition that was left early still has its value where enough repeats were valid.
        left, reason = found.status, found.reason
        self.recorder.end_condition(
            step.condition, left, reason, ctx.now, warming_k_s=end.warming_k_s, holdable_band_k=end.holdable_band_k
        )
        name = f"condition {step.condition} ({condition_words(step.setpoint)})"
        if left is ConditionStatus.OK:
            return f"{name}: mu {found.mu_resultant:.4f}, s {found.s:.4f}, {found.n_valid} of {found.n}"
        return f"{name}: {left.value}: {reason}"

    def predicted_loss_mm(self, step: ConditionStep, rig: RigConfig) -> float:
        """Return the loss of diameter that a condition is expected to cost, mm."""
        return predicted_loss_mm(step, rig)


def condition_records(plan: Plan) -> Iterator[ConditionInfo]:
    """Yield a plan's conditions as the store keeps them."""
    for step in plan.conditions():
        sp = step.setpoint
        yield ConditionInfo(
            condition=step.condition,
            row=step.row,
            specimen=step.specimen,
            replicate=step.replicate,
            grid=step.grid,
            compound=sp.compound,
            note=plan.specimen(step.specimen).note,
            slip_velocity_m_s=sp.slip_velocity_m_s,
            load_n=sp.load_n,
            sideslip_deg=sp.sideslip_deg,
            camber_deg=sp.camber_deg,
            temperature_c=sp.temperature_c,
            wheel_speed_m_s=sp.wheel_speed_m_s,
            temperature_band_k=step.temperature_band_k,
            repeats=step.repeats,
            min_valid=step.min_valid,
            window_revolutions=step.window.revolutions,
            window_s=step.window.seconds,
        )


def _line(result: RepeatResult) -> str:
    if result.status is RepeatStatus.VALID:
        return f"mu {result.mu_resultant:.4f}, {result.revolutions} revolutions, {result.bursts} bursts"
    return f"{result.status.value}: {result.reason}"
