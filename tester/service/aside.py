"""Runs slow file work in a thread while the owner keeps serving clients and STOP."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Final, TypeVar

LOOK_S: Final = 0.02
"""Period at which the owner serves its clients, s, as between two ticks."""

Got = TypeVar("Got")


def aside(work: Callable[[], Got], look: Callable[[], object]) -> Got:
    """Run ``work`` in a thread and return its result; call ``look`` every ``LOOK_S`` until it is done.

    ``work`` is never interrupted: it may be writing. Raises what it raises.
    """
    with ThreadPoolExecutor(1, thread_name_prefix="aside") as thread:
        done = thread.submit(work)
        while not wait((done,), LOOK_S).done:
            look()
        return done.result()
