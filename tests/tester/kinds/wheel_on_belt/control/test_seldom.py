"""Rows that are evaluated only after a change of what they read: whatever changes, each scan knows what holds."""

from __future__ import annotations

import random
from dataclasses import fields
from math import inf, nan
from typing import Any

from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.machine.inputs import ScanInputs
from tester.machine.interlock_table import RigTable
from tester.machine.row import SELDOM
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench

ROWS = [row for row in TABLE.rows if row.when is SELDOM]
OWN = ("seen", "seen_held")
"""Fields of the inputs that no row may read."""


def places(bench: Bench) -> list[tuple[Any, str]]:
    """Return every number, state and text that the inputs of the rows hold: the object and the field's name."""
    view = bench.control.view
    parts = [view, view.readings, view.demand, view.setpoints, view.stop, view.stop_start, view.contact, view.jacket,
             view.surface, view.heat, view.wheel, view.belt, view.press, view.free, view.force]  # fmt: skip
    return [
        (part, field.name)
        for part in parts
        for field in fields(part)
        if field.name not in OWN and isinstance(getattr(part, field.name), bool | int | float | str)
    ]


def other(value: object, random_numbers: random.Random) -> object:
    """Return another value of the same type, as a rig may bring it."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return "" if value else "faulty"
    number = float(value) if isinstance(value, int | float) else 0.0
    return random_numbers.choice([nan, inf, -inf, 0.0, 100.0, -100.0, number + 1.0, number - 1.0])


def test_a_row_that_is_seldom_evaluated_holds_in_every_scan_in_which_its_condition_does(bench: Bench) -> None:
    view, numbers = bench.control.view, random.Random(1)
    table = RigTable(TABLE, view.parameters)
    usual = [(part, name, getattr(part, name)) for part, name in places(bench)]
    held: set[str] = set()
    for _ in range(1500):
        for part, name, value in usual:  # among many faults no row depends on one value alone
            setattr(part, name, value)
        for _ in range(10):
            part, name, value = numbers.choice(usual)
            setattr(part, name, other(value, numbers))
            if numbers.random() < 0.1:
                view.hub_setpoints[:] = numbers.choice([[], [(0.0, 40.0)], [(0.0, 120.0)]])
            now = TABLE.names_of(table.held(view))
            expected = {row.name for row in ROWS if row.holds(view)}
            assert expected == {row.name for row in ROWS if row.name in now}
            held |= expected
    assert held == {row.name for row in ROWS}


def test_they_are_evaluated_again_only_after_a_change(bench: Bench) -> None:
    view, table = bench.control.view, RigTable(TABLE, bench.control.view.parameters)
    asked: list[object] = []
    table.after_change.states = ((lambda v: asked.append(v) is not None, None),)
    for hub_c, times in ((50.0, 0), (50.0, 0), (50.1, 1), (50.1, 1), (nan, 2)):
        view.readings.hub_c = hub_c
        view.readings.now_s += 0.01
        table.held(view)
        assert len(asked) == times


def test_inputs_that_do_not_say_what_they_hold_have_them_evaluated_in_every_scan(bench: Bench) -> None:
    view, table = bench.control.view, RigTable(TABLE, bench.control.view.parameters)
    asked: list[object] = []
    table.after_change.states = ((lambda v: asked.append(v) is not None, None),)
    view.__class__ = type("Unnamed", (type(view),), {"seldom": ScanInputs.seldom, "__slots__": ()})
    table.held(view)
    table.held(view)
    assert len(asked) == 2
