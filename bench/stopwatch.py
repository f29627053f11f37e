"""The clocks of the measurements: a benchmark reads them inside a scan, the product has ``tester.base.clock``."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter_ns, process_time_ns

wall_ns = perf_counter_ns
"""Elapsed time in ns: for medians of microsecond spans, and for lateness."""

cpu_ns = process_time_ns
"""CPU time of this process, all its threads, in ns: for everything longer."""


def cpu_seconds_of(work: Callable[[], object]) -> float:
    """Return the CPU seconds that a call uses, in all threads."""
    begun = cpu_ns()
    work()
    return (cpu_ns() - begun) * 1e-9


def cpu_us_per(work: Callable[[int], object], count: int) -> float:
    """Return the CPU microseconds for one of ``count`` repetitions; ``work`` is called with the count."""
    begun = cpu_ns()
    work(count)
    return (cpu_ns() - begun) * 1e-3 / count
