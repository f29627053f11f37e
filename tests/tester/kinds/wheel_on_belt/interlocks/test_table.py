"""The interlock table: every row is complete, and declares the parameters of its condition."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from types import FunctionType

import pytest

from tester.base.config_reader import Range
from tester.inputs.rig.config import values_of
from tester.inputs.rig.key_classes import Bounded, Ceiling, class_of
from tester.inputs.rig.parameter import Direction, Parameter
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS, TABLE
from tester.machine.row import Interlock

OURS = ("tester.kinds.wheel_on_belt.interlocks", "tester.machine.wires", "tester.machine.drive_rows",
        "tester.machine.row", "tester.machine.watches")  # fmt: skip


def compared(condition: Callable[[Inputs], object], known: set[FunctionType] | None = None) -> set[Parameter]:
    """Return the parameters named by a condition and by our functions that it calls."""
    known = set() if known is None else known
    assert isinstance(condition, FunctionType)
    if condition in known:
        return set()
    known.add(condition)
    names = [condition.__globals__.get(name) for name in condition.__code__.co_names]
    names += [cell.cell_contents for cell in condition.__closure__ or ()]
    found = {one for one in names if isinstance(one, Parameter)}
    for one in names:
        if isinstance(one, FunctionType) and one.__module__.startswith(OURS):
            found |= compared(one, known)
    return found


INSIDE = {"rate_filter_s", "rate_window_s", "rate_settle_s", "blind_s", "ramp_share", "open_output_percent",
          "open_below_k", "runaway_window_s", "press_lag_s", "lifted_mm", "late_warn_s", "cell_skew_s",
          "heat_share", "heat_share_known", "heat_leak_w",
          "force_step_cross_share", "force_step_seen_share", "force_step_unseen_share"}  # fmt: skip
"""Parameters of rows whose monitor, driver or stop uses them and not the condition itself."""
SHARED = {"stale_can_s", "stale_can_scans", "stale_inputs_s", "speeds_old_s", "standing_m_s", "clear_mm", "lift_late_s"}
"""Parameters that ``known`` and earlier rows bring into a condition."""


@pytest.mark.parametrize("row", TABLE.rows, ids=lambda row: row.name)
def test_a_row_declares_the_parameters_of_its_condition(row: Interlock) -> None:
    used = {one.name for one in compared(row.watch.holds)}
    used |= {one.name for one in compared(row.applies)} if row.applies is not None else set()
    declared = {one.name for one in row.declared()} - {row.delay.name if row.delay is not None else ""}
    assert used - declared <= SHARED
    assert declared - used <= INSIDE


def test_names_of_rows_and_parameters_stand_for_one_thing() -> None:
    assert len({row.name for row in TABLE.rows}) == len(TABLE.rows)
    assert len({one.name for one in PARAMETERS}) == len({one.key for one in PARAMETERS}) == len(PARAMETERS)


@pytest.mark.parametrize("one", PARAMETERS, ids=lambda one: one.key)
def test_a_parameter_has_a_description(one: Parameter) -> None:
    assert one.text
    assert inside(one.bounds, one.value)


@pytest.mark.parametrize("one", [p for p in PARAMETERS if p.hardest], ids=lambda one: one.key)
def test_the_packaged_value_is_not_looser_than_the_hardest(one: Parameter) -> None:
    (bound,) = class_of(one)
    assert isinstance(bound, Bounded)
    ceiling = Ceiling(one.key, one.unit, bound)
    hardest = ceiling.limit
    assert one.because and inside(one.bounds, hardest)
    assert not ceiling.looser(one.value, hardest) and not ceiling.looser(hardest, hardest)
    assert ceiling.looser(math.nan, hardest)
    step = 1.0 if one.direction is Direction.LOWER else -1.0
    assert ceiling.looser(hardest + step * max(abs(hardest), 1e-3), hardest)


def inside(bounds: Range, value: float) -> bool:
    low = (bounds.gt is None or value > bounds.gt) and (bounds.ge is None or value >= bounds.ge)
    return low and (bounds.lt is None or value < bounds.lt) and (bounds.le is None or value <= bounds.le)


def test_a_rig_has_a_value_for_every_parameter() -> None:
    values = values_of(load_rig("sim", ["interlocks.pushed=0.25 mm"]).interlocks, PARAMETERS)
    assert {one.key: value for one, value in values.items() if value != one.value} == {"pushed": 0.25}


def test_a_copied_rig_finds_its_values_under_the_same_parameters() -> None:
    values = {one: one.value for one in PARAMETERS}
    assert copy.deepcopy(values) == values


def test_masks_and_names_go_by_the_place_in_the_table() -> None:
    assert TABLE.names_of(TABLE.bit("overload") | TABLE.bit("safety chain")) == ["safety chain", "overload"]
    assert TABLE.names_of(TABLE.at_rest) == ["heating at standstill", "contactor welded", "moving at rest"]
    assert TABLE.names_of(TABLE.warnings) == ["scan delayed"]
