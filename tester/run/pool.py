"""Worker processes that can be stopped, and that report their progress.

A pool of ``concurrent.futures`` with two additions: a level that every worker can read (who wants a stop, StopLevel),
and a queue for the workers' reports. Processes are spawned, not forked, because spawning works alike on every system.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing.queues import SimpleQueue
from multiprocessing.sharedctypes import Synchronized
from threading import Thread
from typing import ParamSpec, TypeVar

from tester.base.processes import leave_to_parent, not_inherited
from tester.machine.run import Outcome
from tester.run.endings import EXIT_CODES, StopLevel

P = ParamSpec("P")
R = TypeVar("R")


class WorkerPool:
    """Up to ``jobs`` processes, for a ``with`` block, at whose end they are stopped."""

    def __init__(self, jobs: int) -> None:
        """Start no process yet: each starts with the first call that needs it."""
        context = multiprocessing.get_context("spawn")
        with not_inherited():  # the first of these also starts the tracker process for shared memory
            self._level: Synchronized[int] = context.Value("i", StopLevel.NONE)
            self._reports: SimpleQueue[object] = context.SimpleQueue()
        self._executor = ProcessPoolExecutor(jobs, context, _enlist, (self._level, self._reports))

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(self, *_: object) -> None:
        """Drop waiting calls; stop running ones and wait for them."""
        self.stop(StopLevel.FAST)
        self._executor.shutdown(cancel_futures=True)

    @property
    def executor(self) -> ProcessPoolExecutor:
        """The pool's ``concurrent.futures`` executor."""
        return self._executor

    def submit(self, work: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Run a call in a worker. The function must belong to a module, and its arguments must be plain data."""
        # A starting worker has no signal handlers yet: until then it inherits that signals are ignored.
        with not_inherited():
            return self._executor.submit(work, *args, **kwargs)

    def stop(self, level: StopLevel) -> None:
        """Ask every worker to stop."""
        self._level.value |= level

    def reports(self) -> Iterator[object]:
        """Yield the workers' reports since the last call."""
        while not self._reports.empty():
            yield self._reports.get()


@dataclass(slots=True)
class _Worker:
    """The worker's end of the pool's level and queue."""

    level: Synchronized[int]
    reports: SimpleQueue[object]
    own: StopLevel = StopLevel.NONE


_worker: _Worker | None = None


def stop_level() -> StopLevel:
    """Return who wants this worker to stop; NONE in a process without a pool."""
    if _worker is None:
        return StopLevel.NONE
    return _worker.own | StopLevel(_worker.level.value)


def say(report: object) -> None:
    """Put a report (plain data) into the pool's queue; without a pool, drop it."""
    if _worker is not None:
        _worker.reports.put(report)


def _enlist(level: Synchronized[int], reports: SimpleQueue[object]) -> None:
    """Make this process a worker. The parent handles interrupts and hang-ups; TERM stops the worker in a controlled
    way.
    """
    global _worker
    _worker = _Worker(level, reports)
    leave_to_parent()
    signal.signal(signal.SIGTERM, _on_term)
    Thread(target=_leave_with_parent, daemon=True).start()


def _on_term(_number: int, _frame: object) -> None:
    if _worker is not None:
        _worker.own = StopLevel.TERMINATED


def _leave_with_parent() -> None:
    """End this process when the parent has been killed: an orphaned worker would wait for ever. Committed data stay."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(EXIT_CODES[Outcome.STOPPED])
