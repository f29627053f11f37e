"""What reads or writes many files goes on beside the owner's loop: clients are heard meanwhile, STOP first."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Final, TypeVar

LOOK_S: Final = 0.02
"""The owner looks after its clients this often, s, as between two ticks."""

Got = TypeVar("Got")


def aside(work: Callable[[], Got], look: Callable[[], object]) -> Got:
    """Return what ``work`` returns, done by a thread; ``look`` is called every ``LOOK_S`` until it is done.

    ``work`` is never broken off: it may be writing. Raises what it raises.
    """
    with ThreadPoolExecutor(1, thread_name_prefix="aside") as thread:
        done = thread.submit(work)
        while not wait((done,), LOOK_S).done:
            look()
        return done.result()
