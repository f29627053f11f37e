"""A row: its condition, its trip's record and its sentence use one value and one limit."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isnan, nan

import pytest

from tester.inputs.rig.parameter import Parameter, Values
from tester.machine.row import FAST, Compared, Interlock, Watch
from tester.machine.watches import at_least, at_most, condition, within

MOST_N = Parameter("most_n", "N", "3 N", "no more than this")
OTHER = Parameter("other", "1", "2", "a row's other number")
DELAY = Parameter("wait_s", "s", "1 s", "for this long")


@dataclass
class Pull:
    """Inputs of the rows."""

    force_n: float = 0.0
    wanted: bool = True
    limit_n: float = 3.0
    parameters: Values = field(default_factory=lambda: {MOST_N: 3.0})


def _force_n(v: Pull) -> float:
    return v.force_n


BELOW_THREE = [
    at_most("force > {}", _force_n, MOST_N),
    at_most("force > {}", _force_n, "limit_n"),
    at_most("force > {}", _force_n, 3.0, "N"),
    at_most("force > limit", _force_n, lambda v: v.limit_n, "N"),
    within("force > limit", lambda v: (-inf, v.force_n, v.limit_n), "N"),
]


@pytest.mark.parametrize("watch", BELOW_THREE, ids=["parameter", "place", "constant", "function", "span"])
def test_a_number_trips_above_its_limit_wherever_the_limit_comes_from(watch: Watch[Pull]) -> None:
    assert [watch.holds(Pull(force_n)) for force_n in (-inf, 2.9, 3.0)] == [False] * 3
    assert [watch.holds(Pull(force_n)) for force_n in (3.1, inf, nan)] == [True] * 3
    assert watch.compared(Pull(3.1)) == Compared(3.1, 3.0, "N")


def test_the_sentence_names_the_limit() -> None:
    names = ["most", "limit", "3", "limit", "limit"]
    assert [watch.level for watch in BELOW_THREE] == [f"force > {name}" for name in names]


def test_a_number_trips_below_its_least() -> None:
    watch = at_least("force < {}", _force_n, MOST_N)
    assert [watch.holds(Pull(force_n)) for force_n in (2.9, 3.0, nan)] == [True, False, True]
    assert watch.compared(Pull(2.9)) == Compared(2.9, 3.0, "N")


def test_a_limit_that_is_not_known_trips() -> None:
    assert at_most("", _force_n, "limit_n").holds(Pull(0.0, limit_n=nan))


@pytest.mark.parametrize(("force_n", "limit_n"), [(-1.5, -1.0), (3.5, 3.0)])
def test_a_trip_between_two_limits_records_the_exceeded_one(force_n: float, limit_n: float) -> None:
    watch = within("", lambda v: (-1.0, v.force_n, v.limit_n), "N")
    assert watch.holds(Pull(force_n)) and not watch.holds(Pull(0.0))
    assert watch.compared(Pull(force_n)) == Compared(force_n, limit_n, "N")


def test_a_state_records_no_number() -> None:
    recorded = condition("not wanted", lambda v: not v.wanted).compared(Pull())
    assert isnan(recorded.value) and isnan(recorded.limit) and recorded.unit == ""


def test_a_row_holds_only_where_it_applies() -> None:
    row: Interlock[Pull] = Interlock(
        "row", "cause", at_most("", _force_n, MOST_N), FAST, "reset", applies=lambda v: v.wanted, unseen=True
    )
    assert row.holds(Pull(4.0)) and not row.holds(Pull(4.0, wanted=False))
    there = row.still_there()
    assert there is not None and there(Pull(4.0, wanted=False)) and not there(Pull(2.0))


def test_a_row_declares_its_limit_first_unless_it_places_it_itself() -> None:
    watch = at_most("", _force_n, MOST_N)
    first: Interlock[Pull] = Interlock("row", "cause", watch, FAST, "reset", parameters=(OTHER,), delay=DELAY)
    placed: Interlock[Pull] = Interlock("row", "cause", watch, FAST, "reset", parameters=(OTHER, MOST_N))
    assert first.declared() == (MOST_N, OTHER, DELAY) and placed.declared() == (OTHER, MOST_N)
