"""Recorded scans, and the contents of a row."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press, Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.machine.sampler import IDLE_PERIOD_S, Sampler, values_at
from tests.tester.kinds.wheel_on_belt.bench import Bench, make_bench


@pytest.fixture
def bench() -> Bench:
    return make_bench()


def record(bench: Bench, seconds: float, period_s: float = 0.01) -> int:
    """Offer scans for a while and return how many were taken."""
    sampler = Sampler(bench.notes, QUANTITIES)
    before = len(bench.notes.rows)
    for _ in range(round(seconds / period_s)):
        bench.ctx.now += period_s
        sampler.record(bench.ctx, Setpoints())
    return len(bench.notes.rows) - before


def test_out_of_contact_two_scans_a_second_are_recorded(bench: Bench) -> None:
    assert record(bench, 10.0) in (20, 21)


def test_every_scan_is_recorded_while_there_is_force(bench: Bench) -> None:
    bench.ctx.readings.force_z_n = 6.0
    assert record(bench, 1.0) == 100


def test_every_scan_is_recorded_while_a_load_is_wanted(bench: Bench) -> None:
    bench.ctx.demand.press = Press.LOAD
    assert record(bench, 1.0) == 100


def test_the_first_scan_is_recorded(bench: Bench) -> None:
    assert record(bench, 0.01) == 1


def test_an_unknown_force_out_of_contact_does_not_flood_the_store(bench: Bench) -> None:
    bench.ctx.readings.force_z_n = float("nan")
    assert record(bench, 10.0 * IDLE_PERIOD_S) <= 11


def test_a_row_has_a_value_for_every_column_in_their_order(bench: Bench) -> None:
    ctx = bench.ctx
    ctx.now, ctx.gate, ctx.burst, ctx.repeat_key = 12.5, 8, 2, 7
    ctx.readings.force_x_n, ctx.readings.wheel_angle_rev, ctx.demand.load_n = 140.0, 33.25, 200.0
    Sampler(bench.notes, QUANTITIES).record(ctx, Setpoints(hub_c=61.0))
    row = dict(zip(QUANTITIES.names, bench.notes.rows[-1], strict=True))
    assert (row["time_s"], row["force_x_n"], row["load_setpoint_n"]) == (12.5, 140.0, 200.0)
    assert (row["hub_setpoint_c"], row["wheel_angle_rev"]) == (61.0, 33.25)
    assert (row["gate"], row["burst"], row["repeat_key"]) == (8.0, 2.0, 7.0)


def test_a_row_is_all_floats(bench: Bench) -> None:
    Sampler(bench.notes, QUANTITIES).record(bench.ctx, Setpoints())
    assert {type(value) for value in bench.notes.rows[-1]} == {float}


def test_the_last_row_is_available_for_counting(bench: Bench) -> None:
    Sampler(bench.notes, QUANTITIES).record(bench.ctx, Setpoints())
    assert bench.ctx.sample is bench.notes.rows[-1]


def test_values_are_taken_in_the_order_of_their_sources_wherever_they_are(bench: Bench) -> None:
    bench.ctx.readings.positions = {"sideslip": 3.0, "camber": 4.0}
    bench.ctx.demand.load_n = 5.0
    tilt, turn = "readings.positions[camber]", "readings.positions[sideslip]"
    sources = [tilt, turn, "demand.load_n", tilt]
    assert values_at(sources)(bench.ctx) == (4.0, 3.0, 5.0, 4.0)
