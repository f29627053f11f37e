"""Permitted age of drives' data after a late scan (decision 33): they answer each scan's SYNC, not the clock."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import pytest

from tester.machine.drive_rows import DRIVE_DATA_STALE
from tester.machine.row import Interlock
from tester.machine.wires import (
    CAN_SILENT,
    SILENT_CAN_HEARTBEATS,
    SILENT_CAN_SCANS,
    STALE_CAN_S,
    STALE_CAN_SCANS,
    drive_data_allowed_s,
)
from tests.tester.machine.toy import LampControl, LampDemand, LampReadings

PERIOD_S = 0.01
ANSWER_S = 0.002
"""From SYNC to a drive's answer."""
PARAMETERS = {one: one.value for one in (STALE_CAN_SCANS, STALE_CAN_S, SILENT_CAN_SCANS, SILENT_CAN_HEARTBEATS)}
SCANS = 20
LATE = 10
"""The scan that comes late."""
FAST = (PERIOD_S,) * SCANS


def view(**values: Any) -> Any:
    return SimpleNamespace(**{"parameters": PARAMETERS, "scan_s": PERIOD_S, "slower_before_s": 0.0} | values)


def tripped(
    row: Interlock, late_s: Sequence[float], lost: Collection[int] = (), periods_s: Sequence[float] = FAST
) -> list[int]:
    """Scan after the given periods, each that much later; lose the answers to some SYNCs. Return where a row trips."""
    control, readings, demand = LampControl(), LampReadings(safety_chain=True, guard_closed=True), LampDemand()
    assert control.start(readings) == ""
    syncs: list[float] = []
    heard_s = -ANSWER_S
    found: list[int] = []
    now_s = 0.0
    for number, (late, period_s) in enumerate(zip(late_s, periods_s, strict=True)):
        now_s += period_s + late
        for of, at_s in enumerate(syncs):
            if at_s + ANSWER_S <= now_s and of not in lost:
                heard_s = at_s + ANSWER_S
        readings.now_s = now_s
        control.step(demand, readings, period_s)
        stamps = lambda at_s=heard_s: (at_s,)  # noqa: E731
        shown = SimpleNamespace(now_s=now_s, drive_stamps_s=stamps, can_heard_s=heard_s, drives_enabled=True)
        looked_at = view(
            readings=shown, demand=SimpleNamespace(enabled=True), limits=SimpleNamespace(heartbeat_s=0.05),
            scan_s=period_s, slower_before_s=control.view.slower_before_s, last_s=control.view.last_s,
            late_s=control.view.late_s, late_before_s=control.view.late_before_s,
        )  # fmt: skip
        if row.holds(looked_at):
            found.append(number)
        syncs.append(now_s)
    return found


def late_by(seconds: float) -> list[float]:
    return [seconds if number == LATE else 0.0 for number in range(SCANS)]


@pytest.mark.parametrize("row", [DRIVE_DATA_STALE, CAN_SILENT], ids=["drive data", "silence"])
@pytest.mark.parametrize("late_s", [0.0, 0.015, 0.060, 0.100])
def test_a_late_scan_trips_nothing_where_every_answer_or_all_but_one_came(row: Interlock, late_s: float) -> None:
    assert tripped(row, late_by(late_s)) == []
    for lost in range(LATE - 2, LATE + 2):
        assert tripped(row, late_by(late_s), {lost}) == []


@pytest.mark.parametrize("row", [DRIVE_DATA_STALE, CAN_SILENT], ids=["drive data", "silence"])
@pytest.mark.parametrize("late_s", [0.0, 0.015, 0.060])
@pytest.mark.parametrize("first", range(LATE - 4, LATE + 3))
def test_two_answers_missing_in_a_row_trip_at_the_scan_that_misses_both(
    row: Interlock, late_s: float, first: int
) -> None:
    assert tripped(row, late_by(late_s), {first, first + 1}) == [first + 2]


@pytest.mark.parametrize("row", [DRIVE_DATA_STALE, CAN_SILENT], ids=["drive data", "silence"])
@pytest.mark.parametrize("late_s", [0.0, 0.004, 0.015])
@pytest.mark.parametrize("slow_s", [0.02, 0.05])
def test_the_first_fast_scans_after_slow_ones_bear_one_missing_answer_and_trip_on_two(
    row: Interlock, late_s: float, slow_s: float
) -> None:
    periods_s = [slow_s if number < LATE else PERIOD_S for number in range(SCANS)]
    for lost in range(LATE - 1, LATE + 2):
        assert tripped(row, late_by(late_s), {lost}, periods_s) == []
        assert tripped(row, late_by(late_s), {lost, lost + 1}, periods_s)[:1] == [lost + 2]


def test_the_allowance_is_the_lateness_of_this_scan_and_the_one_before() -> None:
    usual_s = PARAMETERS[STALE_CAN_SCANS] * PERIOD_S
    assert drive_data_allowed_s(view(late_s=0.0, late_before_s=0.0)) == pytest.approx(usual_s)
    assert drive_data_allowed_s(view(late_s=0.03, late_before_s=0.0)) == pytest.approx(usual_s + 0.03)
    assert drive_data_allowed_s(view(late_s=0.0, late_before_s=0.03)) == pytest.approx(usual_s + 0.03)
    assert drive_data_allowed_s(view(late_s=0.02, late_before_s=0.03)) == pytest.approx(usual_s + 0.05)


def test_a_scan_that_comes_early_takes_nothing_off() -> None:
    usual_s = PARAMETERS[STALE_CAN_SCANS] * PERIOD_S
    assert drive_data_allowed_s(view(late_s=-0.006, late_before_s=0.0)) == pytest.approx(usual_s)


@pytest.mark.parametrize("late_s", [0.2, 5.0, inf, nan])
def test_never_more_than_stale_can(late_s: float) -> None:
    assert drive_data_allowed_s(view(late_s=0.0, late_before_s=late_s)) == PARAMETERS[STALE_CAN_S]
    assert not drive_data_allowed_s(view(late_s=late_s, late_before_s=0.0)) > PARAMETERS[STALE_CAN_S]


def test_after_a_pause_longer_than_stale_can_drive_data_trip() -> None:
    assert tripped(DRIVE_DATA_STALE, late_by(0.16))[:1] == [LATE]


@pytest.mark.parametrize(("heard_s", "silent"), [(0.962, True), (0.972, False)])
def test_a_bus_without_an_answer_since_a_late_scan_is_silent_and_one_drive_without_is_not(
    heard_s: float, silent: bool
) -> None:
    readings = SimpleNamespace(
        now_s=1.0, can_heard_s=heard_s, drives_enabled=True, drive_stamps_s=lambda: (heard_s, 0.952)
    )
    late = view(
        readings=readings, demand=SimpleNamespace(enabled=True), limits=SimpleNamespace(heartbeat_s=0.05),
        last_s=0.97, late_s=0.02, late_before_s=0.0,
    )  # fmt: skip
    assert DRIVE_DATA_STALE.holds(late)
    assert CAN_SILENT.holds(late) is silent
