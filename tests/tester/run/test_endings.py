"""The end of a run from the ends of its parts."""

from __future__ import annotations

import pytest

from tester.machine.run import Outcome
from tester.run.endings import PartEnd, StopLevel, ending_of

DONE, STOPPED, FAILED, TRIPPED = Outcome.DONE, Outcome.STOPPED, Outcome.FAILED, Outcome.TRIPPED
UNREACHABLE = Outcome.UNREACHABLE


@pytest.mark.parametrize(
    ("outcomes", "worst"),
    [
        ((DONE, DONE), DONE),
        ((DONE, STOPPED), STOPPED),
        ((STOPPED, UNREACHABLE), UNREACHABLE),
        ((FAILED, UNREACHABLE), FAILED),
        ((STOPPED, TRIPPED, FAILED), TRIPPED),
    ],
)
def test_a_run_ends_as_the_worst_of_its_parts(outcomes: tuple[Outcome, ...], worst: Outcome) -> None:
    ends = [PartEnd(number, outcome) for number, outcome in enumerate(outcomes, start=1)]
    assert ending_of(ends, len(ends)).outcome is worst


def test_the_reason_is_that_of_the_first_of_the_worst_with_its_part() -> None:
    ends = [PartEnd(3, TRIPPED, "guard open"), PartEnd(2, TRIPPED, "overload"), PartEnd(1, STOPPED, "another part")]
    assert ending_of(ends, 3).reason == "part 2: overload"


def test_a_run_of_one_part_gives_its_reason_as_it_is() -> None:
    assert ending_of([PartEnd(1, TRIPPED, "guard open")], 1).reason == "guard open"


def test_a_run_with_a_part_that_was_not_begun_is_stopped() -> None:
    ending = ending_of([PartEnd(1, DONE)], 2, StopLevel.INTERRUPTED)
    assert (ending.outcome, ending.reason) == (STOPPED, "interrupted by the operator")


def test_a_run_without_a_begun_part_is_stopped() -> None:
    assert ending_of([], 2, StopLevel.TERMINATED).outcome is STOPPED


class StoppedRun:
    """A run that keeps its commands."""

    def __init__(self) -> None:
        self.said: list[tuple[str, bool, bool]] = []

    def request_stop(self, why: str, *, fast: bool = False, cool: bool = True) -> None:
        self.said.append((why, fast, cool))


@pytest.mark.parametrize(
    ("stop", "said"),
    [
        (StopLevel.INTERRUPTED, ("interrupted by the operator", False, True)),
        (StopLevel.TERMINATED, ("terminated", False, False)),
        (StopLevel.HUNG_UP, ("the terminal is gone", False, False)),
        (StopLevel.UNSEEN, ("the run can no longer be shown", False, True)),
        (StopLevel.INTERRUPTED | StopLevel.TERMINATED, ("interrupted by the operator", False, False)),
        (StopLevel.TERMINATED | StopLevel.FAST, ("interrupted by the operator", True, False)),
        (StopLevel.INTERRUPTED | StopLevel.FAST, ("interrupted by the operator", True, True)),
    ],
)
def test_the_strictest_stop_reaches_the_run(stop: StopLevel, said: tuple[str, bool, bool]) -> None:
    run = StoppedRun()
    stop.tell(run)  # type: ignore[arg-type]
    assert run.said == [said]


@pytest.mark.parametrize(
    ("outcome", "failed", "interrupted_once", "missing", "code"),
    [
        (DONE, None, False, False, 0),
        (DONE, None, False, True, 6),
        (DONE, "disk full", False, False, 1),
        (STOPPED, None, True, True, 130),
        (STOPPED, None, False, True, 5),
        (TRIPPED, None, True, True, 5),
        (FAILED, None, False, True, 1),
        (UNREACHABLE, None, False, True, 4),
    ],
)
def test_exit_codes(outcome: Outcome, failed: str | None, interrupted_once: bool, missing: bool, code: int) -> None:
    ending = ending_of([PartEnd(1, outcome, "", failed)], 1)
    assert ending.exit_code(interrupted_once=interrupted_once, missing=missing) == code
