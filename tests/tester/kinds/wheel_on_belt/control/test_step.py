"""Modes, permissives and bounds of the control step."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press, Setpoints
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench


def settle(bench: Bench, *, lifted: bool = True, standing: bool = True) -> None:
    """Make the readings follow a stop."""
    r = bench.readings
    r.heat_percent = 0.0
    r.contactor_closed = False
    if lifted:
        r.force_z_n = r.force_x_n = 0.0
        r.press_mm = 0.0
    if standing:
        r.wheel_speed_m_s = r.belt_speed_m_s = r.slip_m_s = 0.0


def warm_hub(bench: Bench, hub_c: float) -> None:
    """Bring the hub to a temperature without a jump from reading to reading."""
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.hub_c = hub_c


def test_speeds_go_out_with_the_current_diameter(bench: Bench) -> None:
    bench.readings.diameter_mm = 88.0
    out = bench.scan()
    assert out.wheel_rad_s == pytest.approx(0.8 / 0.044)
    assert out.belt_m_s == 0.5


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e9])
def test_no_demand_gets_past_the_limits_or_out_as_nan(bench: Bench, value: float) -> None:
    bench.demand.wheel_speed_m_s = bench.demand.belt_speed_m_s = value
    bench.demand.positions = dict.fromkeys(bench.demand.positions, value)
    bench.demand.surface_c = value
    bench.readings.force_z_n = 0.0
    out: Setpoints = bench.scan()
    limits = bench.control.rig.limits
    assert abs(out.wheel_rad_s) <= limits.wheel_speed_m_s / 0.045 + 1e-9
    assert abs(out.belt_m_s) <= limits.belt_speed_m_s
    assert list(out.positions) == ["sideslip", "camber"]
    assert all(abs(out.positions[name]) <= most for name, most in limits.positions().items())
    assert out.hub_c <= limits.jacket_c


def test_angles_stay_where_they_are_under_load(bench: Bench) -> None:
    before = dict(bench.state.setpoints.positions)
    bench.demand.positions["sideslip"] = 20.0
    assert bench.scan().positions == before


@pytest.mark.parametrize(
    "field, value",
    [("wheel_speed_m_s", 0.0), ("belt_speed_m_s", 0.0), ("cell_valid", False), ("yaw_reached", False)],
)
def test_the_press_does_not_approach_unless_speeds_angles_and_data_are_confirmed(
    bench: Bench, field: str, value: object
) -> None:
    settle(bench, standing=False)
    bench.scan()
    bench.state.load.in_contact = False
    setattr(bench.readings, field, value)
    assert bench.scan().press_mm_s <= 0.0


def test_heat_needs_a_wheel_seen_turning(bench: Bench) -> None:
    assert bench.scan().heat
    bench.readings.wheel_speed_m_s = 0.0
    assert not bench.scan().heat


def test_heat_needs_a_fresh_surface_temperature(bench: Bench) -> None:
    bench.readings.surface_valid = False
    assert not bench.scan().heat


def test_a_stop_brings_the_slip_to_zero_before_the_speeds(bench: Bench) -> None:
    bench.control.request_stop(bench.readings.now_s, "test")
    out = bench.scan()
    assert out.belt_m_s == pytest.approx(0.8)
    assert not out.heat and not out.contactor and out.press_mm_s < 0.0
    settle(bench, standing=False)
    out = bench.scan()
    assert out.belt_m_s == 0.0 and out.wheel_rad_s == 0.0


def test_a_stop_without_a_trip_ends_idle_and_disabled(bench: Bench) -> None:
    warm_hub(bench, 30.0)
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    settle(bench)
    bench.scan()
    assert bench.state.mode is Mode.IDLE
    assert not bench.scan().enable


def test_a_hot_jacket_is_cooled_turning_before_idle(bench: Bench) -> None:
    warm_hub(bench, 65.0)
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    settle(bench)
    bench.scan()
    assert bench.state.mode is Mode.COOLDOWN
    out = bench.scan()
    bench.readings.wheel_speed_m_s = 0.095
    creeps_m_s = {round(bench.scan().wheel_rad_s * 0.045, 6) for _ in range(100)}
    most_m_s = bench.control.rig.interlocks.cooldown_speed_m_s
    assert sorted(creeps_m_s) == pytest.approx([0.9 * most_m_s, most_m_s])
    assert out.enable and out.creeps and not out.heat and not out.contactor
    warm_hub(bench, 50.0)
    bench.readings.wheel_speed_m_s = 0.0
    for _ in range(3):
        bench.scan()
    assert bench.state.mode is Mode.IDLE


def test_a_cool_down_that_runs_out_of_time_does_not_start_again(bench: Bench) -> None:
    warm_hub(bench, 65.0)
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    settle(bench)
    bench.scan()
    bench.readings.wheel_speed_m_s = 0.1
    bench.control.view.observer.due_s = math.inf  # the surface of this bench does not cool
    for _ in range(int(bench.control.rig.interlocks.cooldown_at_most_s / 0.15) + 1):
        bench.scan(0.15)
    bench.readings.wheel_speed_m_s = 0.0
    bench.scans(0.5)
    assert bench.state.mode is Mode.IDLE


def test_a_trip_latches_until_it_is_acknowledged_and_nothing_moves_after_that(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.scan()
    settle(bench)
    bench.scan()
    assert bench.state.mode is Mode.LATCHED
    bench.readings.guard_closed = True
    for _ in range(100):
        out = bench.scan()
        assert not out.enable and out.wheel_rad_s == 0.0 and out.belt_m_s == 0.0
    assert bench.control.start(bench.readings) != ""
    assert bench.control.request_ack(bench.readings.now_s) == ""
    out = bench.scan()
    assert bench.state.mode is Mode.IDLE
    assert not out.enable and out.press_mm_s == 0.0


def test_stop_requests_are_idempotent_and_never_slow_a_faster_stop(bench: Bench) -> None:
    now = bench.readings.now_s
    bench.control.request_stop(now, "first", fast=True)
    bench.control.request_stop(now, "second")
    assert bench.state.mode is Mode.FAST_STOP


def test_every_mode_change_is_an_event_of_its_scan(bench: Bench) -> None:
    bench.readings.guard_closed = False
    bench.scan()
    kinds = [event.kind for event in bench.journal]
    assert kinds == ["trip", "mode"]


def test_a_lifted_press_stops_at_its_clearance(bench: Bench) -> None:
    bench.demand.press = Press.LIFT
    loop = bench.state.load
    loop.contact_mm = 10.0
    bench.readings.force_z_n = 0.0
    bench.readings.slip_m_s = 0.0
    bench.readings.press_mm = 10.0 - bench.control.rig.loops.load.clearance_mm
    assert bench.scan().press_mm_s == pytest.approx(0.0, abs=1e-6)
