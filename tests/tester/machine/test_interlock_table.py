"""The engine of an interlock table, whatever the rows look at."""

from __future__ import annotations

import copy
from dataclasses import replace
from math import inf, nan
from typing import Any

import pytest

from tester.inputs.rig.parameter import Parameter
from tester.machine.inputs import ScanInputs
from tester.machine.interlock_table import Group, InterlockTable, RigTable, parameters_of
from tester.machine.row import ENDING, FAST, LOADED, SELDOM, WARN, Interlock, always
from tester.machine.watches import at_most, condition

DELAY = Parameter("toy_delay_s", "s", "30 ms", "for this long")
LEVEL = Parameter("toy_level_n", "N", "3 N", "more than this")
OPERATION = Parameter("toy_hold_s", "s", "3 s", "no row's")


def never(_: Any) -> bool:
    return False


NEVER = condition("never", never)
ROW: Interlock[ScanInputs] = Interlock(
    "always", "a toy", condition("always", always), FAST, "by itself", parameters=(LEVEL,), delay=DELAY
)
LATE: Interlock[ScanInputs] = Interlock("late", "a toy", at_most("late", lambda v: v.late_s, LEVEL), FAST, "by itself")
TABLE = InterlockTable(
    [
        ROW,
        replace(ROW, name="loaded", when=LOADED, unseen=True),
        replace(ROW, name="ending", when=ENDING, at_rest=always),
        replace(ROW, name="never", watch=NEVER, unseen=never),
        replace(ROW, name="warning", reaction=WARN),
        replace(ROW, name="seldom", when=SELDOM),
    ],
    [OPERATION],
)
VALUES = {LEVEL: 3.0, DELAY: 0.03}
ROWS = RigTable(TABLE, VALUES)
GROUPS = (ROWS.always, ROWS.after_change, ROWS.while_loaded, ROWS.while_ending)


def scan(**what: object) -> ScanInputs:
    """Return a scan of a run in contact, in which nothing ends."""
    inputs = ScanInputs(resting=False)
    inputs.parameters = VALUES
    for name, value in what.items():
        setattr(inputs, name, value)
    return inputs


@pytest.mark.parametrize(
    ("inputs", "names"),
    [
        (scan(), ["always", "loaded", "warning", "seldom"]),
        (scan(loaded=False), ["always", "warning", "seldom"]),
        (scan(unpowered=True), ["always", "ending", "warning", "seldom"]),
        (scan(loaded=False, lifting_s=0.0), ["always", "ending", "warning", "seldom"]),
        (scan(loaded=False, resting=True), ["always", "ending", "warning", "seldom"]),
    ],
    ids=["in contact", "lifted", "without power", "lifting", "at rest"],
)
def test_a_row_is_evaluated_in_the_scans_in_which_it_can_apply(inputs: ScanInputs, names: list[str]) -> None:
    assert TABLE.names_of(ROWS.held(inputs)) == names


def test_a_cause_that_is_only_watched_while_something_is_wanted_is_asked_for_by_itself() -> None:
    assert TABLE.names_of(TABLE.still_there(scan(loaded=False))) == ["loaded"]


def test_masks_follow_the_attributes_of_rows() -> None:
    assert TABLE.names_of(TABLE.at_rest) == ["ending"] and TABLE.names_of(TABLE.warnings) == ["warning"]


def test_a_bit_is_a_rows_place() -> None:
    assert [TABLE.bit(row.name) for row in TABLE.rows] == [1, 2, 4, 8, 16, 32]
    with pytest.raises(KeyError):
        TABLE.bit("no such row")


def test_parameters_stand_once_and_those_of_no_row_come_last() -> None:
    assert parameters_of(TABLE.rows) == (LEVEL, DELAY) and TABLE.parameters == (LEVEL, DELAY, OPERATION)


def test_a_row_is_timed_by_its_delay() -> None:
    assert ROW.delay_s({DELAY: 0.5}) == 0.5 and ROW.declared() == (LEVEL, DELAY)
    assert TABLE.delays_s({DELAY: 0.5}) == (0.5,) * 6 and TABLE.nothing_pending() == [inf] * 6


def test_a_group_returns_every_active_condition() -> None:
    rows = [replace(ROW, watch=NEVER), ROW, replace(ROW, applies=never), LATE, replace(LATE, applies=never)]
    group = Group(((1 << i, row) for i, row in enumerate(rows)), VALUES)
    assert group.held(scan(late_s=4.0)) == 0b1010 and group.held(scan(late_s=3.0)) == 0b0010


def test_a_number_that_is_not_known_is_beyond_its_limit() -> None:
    assert [Group([(1, LATE)], VALUES).held(scan(late_s=late_s)) for late_s in (-inf, 3.0, 3.1, nan)] == [0, 0, 1, 1]


def test_every_row_is_in_exactly_one_group() -> None:
    bits = [one for group in GROUPS for one, _ in group.members]
    assert sorted(bits) == [1 << i for i in range(len(TABLE.rows))]


def test_copies_of_a_machine_share_its_table() -> None:
    assert copy.deepcopy([TABLE])[0] is TABLE and copy.deepcopy([ROWS])[0] is ROWS
