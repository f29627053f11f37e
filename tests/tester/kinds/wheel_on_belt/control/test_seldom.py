"""Rows evaluated only after a change of their inputs: after any change, each scan has their present state."""

from __future__ import annotations

import random
from math import nan

from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.machine.inputs import ScanInputs
from tester.machine.interlock_table import RigTable
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench
from tests.tester.machine.seldom import expect_every_scan


def test_a_row_that_is_seldom_evaluated_holds_in_every_scan_in_which_its_condition_does(bench: Bench) -> None:
    view = bench.control.view

    def change_setpoints(numbers: random.Random) -> None:
        if numbers.random() < 0.1:
            view.hub_setpoints[:] = numbers.choice([[], [(0.0, 40.0)], [(0.0, 120.0)]])

    parts = [view, view.readings, view.demand, view.setpoints, view.stop, view.stop_start, view.contact, view.jacket,
             view.surface, view.heat, view.wheel, view.belt, view.press, view.free, view.force]  # fmt: skip
    expect_every_scan(TABLE, view, parts, change_setpoints)


def test_they_are_evaluated_again_only_after_a_change(bench: Bench) -> None:
    view, table = bench.control.view, RigTable(TABLE, bench.control.view.parameters)
    asked: list[object] = []
    table.after_change.any_holds = lambda v: asked.append(v) is not None
    for hub_c, times in ((50.0, 0), (50.0, 0), (50.1, 1), (50.1, 1), (nan, 2)):
        view.readings.hub_c = hub_c
        view.readings.now_s += 0.01
        table.held(view)
        assert len(asked) == times


def test_no_wanted_temperature_is_no_change(bench: Bench) -> None:
    view, table = bench.control.view, RigTable(TABLE, bench.control.view.parameters)
    asked: list[object] = []
    table.after_change.any_holds = lambda v: asked.append(v) is not None
    for text, times in (("41", 1), ("nan", 2), ("nan", 2), ("nan", 2), ("41", 3)):
        view.demand.surface_c = float(text)  # a new object each time, as steps make it
        table.held(view)
        assert len(asked) == times


def test_inputs_that_do_not_declare_their_fields_are_evaluated_in_every_scan(bench: Bench) -> None:
    view, table = bench.control.view, RigTable(TABLE, bench.control.view.parameters)
    asked: list[object] = []
    table.after_change.any_holds = lambda v: asked.append(v) is not None
    view.__class__ = type("Unnamed", (type(view),), {"seldom": ScanInputs.seldom, "__slots__": ()})
    table.held(view)
    table.held(view)
    assert len(asked) == 2
