"""Worker processes that can be told to stop, and that tell how far they are.

A pool of ``concurrent.futures`` with two things more: a level that every worker can read (who wants a stop, Stop), and
a queue in which workers put what they have to say. Processes are spawned, not forked: the same on every system.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from multiprocessing.queues import SimpleQueue
from multiprocessing.sharedctypes import Synchronized
from threading import Thread, current_thread, main_thread
from types import TracebackType
from typing import ParamSpec, TypeVar

from tester.base.processes import leave_to_parent, not_inherited
from tester.machine.run import Outcome
from tester.run.endings import EXIT_CODES, StopLevel

P = ParamSpec("P")
R = TypeVar("R")


class WorkerPool:
    """Up to ``jobs`` processes; use in a ``with`` block, whose end stops what runs."""

    def __init__(self, jobs: int) -> None:
        """Start nothing yet: a process starts with the first call that needs it."""
        context = multiprocessing.get_context("spawn")
        with _unheard():  # the first of these starts a process that looks after shared memory
            self._level: Synchronized[int] = context.Value("i", StopLevel.NONE)
            self._reports: SimpleQueue[object] = context.SimpleQueue()
        self._executor = ProcessPoolExecutor(jobs, context, _enlist, (self._level, self._reports))

    def __enter__(self) -> WorkerPool:
        """Return the pool."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Drop what waits; what still runs is told to stop, and waited for."""
        self.stop(StopLevel.FAST)
        self._executor.shutdown(cancel_futures=True)

    @property
    def executor(self) -> ProcessPoolExecutor:
        """The pool as ``concurrent.futures`` knows it."""
        return self._executor

    def submit(self, work: Callable[P, R], *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Have a call made in a worker: a function of a module, arguments that are plain data."""
        # A worker that is just starting has no handlers yet; it inherits that they are not for it.
        with _unheard():
            return self._executor.submit(work, *args, **kwargs)

    def stop(self, level: StopLevel) -> None:
        """Tell every worker that somebody wants a stop."""
        self._level.value |= level

    def reports(self) -> Iterator[object]:
        """Yield what workers have said since the last call."""
        while not self._reports.empty():
            yield self._reports.get()


def _unheard() -> AbstractContextManager[None]:
    """Start processes that do not hear Ctrl+C and a hang-up, where this thread has a say in signals."""
    return not_inherited() if current_thread() is main_thread() else nullcontext()


@dataclass(slots=True)
class _Worker:
    """The worker's end of a pool's lines."""

    level: Synchronized[int]
    reports: SimpleQueue[object]
    own: StopLevel = StopLevel.NONE


_worker: _Worker | None = None


def stop_level() -> StopLevel:
    """Return who wants this worker to stop; NONE where there is no pool."""
    if _worker is None:
        return StopLevel.NONE
    return _worker.own | StopLevel(_worker.level.value)


def say(report: object) -> None:
    """Put a report (plain data) into the pool's queue; without a pool it is not heard."""
    if _worker is not None:
        _worker.reports.put(report)


def _enlist(level: Synchronized[int], reports: SimpleQueue[object]) -> None:
    """Make this process a worker: interrupts and hang-ups are the parent's, TERM stops it in a controlled way."""
    global _worker
    _worker = _Worker(level, reports)
    leave_to_parent()
    signal.signal(signal.SIGTERM, _on_term)
    Thread(target=_leave_with_parent, daemon=True).start()


def _on_term(_number: int, _frame: object) -> None:
    if _worker is not None:
        _worker.own = StopLevel.TERMINATED


def _leave_with_parent() -> None:
    """End with a parent that was killed: a worker without one would wait for ever. What is committed stays."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(EXIT_CODES[Outcome.STOPPED])
