"""Executors for the runs of a sweep: processes of this machine, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Generator
from concurrent.futures import Future
from contextlib import contextmanager
from importlib import import_module
from typing import Protocol, cast

from tester.base.plugins import needs
from tester.base.trouble import MisuseError, in_words
from tester.run.pool import WorkerPool
from tester.run.sweep.case import CaseResult, SweepTask


class NoClusterError(MisuseError):
    """The cluster is not usable; the message gives the reason."""


class Submit(Protocol):
    """Runs a task somewhere."""

    def __call__(self, work: Callable[[SweepTask], CaseResult], task: SweepTask, /) -> Future[CaseResult]:
        """Return the future of the task's result."""
        ...


class _Executor(Protocol):
    """The part of a ``concurrent.futures`` executor used here."""

    def submit(self, work: Callable[[SweepTask], CaseResult], task: SweepTask, /) -> Future[CaseResult]: ...


class _Client(Protocol):
    """The part of ``distributed.Client`` used here."""

    def get_executor(self, *, pure: bool, retries: int) -> _Executor: ...

    def close(self) -> None: ...


class _Distributed(Protocol):
    """The part of the module ``distributed`` used here: it has no types, and may not be installed."""

    def Client(self, address: str, *, set_as_default: bool) -> _Client: ...  # noqa: N802 - its name there


@contextmanager
def local(jobs: int) -> Generator[Submit]:
    """Use up to ``jobs`` processes of this machine; leaving the block ends the runs under way."""
    with WorkerPool(jobs) as pool:

        def submit(work: Callable[[SweepTask], CaseResult], task: SweepTask, /) -> Future[CaseResult]:
            return pool.submit(work, task)

        yield submit


@contextmanager
def dask(address: str) -> Generator[Submit]:
    """Use the cluster whose scheduler is at ``address``, e.g. ``tcp://host:8786``; its workers need this package.

    Leaving early drops waiting tasks; a task that a worker has begun runs there to its end. Raises NoClusterError.
    """
    try:
        distributed = cast("_Distributed", import_module("distributed"))
    except ImportError as error:
        raise NoClusterError(f"{needs(f'--dask {address}', 'Dask', 'cluster')} ({error})") from error
    try:
        client = distributed.Client(address, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NoClusterError(f"--dask {address}: no scheduler answers there: {in_words(error)}") from error
    try:
        # Not pure: equal tasks run again. No retries: a lost worker counts as a result.
        yield client.get_executor(pure=False, retries=0).submit
    finally:
        client.close()
