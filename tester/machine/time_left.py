"""The position of a run and its time left: the only module that counts steps, conditions and expected times.

The steps are those of the plan and, after each part of it, the way to standstill. The time left is the sum of the
expected durations of the later steps and of the rest of the present step. Each is a whole number of seconds, so that a
list of the steps adds up to it. Only work counts: in a hold, or while a prompt waits, neither the share nor the time
left changes. After a trip, a stop or a failure there is no time left to show. Each kind of step has its own pace, so
that rests that last as planned do not shorten conditions that take twice their estimate. Times are in s of rig time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import accumulate
from math import ceil
from statistics import fmean
from typing import TYPE_CHECKING, Final

import numpy as np

from tester.inputs.recipe.plan import ConditionStep, Plan, Step
from tester.machine.context import Progress
from tester.machine.run import Outcome, Run
from tester.machine.state import Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

PRIOR_S: Final = 300.0
"""Weight of the estimate for a kind of step, as an equivalent duration of measurement, s [A]."""
OVERRUN: Final = 0.1
"""A step that exceeds its expected duration is expected to take this much longer, as a share of its time so far [A]."""
SHOWN: Final = 0.3
"""A repeat's own pace counts once this share of the repeat is done [A]."""
SHOWN_S: Final = 30.0
"""... and after at least this time of contacts, s [A]."""
STANDSTILL: Final = "standstill"
"""Kind of the entry after the last step of a part: the way to standstill, including cooling."""


class Doing(Enum):
    """What a run is doing at present."""

    WORKING = "working"
    WAITING = "waiting"
    """The run is held, or a prompt waits."""
    GIVEN_UP = "given up"


def doing(run: Run) -> Doing:
    """Return what a run is doing at present."""
    executor, state = run.engine.executor, run.engine.control.state
    if run.outcome not in (Outcome.RUNNING, Outcome.DONE) or executor.failed:
        return Doing.GIVEN_UP
    if not run.connected or executor.finished:
        return Doing.WORKING
    if run.waiting or state.mode is Mode.HOLD:
        return Doing.WAITING
    return Doing.WORKING if state.mode in (Mode.ARMED, Mode.RUN) else Doing.GIVEN_UP


def share_of_repeat(progress: Progress) -> float:
    """Return the completed share of the present repeat, 0..1, by its revolutions."""
    wanted = progress.revolutions_wanted
    return min(progress.revolutions / wanted, 1.0) if wanted > 0.0 and progress.burst else 0.0


@dataclass(frozen=True, slots=True)
class PartTime:
    """A part of a run with the expected durations of its steps and of the way to standstill after them, s."""

    plan: Plan
    seconds: tuple[float, ...]
    down_s: float


@dataclass(frozen=True, slots=True)
class Earlier:
    """The work that earlier stretches of an interrupted run completed; empty for a new run."""

    seconds: float = 0.0
    over: frozenset[int] = frozenset()
    """Numbers of the finished conditions."""
    repeats: Mapping[int, int] = field(default_factory=dict[int, int])
    """Committed repeats of unfinished conditions, by condition number."""


@dataclass(frozen=True, slots=True)
class RunPosition:
    """Where a run is: steps and conditions counted, and times in s of rig time.

    ``over`` of the ``conditions`` are finished, with a value or without. ``share`` of the rig time is done, 0..1.
    ``left_s``: whole seconds to the end, None once the run was given up; ``step_left_s``: the present step's part of
    these. ``done_s``: time of the work done so far.
    """

    step: int = 0
    steps: int = 0
    over: int = 0
    conditions: int = 0
    share: float = 0.0
    left_s: float | None = None
    step_left_s: float = 0.0
    done_s: float = 0.0
    part: int = 1
    parts: int = 1
    beside: bool = False
    """Whether the figures cover only this part, because it runs beside others."""


class TimeLeft:
    """The steps of a run, with their expected and measured durations."""

    def __init__(self, parts: Sequence[PartTime], earlier: Earlier | None = None) -> None:
        """Begin before the first step of the first part."""
        self._earlier = earlier or Earlier()
        self._read(parts)
        self.position = -1
        """Index of the present step; an unplanned wheel change belongs to the step after it."""
        self.measured: dict[int, float] = {}
        """Duration of each finished step, s of work."""
        self.ahead: NDArray[np.float64] = self._estimated
        """Expected duration of each step, whole s."""
        self._ahead_s = 0.0
        """Sum of the expected durations of the steps after the present one."""
        self.revision = 0
        """Counts changes of the list of steps."""
        self._took: dict[str, tuple[float, float]] = {}
        """Measured and estimated durations of the finished steps, by kind, s."""
        self._part, self._parts, self._end = 0, len(parts), len(self.steps) - 1
        self._step = self._repeat = 0
        self._open = self._fresh = False
        """Whether the step at ``position`` is under way, and whether it is the first condition on a specimen."""
        self._doing = Doing.WORKING
        self._now = 0.0
        self._worked_s = 0.0
        """Work done in all parts until ``_now``, s."""
        self._began_s = 0.0
        """Work done when the present step began, s."""
        self._contact_s: float | None = None
        """Work done when the present repeat had its first contact, s: before that, it may wait long for its
        temperature.
        """
        self._repeats_s: list[float] = []
        """Durations of the finished repeats of the present condition, s."""
        self._within, self._to_come = 0.0, 0
        """Completed share of the present repeat, and the number of repeats after it."""
        self._expect()

    def _read(self, parts: Sequence[PartTime]) -> None:
        """List the steps of all parts, and compute what stays the same for the whole run."""
        self.steps: list[Step | None] = []
        """The plan's steps, with None after each part's last: the way to standstill."""
        self.estimated: list[float] = []
        self._ends: dict[int, int] = {}
        """Index of each part's way to standstill, by the identity of the part's last step."""
        for part in parts:
            self._list(part)
        self._kinds = [STANDSTILL if step is None else step.kind for step in self.steps]
        self._sorts = list(dict.fromkeys(self._kinds))
        self._sort = np.array([self._sorts.index(kind) for kind in self._kinds], dtype=np.intp)
        self._estimated = np.array(self.estimated)
        self._places = {id(step): place for place, step in enumerate(self.steps) if step is not None}
        planned = {step.condition for step in self.steps if isinstance(step, ConditionStep)}
        over = accumulate((isinstance(step, ConditionStep) for step in self.steps), initial=0)
        self._over = [len(self._earlier.over - planned) + count for count in over]
        """Number of conditions finished before each step begins, and after the last step."""
        self._conditions = len(self._earlier.over | planned)

    def _list(self, part: PartTime) -> None:
        """Add a part: its steps, less the repeats committed before, and the way to standstill."""
        for step, seconds in zip(part.plan.steps, part.seconds, strict=True):
            done = self._earlier.repeats.get(step.condition, 0) if isinstance(step, ConditionStep) else 0
            made = step.repeats * step.scheme.repeats_each if isinstance(step, ConditionStep) else 1
            self.steps.append(step)
            self.estimated.append(seconds * max(1.0 - done / made, 0.0))
        if part.plan.steps:
            self._ends[id(part.plan.steps[-1])] = len(self.steps)
        self.steps.append(None)
        self.estimated.append(part.down_s)

    # -- looking at a run -------------------------------------------------------------------------------------

    def begin_part(self, plan: Plan) -> None:
        """Begin a part on its own rig, whose time starts at 0."""
        self._finish()
        self._part += 1
        self._now, self._step, self._doing = 0.0, 0, Doing.WORKING
        self._end = self._ends[id(plan.steps[-1])] if plan.steps else len(self.steps) - 1

    def look(self, now: float, run: Run) -> None:
        """Update the position from a run at a rig time."""
        executor = run.engine.executor
        self.update(now, run.engine.ctx.progress, executor.steps, doing(run), measuring=executor.measuring,
                    finished=executor.finished and not executor.failed)  # fmt: skip

    def update(
        self,
        now: float,
        progress: Progress,
        remaining: Sequence[Step],
        state: Doing,
        *,
        measuring: bool = False,
        finished: bool = False,
    ) -> None:
        """Update the position from the executor. ``remaining``: its later steps; ``finished``: whether no step is
        left.
        """
        if state is Doing.WORKING:
            self._worked_s += now - self._now
        self._now, self._doing = now, state
        if finished:
            self._move_to(self._end)
        elif progress.step != self._step:
            self._step = progress.step
            self._move_to(self._position(remaining))
        if measuring:
            self._look_at_repeats(progress)

    def _look_at_repeats(self, progress: Progress) -> None:
        """Update the progress of the present condition's repeats."""
        begun = progress.repeat != self._repeat
        if begun and self._contact_s is not None:
            self._repeats_s.append(self._worked_s - self._contact_s)
            self._contact_s = self._worked_s
        self._repeat = progress.repeat
        self._within = 0.0 if begun else share_of_repeat(progress)
        self._to_come = max(progress.repeats - progress.repeat, 0)
        if self._contact_s is None and progress.burst:
            self._contact_s = self._worked_s
        if begun:
            self._expect()

    def _position(self, remaining: Sequence[Step]) -> int:
        inserted = 0
        for step in remaining:
            if id(step) in self._places:
                break
            inserted += 1
        # If steps were inserted, the present step is the one that waits after them.
        return self._end - (len(remaining) - inserted) - (0 if inserted else 1)

    def _move_to(self, position: int) -> None:
        if position == self.position:
            return
        self._finish()
        for place in range(self.position + 1, position):
            self.measured[place] = 0.0  # it began and ended between two updates: its time counts with the step before
        self.position, self._open = position, True
        self._repeat, self._to_come, self._repeats_s = 0, 0, []
        self._fresh = self._is_fresh(position)
        self._expect()

    def _is_fresh(self, position: int) -> bool:
        """Return whether a step is the first condition on a specimen: its first repeat runs in, so its pace does not
        count.
        """
        here = self.steps[position]
        before = next((step for step in reversed(self.steps[:position]) if isinstance(step, ConditionStep)), None)
        return isinstance(here, ConditionStep) and (
            before is None or (before.specimen, before.replicate) != (here.specimen, here.replicate)
        )

    def _finish(self) -> None:
        """Record the present step's duration as a measurement of its kind."""
        if self._open:
            took_s = self._worked_s - self._began_s
            self.measured[self.position] = took_s
            kind = self._kinds[self.position]
            before_s, estimated_s = self._took.get(kind, (0.0, 0.0))
            self._took[kind] = before_s + took_s, estimated_s + self.estimated[self.position]
        self._began_s, self._open = self._worked_s, False
        self._contact_s = None

    # -- what is expected -------------------------------------------------------------------------------------

    def _expect(self) -> None:
        """Recompute the expected durations of all steps. The list changes only here, at an event."""
        here = self._kinds[self.position] if self._open else ""
        paces: list[float] = []
        for kind in self._sorts:
            took_s, estimated_s = self._took.get(kind, (0.0, 0.0))
            if kind == here:
                took_s += self._worked_s - self._began_s + self._present_s()
                estimated_s += self.estimated[self.position]
            paces.append((took_s + PRIOR_S) / (estimated_s + PRIOR_S))
        self.ahead = np.rint(self._estimated * np.array(paces)[self._sort])
        self._ahead_s = float(self.ahead[self.position + 1 :].sum())
        self.revision += 1

    def _present_s(self) -> float:
        """Return the time left in the present step, s: from its repeats once they show it, before that from its
        estimate.
        """
        if not self._open:
            return 0.0
        so_far_s = self._worked_s - self._began_s
        if self._contact_s is not None:
            since_s, shown = self._worked_s - self._contact_s, self._repeats_s[self._fresh :]
            if shown:
                each_s = fmean(shown)
                return max(each_s - since_s, OVERRUN * since_s) + each_s * self._to_come
            if not self._fresh and self._within >= SHOWN and since_s >= SHOWN_S:
                return since_s / self._within * (1.0 - self._within + self._to_come)
        took_s, estimated_s = self._took.get(self._kinds[self.position], (0.0, 0.0))
        expected_s = self.estimated[self.position] * (took_s + PRIOR_S) / (estimated_s + PRIOR_S)
        return max(expected_s - so_far_s, OVERRUN * so_far_s)

    def standing(self) -> RunPosition:
        """Return the present position of the run."""
        present_s = float(ceil(self._present_s()))
        left_s = present_s + self._ahead_s
        done_s = self._earlier.seconds + self._worked_s
        return RunPosition(
            step=self.position + 1,
            steps=len(self.steps),
            over=self._over[max(self.position + (0 if self._open else 1), 0)],
            conditions=self._conditions,
            share=done_s / (done_s + left_s) if done_s + left_s > 0.0 else 0.0,
            left_s=None if self._doing is Doing.GIVEN_UP else left_s,
            step_left_s=present_s,
            done_s=done_s,
            part=max(self._part, 1),
            parts=self._parts,
        )
