"""Reduces a measured repeat and commits its result to the store, for the activity that measures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite
from typing import Generic, TypeVar

from tester.analysis.blocks import Block
from tester.analysis.flags import IMPRECISE, NOT_SHOWN, flags_in, joined
from tester.analysis.judge import ALONE
from tester.analysis.left_out import Combining
from tester.analysis.reduce import bursts_of, counted, reduce_repeat, without_value
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NOT_JUDGED, ConditionStatus, RepeatResult, RepeatStatus
from tester.analysis.swing import swing_of
from tester.analysis.uncertainty import Pool
from tester.base.axes import condition_words
from tester.base.words import coefficient, decimal
from tester.inputs.recipe.grid_settings import LEAST_REPEATS
from tester.inputs.recipe.plan import ConditionStep, Plan
from tester.machine.context import AnyContext
from tester.machine.measured import CONDITION_STATUS, REPEAT_STATUS, ConditionEnd, MeasuredRepeat, RepeatOutcome
from tester.store.recorder import Recorder
from tester.store.records import ConditionInfo
from tester.store.resumable import ConditionSoFar, ResumePoint
from tester.store.sql import Judged

ContextT = TypeVar("ContextT", bound=AnyContext)


class StoredResults(Generic[ContextT]):
    """Reduces repeats from the blocks counted live (the stored samples give the same blocks), judges and commits
    them.
    """

    def __init__(
        self, recorder: Recorder, combining: Combining = "mean", point: ResumePoint | None = None
    ) -> None:
        """``recorder``: the run's store; ``combining``: how the recipe combines repeats; ``point``: where an
        interrupted run resumes."""
        self.recorder = recorder
        self.combining: Combining = combining
        self.lost = False
        """Whether the condition that ended last has no value."""
        self.condition = 0
        """Number of the present condition, to which the fields below belong."""
        self.repeats: list[RepeatResult] = []
        self.keys: list[int] = []
        self.blocks: list[Sequence[Block]] = []
        """The counted blocks of each repeat."""
        self.judgement = NOT_JUDGED
        self.judged = 0
        """Number of repeats that the present judgement covers."""
        self.pool = point.pool if point is not None else Pool()
        """Repeatability pooled from the finished conditions."""
        self.earlier: dict[int, ConditionSoFar] = dict(point.conditions) if point is not None else {}
        """Data that earlier stretches of an interrupted run committed for unfinished conditions."""

    def repeats_done(self, step: ConditionStep) -> int:
        """Return how many repeats of a condition an earlier stretch of the run committed."""
        earlier = self.earlier.get(step.condition)
        return len(earlier.results) if earlier is not None else 0

    def over(self, step: ConditionStep) -> ConditionEnd | None:
        """Return how an earlier stretch ended the condition; None if the condition is not finished."""
        earlier = self.earlier.get(step.condition)
        if earlier is None:
            return None
        self._turn_to(step)
        ending = next((e for e, status in REPEAT_STATUS.items() if status is earlier.over), None)
        if ending is None and self.another(step):
            return None
        detail = earlier.results[-1].reason if ending is not None else ""
        return ConditionEnd(ending, detail, earlier.warming_k_s, earlier.holdable_band_k)

    def another(self, step: ConditionStep) -> bool:
        """Return whether to measure a further repeat: one is missing or undecided, and one more is allowed."""
        scheme = step.scheme
        made, half = divmod(len(self.repeats), scheme.repeats_each)
        if half or made < step.repeats or made >= step.at_most:
            return half > 0 or made < step.repeats
        counted = len(scheme.values(self.repeats))
        if not counted and not any(result.drifts for result in self.repeats):
            return False  # no repeat gave a value, and a further one would fail for the same reason
        if counted < step.repeats or (step.repeats > ALONE and NOT_SHOWN in flags_in(self.judgement.flags)):
            return True
        return not self._precise(step)

    def attempt(self, step: ConditionStep, repeat: int) -> int:
        """Return the number of the next attempt at a repeat, from 1."""
        earlier = self.earlier.get(step.condition)
        return 1 + (earlier.attempts.get(repeat, 0) if earlier is not None else 0)

    def begin_repeat(self, ctx: ContextT, step: ConditionStep, repeat: int, attempt: int) -> int:
        """Open a repeat in the store; return the key for its samples."""
        self._turn_to(step)
        if repeat == self.repeats_done(step) + 1:
            self.recorder.begin_condition(step.condition, ctx.now)
        return self.recorder.begin_repeat(step.condition, repeat, attempt, ctx.now, self.mounted(ctx))

    def finish_repeat(
        self, ctx: ContextT, step: ConditionStep, key: int, repeat: int, measured: MeasuredRepeat
    ) -> RepeatOutcome:
        """Reduce and commit a repeat; after the last planned repeat, judge the condition."""
        assert measured.ending is not None
        blocks, window = measured.counter.blocks, step.window
        status = REPEAT_STATUS.get(measured.ending)
        if status is not None:
            result = without_value(status, measured.detail, ended_s=ctx.now)
        else:
            result = reduce_repeat(
                blocks,
                window,
                rolling=measured.rolling_only,
                alone=step.repeats <= ALONE,
                swing=None if measured.rolling_only else swing_of(measured.counter.trace),
            )
            doubts = self.doubts(ctx, step)
            if doubts and result.valid:
                result = replace(result, flags=joined([*flags_in(result.flags), *doubts]))
        self.repeats.append(result)
        self.keys.append(key)
        self.blocks.append(counted(blocks, window))
        refused = self._judge(step) if self._enough_to_judge(step) else []
        result = self.repeats[-1]
        self.record_mounted(ctx)
        if isfinite(measured.warming_k_s):
            self.recorder.condition_rate(step.condition, measured.warming_k_s, measured.holdable_band_k)
        ticket = self.recorder.commit_repeat(key, result, bursts_of(blocks), self._for_the_record())
        lost = "".join(f"; repeat {i + 1} {_line(self.repeats[i])}" for i in refused if self.repeats[i] is not result)
        return RepeatOutcome(result.status, _line(result) + lost, ticket)

    def void_repeat(self, ctx: ContextT, key: int, reason: str) -> None:
        """Record that a repeat was interrupted and is void; a further attempt follows."""
        self.recorder.void_repeat(key, reason, ctx.now)

    def finish_condition(self, ctx: ContextT, step: ConditionStep, end: ConditionEnd) -> str:
        """Combine a condition's repeats and commit the result; return a line for people.

        The line shows the coefficient as measured. The coefficient at the requested temperature may depend on
        conditions that are not measured yet.
        """
        self._turn_to(step)
        if not self.repeats:
            self.recorder.begin_condition(step.condition, ctx.now)
        if self.judged < len(self.repeats):
            self._judge(step)
        if step.until_percent is not None and self.repeats and not self._precise(step):
            self.judgement = replace(self.judgement, flags=joined([*flags_in(self.judgement.flags), IMPRECISE]))
        status = CONDITION_STATUS[end.ending] if end.ending is not None else None
        reason = end.detail
        if not self.repeats:
            result = ConditionResult(status or ConditionStatus.INSUFFICIENT, reason)
        else:
            result = step.scheme.combine(self.repeats, step.repeats, step.min_valid, status or ConditionStatus.OK,
                                        reason, judged=self.judgement, combining=self.combining)  # fmt: skip
        self.pool = self._pooled(step)
        stored_status = ConditionStatus.OK if result.ok else result.status
        self.recorder.end_condition(
            step.condition,
            stored_status,
            result.reason,
            ctx.now,
            warming_k_s=end.warming_k_s,
            holdable_band_k=end.holdable_band_k,
            judged=self._for_the_record(),
        )
        self.condition = 0
        self.lost = not result.ok
        name = f"condition {step.condition} ({condition_words(step.setpoint)})"
        if not result.ok:
            return f"{name}: {stored_status.value}: {result.reason}"
        flags = f" ({result.flags})" if result.flags else ""
        mu = f"mu as measured {coefficient(result.mu_resultant)}, s {decimal(result.s, 4)}"
        return f"{name}: {mu}, valid {result.counts.words}{flags}"

    # -- of the present condition -------------------------------------------------------------------------------

    def _turn_to(self, step: ConditionStep) -> None:
        """Make a condition the present one, with the data that an earlier stretch of the run committed for it."""
        if self.condition == step.condition:
            return
        self.condition = step.condition
        earlier = self.earlier.get(step.condition)
        self.repeats = list(earlier.results) if earlier is not None else []
        self.keys = list(earlier.keys) if earlier is not None else []
        window = step.window
        committed = earlier.blocks if earlier is not None else ()
        self.blocks = [counted(blocks, window) for blocks in committed]
        self.judgement = earlier.judged if earlier is not None else NOT_JUDGED
        self.judged = len(self.repeats) if self.judgement.made else 0
        if self._enough_to_judge(step):
            self._judge(step)

    def _enough_to_judge(self, step: ConditionStep) -> bool:
        return not len(self.repeats) % step.scheme.repeats_each and step.scheme.valid(self.repeats) >= step.repeats

    def _judge(self, step: ConditionStep) -> list[int]:
        """Judge the condition from its present repeats; return the positions of newly rejected ones."""
        window = step.window
        before = self.repeats
        self.repeats, self.judgement = step.scheme.judge(
            before, self.blocks, step.repeats, window
        )
        self.judged = len(before)
        return [i for i, result in enumerate(self.repeats) if before[i].valid and not result.valid]

    def _for_the_record(self) -> Judged | None:
        if not self.judged:
            return None
        return Judged(self.condition, self.judgement, dict(zip(self.keys, self.repeats, strict=True)))

    def _pooled(self, step: ConditionStep) -> Pool:
        return self.pool.with_condition(step.scheme.values(self.repeats), step.scheme.repeats_each)

    def _precise(self, step: ConditionStep) -> bool:
        """Return whether the condition's expanded repeatability is as small as the recipe requests, if it requests
        any.
        """
        if step.until_percent is None:
            return True
        n, each = len(step.scheme.values(self.repeats)), step.scheme.repeats_each
        return n >= LEAST_REPEATS and self._pooled(step).expanded_percent(n * each) <= step.until_percent

    # -- a kind may record more ----------------------------------------------------------------------------------

    def doubts(self, ctx: ContextT, step: ConditionStep) -> tuple[str, ...]:
        """Return the flags of a repeat that ends now, of causes that its samples do not show."""
        return ()

    def mounted(self, ctx: ContextT) -> int:
        """Return the number of the mounted specimen."""
        return ctx.piece()[0]

    def record_mounted(self, ctx: ContextT) -> None:
        """Record the specimen's state after a repeat."""
        ctx.record_piece(self.recorder, ctx.now)


def condition_records(plan: Plan) -> Iterator[ConditionInfo]:
    """Yield a plan's conditions as records for the store."""
    for step in plan.conditions():
        yield ConditionInfo(
            condition=step.condition,
            row=step.row,
            specimen=step.specimen,
            replicate=step.replicate,
            grid=step.grid,
            note=plan.specimen(step.specimen).note,
            setpoint=step.setpoint,
            temperature_band_k=step.temperature_band_k,
            repeats=step.repeats,
            min_valid=step.min_valid,
            window_revolutions=step.window.revolutions,
            window_s=step.window.seconds,
            at_most=step.at_most,
            until_percent=step.until_percent,
            both_directions=step.both_directions,
        )


def _line(result: RepeatResult) -> str:
    if result.status is RepeatStatus.VALID:
        mu = f"mu as measured {coefficient(result.mu_resultant)}"
        return f"{mu}, {result.revolutions} revolutions, {result.bursts} bursts"
    return f"{result.status.value}: {result.reason}"
