"""Merges the parts of a run into one record and one ending."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Generator
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from shutil import rmtree

from tester.base import clock
from tester.base.quantities import Quantities
from tester.base.trouble import in_words
from tester.inputs.rig.further_sensors import quantities_on
from tester.run.endings import PartEnd, RunEnding, StopLevel, ending_of
from tester.run.folder import PARTS, Begin, Job, Work
from tester.store.disk import sync_folder
from tester.store.merge import Merge
from tester.store.record_file import DATABASE
from tester.store.record_schema import NotBegunError, StoreError
from tester.store.writer import RunWriter

MERGED = "parts.merged"
"""Name of the parts' folder once the run's own record contains everything: the folder may be deleted."""


def put_together(
    job: Job,
    work: Work,
    begin: Begin,
    ends: Generator[PartEnd],
    wanted: Callable[[], StopLevel],
    tell: Callable[[PartEnd], None],
) -> RunEnding:
    """Merge the parts' records into the run's own, in the plan's order, as the parts end; return the run's ending.

    ``wanted`` returns who wants a stop; ``tell`` is called with every part's end. The parts' own records are deleted
    when all are merged.
    """
    ended: dict[int, PartEnd] = {}
    failed: str | None = None
    with closing(ends):
        try:
            _begin(job.folder, quantities_on(work.rig), begin)
            with Merge(job.folder) as merge:
                _merge(job, work, ends, ended, merge, tell)
                ending = ending_of(list(ended.values()), len(work.parts), wanted())
                merge.finish(ending.outcome.value, ending.reason, clock.utc_now())
            drop_parts(job.folder)
        except (sqlite3.Error, StoreError, OSError) as error:
            failed = in_words(error)
    ending = ending_of(list(ended.values()), len(work.parts), wanted())
    return replace(ending, failed=failed) if failed else ending


def recover(folder: Path) -> None:
    """Merge the recorded parts of an interrupted run; do nothing if there are none.

    Afterwards the run's own record contains everything, and the run can resume from it. Raises StoreError, OSError.
    """
    if (folder / PARTS).is_dir():
        records = sorted((folder / PARTS).glob(f"*/{DATABASE}"), key=lambda record: int(record.parent.name))
        try:
            with Merge(folder) as merge:
                for record in records:
                    with suppress(NotBegunError):  # interrupted at its beginning: it has no measurements
                        merge.add(record.parent)
        except sqlite3.Error as error:
            raise StoreError(f"the parts of {folder.name} cannot be put together: {error}") from error
    drop_parts(folder)


def drop_parts(folder: Path) -> None:
    """Delete the parts' records atomically: after a power cut a reader finds all of them or none."""
    if (folder / PARTS).is_dir():
        (folder / PARTS).rename(folder / MERGED)
        sync_folder(folder)
    if (folder / MERGED).is_dir():
        rmtree(folder / MERGED)


def _begin(folder: Path, quantities: Quantities, begin: Begin) -> None:
    """Record the planned work, so that the record of an interrupted run shows it."""
    record = folder / DATABASE
    with closing(RunWriter(record, quantities, clock=clock.monotonic, utc=clock.utc_now, synchronous=True)) as writer:
        begin(writer)


def _merge(
    job: Job,
    work: Work,
    ends: Generator[PartEnd],
    ended: dict[int, PartEnd],
    merge: Merge,
    tell: Callable[[PartEnd], None],
) -> None:
    """Merge each part once all parts before it are merged; at the end, merge the parts that follow one that never
    began.
    """
    folders = {part.number: work.folder_of(part, job.folder) for part in work.parts}
    for end in ends:
        ended[end.part] = end
        tell(end)
        while (following := min(folders, default=0)) in ended:
            merge.add(folders.pop(following))
    for number in sorted(folders.keys() & ended.keys()):
        merge.add(folders[number])
