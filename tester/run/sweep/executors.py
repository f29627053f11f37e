"""Executors for the runs of a sweep: processes of this machine, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Generator
from concurrent.futures import Future
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TypeAlias

from tester.base.plugins import needs
from tester.base.trouble import MisuseError, in_words
from tester.run.pool import WorkerPool
from tester.run.sweep.case import CaseResult, SweepTask


class NoClusterError(MisuseError):
    """The cluster is not usable; the message gives the reason."""


Submit: TypeAlias = Callable[[Callable[[SweepTask], CaseResult], SweepTask], Future[CaseResult]]
"""Runs a task somewhere, and returns the future of its result."""


@contextmanager
def local(jobs: int) -> Generator[Submit]:
    """Use up to ``jobs`` processes of this machine; leaving the block ends the runs under way."""
    with WorkerPool(jobs) as pool:
        yield lambda work, task: pool.submit(work, task)


@contextmanager
def dask(address: str) -> Generator[Submit]:
    """Use the cluster whose scheduler is at ``address``, e.g. ``tcp://host:8786``; its workers need this package.

    Leaving early drops waiting tasks; a task that a worker has begun runs there to its end. Raises NoClusterError.
    """
    try:
        distributed: Any = import_module("distributed")  # it has no types, and may not be installed
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
