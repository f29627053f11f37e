"""Runs parts side by side, each in a worker process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from tester.machine.context import Progress
from tester.machine.prompts import Prompts
from tester.machine.run import Outcome, Run
from tester.machine.time_left import RunPosition, TimeLeft
from tester.run.endings import PartEnd, StopLevel
from tester.run.folder import Job, Work, beginning_of, part_time, read_work
from tester.run.kind_lookup import recipe_part
from tester.run.part_run import PartWatch, run_part
from tester.run.pool import WorkerPool, say, stop_level

POLL_S = 0.1
"""Period at which the parent process reads reports, s of wall time."""


class Sight(NamedTuple):
    """A part's progress: its rig time in s, its activity, and its position among its own steps."""

    now_s: float
    progress: Progress
    at: RunPosition


def side_by_side(
    job: Job, work: Work, jobs: int, show: Callable[[Sight], None], pool_made: Callable[[WorkerPool], None]
) -> Iterator[PartEnd]:
    """Run the parts in up to ``jobs`` processes; yield their ends as they arrive.

    If a part fails, the others are stopped in a controlled way; parts that have not begun by then yield nothing.
    ``pool_made`` is called with the pool, through which a stop can be ordered.
    """
    with WorkerPool(min(jobs, len(work.parts))) as pool:
        pool_made(pool)
        running = {pool.submit(run_in_worker, job, number): number for number in longest_first(work)}
        while running:
            done, _ = wait(running, timeout=POLL_S, return_when=FIRST_COMPLETED)
            for sight in pool.reports():
                if isinstance(sight, Sight):
                    show(sight)
            for future in sorted(done, key=running.__getitem__):
                end = _end_of(future, running.pop(future))
                if end is None:
                    continue
                if end.outcome is not Outcome.DONE:
                    pool.stop(StopLevel.OTHER_PART)
                yield end


def longest_first(work: Work) -> list[int]:
    """Return the numbers of a run's parts, longest expected first, so that the longest is not left for the end."""
    expected_s = {part.number: recipe_part(work.rig).estimate(part.plan, work.rig).rig_seconds for part in work.parts}
    return sorted(expected_s, key=lambda number: (-expected_s[number], number))


def _end_of(future: Future[PartEnd | None], part: int) -> PartEnd | None:
    try:
        return future.result()
    except BrokenProcessPool:
        return PartEnd(part, Outcome.FAILED, "its process ended unexpectedly")


def run_in_worker(job: Job, number: int) -> PartEnd | None:
    """Run a part in this process, answering prompts with yes; return None if a stop came before it began."""
    if stop_level():
        return None
    work = _work_of(job)
    part = work.parts[number - 1]
    watch = _Reporting(number, len(work.parts), TimeLeft([part_time(work.rig, part.plan)]))
    return run_part(job, work, part, beginning_of(part, job, work), watch, Prompts(automatic=True))


@lru_cache(maxsize=1)
def _work_of(job: Job) -> Work:
    return read_work(job.folder)


class _Reporting(PartWatch):
    """A watch that reports the part's progress to the parent, and stops the part when the parent asks."""

    def __init__(self, part: int, parts: int, track: TimeLeft) -> None:
        super().__init__(track)
        self.part, self.parts = part, parts
        self._level = StopLevel.NONE

    def begun(self, run: Run) -> None:
        """Apply a stop that arrived in the meantime."""
        self._obey(run)

    def poll(self, now_s: float, run: Run) -> None:
        """Report progress, and apply a stop."""
        at = replace(self.track.standing(), part=self.part, parts=self.parts, beside=True)
        say(Sight(now_s, run.engine.ctx.progress, at))
        self._obey(run)

    def _obey(self, run: Run) -> None:
        level = stop_level()
        if level != self._level:
            self._level = level
            level.tell(run)
