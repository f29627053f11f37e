"""A run's one status: the whole table of record, lock and results."""

from __future__ import annotations

from itertools import product

import pytest

from tester.machine.run import Outcome
from tester.store.status import RunStatus, run_status

R = RunStatus
TABLE = {
    # recorded: nobody holds it, every value there; a value missing; somebody holds it; held, a value missing
    "running": (R.INTERRUPTED, R.INTERRUPTED, R.RUNNING, R.RUNNING),
    "interrupted": (R.INTERRUPTED, R.INTERRUPTED, R.RUNNING, R.RUNNING),
    "done": (R.DONE, R.INCOMPLETE, R.DONE, R.INCOMPLETE),
    "stopped": (R.STOPPED, R.STOPPED, R.RUNNING, R.RUNNING),
    "tripped": (R.TRIPPED, R.TRIPPED, R.RUNNING, R.RUNNING),
    "failed": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
    "rig unreachable": (R.UNREACHABLE, R.UNREACHABLE, R.RUNNING, R.RUNNING),
    "a word of tomorrow": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
    "": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
}


@pytest.mark.parametrize("recorded", TABLE)
def test_the_status_over_all_states(recorded: str) -> None:
    found = [run_status(recorded, held=held, missing=missing) for held, missing in product((False, True), repeat=2)]
    assert tuple(found) == TABLE[recorded]


def test_every_outcome_of_a_run_is_in_the_table() -> None:
    assert {outcome.value for outcome in Outcome} <= TABLE.keys()
    assert {status for row in TABLE.values() for status in row} == set(RunStatus) - {R.UNREADABLE}


def test_what_may_go_on() -> None:
    assert {status for status in RunStatus if status.can_resume} == {
        R.INTERRUPTED, R.STOPPED, R.TRIPPED, R.FAILED, R.UNREACHABLE,
    }  # fmt: skip
    assert {status for status in RunStatus if status.over} == {R.DONE, R.INCOMPLETE}
