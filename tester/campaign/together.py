"""The parts of a run put together: one record, one ending."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import replace
from shutil import rmtree

from tester import clock
from tester.campaign.endings import Ending, PartEnd, Stop, ending_of
from tester.campaign.folder import PARTS, Job, Work, begin_record
from tester.engine.run import Outcome
from tester.store.merge import Merge
from tester.store.reader import DATABASE
from tester.store.schema import StoreError
from tester.store.writer import RunWriter


def put_together(
    job: Job, work: Work, ends: Generator[PartEnd], wanted: Callable[[], Stop], tell: Callable[[PartEnd], None]
) -> Ending:
    """Merge the records of parts, as they end, into the run's own, in the plan's order; return the run's ending.

    ``wanted`` says who wants a stop, ``tell`` is told of every part's end. The parts' own records go when the whole is
    done; until then they stay, to be gone on with.
    """
    ended: dict[int, PartEnd] = {}
    failed: str | None = None
    with closing(ends):
        try:
            _begin(job, work)
            with Merge(job.folder) as merge:
                _merge(job, work, ends, ended, merge, tell)
                ending = ending_of(list(ended.values()), len(work.parts), wanted())
                merge.finish(ending.outcome.value, ending.reason, clock.utc_now())
        except (sqlite3.Error, StoreError, OSError) as error:
            failed = f"{type(error).__name__}: {error}"
    ending = ending_of(list(ended.values()), len(work.parts), wanted())
    if failed:
        return replace(ending, failed=failed)
    if ending.outcome is Outcome.DONE and not ending.failed:
        rmtree(job.folder / PARTS)
    return ending


def _begin(job: Job, work: Work) -> None:
    """Record what is going to be done: a run that is cut off shows what it was to be."""
    record = job.folder / DATABASE
    with closing(RunWriter(record, clock=clock.monotonic, utc=clock.utc_now, synchronous=True)) as writer:
        begin_record(writer, work, work.plan, job, job.folder.name)


def _merge(
    job: Job,
    work: Work,
    ends: Generator[PartEnd],
    ended: dict[int, PartEnd],
    merge: Merge,
    tell: Callable[[PartEnd], None],
) -> None:
    """Add every part as soon as those before it are in; then those behind one that was never begun."""
    folders = {part.number: work.folder_of(part, job.folder) for part in work.parts}
    for end in ends:
        ended[end.part] = end
        tell(end)
        while (following := min(folders)) in ended:
            merge.add(folders.pop(following))
            if not folders:
                return
    for number in sorted(folders.keys() & ended.keys()):
        merge.add(folders[number])
