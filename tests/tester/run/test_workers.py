"""Parts side by side: a part that ends early stops the others, a part whose process is lost has failed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path

import pytest

from tester.kinds.wheel_on_belt.run.runs import split
from tester.machine.context import Progress
from tester.machine.run import Outcome
from tester.machine.time_left import RunPosition
from tester.run import workers as crew
from tester.run.endings import PartEnd, StopLevel
from tester.run.folder import Job, Work
from tester.run.pool import say, stop_level
from tester.run.workers import Sight, longest_first, side_by_side
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import plan_of
from tests.tester.kinds.wheel_on_belt.run.test_runs import PREPARED, THREE, WORN

Result = PartEnd | BaseException | None


class Pool:
    """A pool whose workers have ended before the first check."""

    results: dict[int, Result]

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self.level = StopLevel.NONE
        self.said: list[object] = [Sight(1.5, Progress(), RunPosition(part=2, share=0.25)), "something else"]

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.level |= StopLevel.FAST

    def submit(self, work: object, job: Job, number: int) -> Future[PartEnd | None]:
        future: Future[PartEnd | None] = Future()
        result = self.results[number]
        if isinstance(result, BaseException):
            future.set_exception(result)
        else:
            future.set_result(result)
        return future

    def stop(self, level: StopLevel) -> None:
        self.level |= level

    def reports(self) -> Iterator[object]:
        yield from self.said
        self.said = []


class Carried:
    """Results of parts side by side."""

    def __init__(self, results: dict[int, Result]) -> None:
        Pool.results = results
        self.sights: list[Sight] = []
        self.pools: list[Pool] = []
        self.levels: list[StopLevel] = []
        plan = plan_of(THREE)
        work = Work(rig(), plan, split(plan))
        take: Callable[[object], None] = self.pools.append  # type: ignore[assignment]
        self.ends: list[PartEnd] = []
        for end in side_by_side(Job(Path("run")), work, 9, self.sights.append, take):
            self.ends.append(end)
            self.levels.append(self.pools[0].level)


@pytest.fixture
def carried(monkeypatch: pytest.MonkeyPatch) -> Callable[[dict[int, Result]], Carried]:
    monkeypatch.setattr(crew, "WorkerPool", Pool)
    return Carried


def ended(part: int, outcome: Outcome = Outcome.DONE) -> PartEnd:
    return PartEnd(part, outcome)


def test_parts_that_end_well_stop_no_other(carried: Callable[[dict[int, Result]], Carried]) -> None:
    found = carried({1: ended(1), 2: ended(2), 3: ended(3)})
    assert [end.part for end in found.ends] == [1, 2, 3] and found.levels == [StopLevel.NONE] * 3


def test_there_are_no_more_processes_than_parts(carried: Callable[[dict[int, Result]], Carried]) -> None:
    assert carried({1: ended(1), 2: ended(2), 3: ended(3)}).pools[0].jobs == 3


@pytest.mark.parametrize("outcome", [Outcome.TRIPPED, Outcome.STOPPED, Outcome.FAILED, Outcome.UNREACHABLE])
def test_a_part_that_ends_early_stops_the_others(
    carried: Callable[[dict[int, Result]], Carried], outcome: Outcome
) -> None:
    found = carried({1: ended(1, outcome), 2: None, 3: None})
    assert found.ends == [PartEnd(1, outcome)] and found.levels == [StopLevel.OTHER_PART]


def test_a_part_whose_process_is_lost_has_failed(carried: Callable[[dict[int, Result]], Carried]) -> None:
    found = carried({1: ended(1), 2: BrokenProcessPool(), 3: BrokenProcessPool()})
    assert [end.outcome for end in found.ends] == [Outcome.DONE, Outcome.FAILED, Outcome.FAILED]
    assert found.ends[1].reason == "its process ended unexpectedly"


def test_an_error_in_a_part_is_not_hidden(carried: Callable[[dict[int, Result]], Carried]) -> None:
    with pytest.raises(RuntimeError, match="no such wheel"):
        carried({1: ended(1), 2: RuntimeError("no such wheel"), 3: None})


def test_reports_of_workers_are_shown(carried: Callable[[dict[int, Result]], Carried]) -> None:
    (sight,) = carried({1: ended(1), 2: ended(2), 3: ended(3)}).sights
    assert (sight.now_s, sight.at.part, sight.at.share) == (1.5, 2, 0.25)


def test_a_process_that_is_no_worker_gets_and_sends_nothing() -> None:
    say("unheard")
    assert stop_level() is StopLevel.NONE


def test_the_longest_part_begins_first() -> None:
    brief, long = split(plan_of(PREPARED))[0], split(plan_of(WORN))[0]
    parts = (brief, replace(long, number=2), replace(brief, number=3))
    assert longest_first(Work(rig(), brief.plan, parts)) == [2, 1, 3]
