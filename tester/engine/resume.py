"""Put an executor that was just built where an interrupted run stands in the store."""

from __future__ import annotations

from tester.engine.executor import Executor
from tester.engine.results import StoredResults
from tester.store.resume import ResumePoint


def take_up(executor: Executor, results: StoredResults, point: ResumePoint) -> None:
    """Let an executor of the remaining plan know what is committed: repeats, wheels, the load cell's reference zero."""
    results.earlier = dict(point.conditions)
    results.pool = point.pool
    if point.reference_tare is not None:
        executor.reference_tare.extend(point.reference_tare)
    wheels = point.stand.wheels
    executor.wheels = max([executor.wheels, *(wheel.wheel for wheel in wheels)])
    # The wheel that is on has measured before, so that a condition it would not outlast gets a new one. A condition
    # that is half measured stays on its wheel, as in a run without an interruption.
    if wheels and wheels[-1].last_condition and point.next_repeat is None:
        executor.measured_wheel = wheels[-1].wheel
