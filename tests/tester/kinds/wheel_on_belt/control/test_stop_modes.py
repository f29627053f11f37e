"""Stops that do not work: every action is verified, and an action that misses its time is escalated."""

from __future__ import annotations

import pytest

from tester.machine.row import Reaction
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench


def lift(bench: Bench) -> None:
    r = bench.readings
    r.force_z_n = r.force_x_n = r.press_mm = 0.0


def stand(bench: Bench) -> None:
    r = bench.readings
    r.wheel_speed_m_s = r.belt_speed_m_s = r.slip_m_s = 0.0


def cool(bench: Bench) -> None:
    bench.readings.heat_percent = 0.0
    bench.readings.contactor_closed = False


def stop(bench: Bench) -> None:
    bench.state.cooled = True
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()


def test_a_stop_that_does_not_lift_becomes_fast_and_then_takes_the_power_off(bench: Bench) -> None:
    stop(bench)
    stand(bench)
    cool(bench)
    bench.scans(1.2)
    assert bench.state.trip is not None and bench.state.trip.name == "not lifted"
    assert bench.state.mode is Mode.FAST_STOP and not bench.state.setpoints.power_off
    out = bench.scans(0.8)
    assert out.power_off
    lift(bench)
    bench.scans(0.1)
    assert bench.state.mode is Mode.LATCHED


def test_drives_that_do_not_stop_are_stopped_fast_and_then_lose_their_power(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    cool(bench)
    bench.scans(1.3)
    assert bench.state.mode is Mode.STOPPING
    bench.scans(0.3)
    assert bench.state.trip is not None and bench.state.trip.name == "not stopping"
    assert bench.state.mode is Mode.FAST_STOP
    out = bench.scans(0.8)
    assert out.power_off and bench.state.mode is Mode.FAST_STOP
    stand(bench)
    bench.scans(0.1)
    assert bench.state.mode is Mode.LATCHED


@pytest.mark.parametrize(("belt_m_s", "after_s"), [(0.8, 2.0), (1.1, 2.19), (1.3, 2.31)])
def test_a_drive_that_keeps_turning_loses_its_power_the_later_the_faster_it_turns(
    bench: Bench, belt_m_s: float, after_s: float
) -> None:
    r = bench.readings
    r.belt_speed_m_s, r.wheel_speed_m_s = belt_m_s, min(belt_m_s, 1.1)
    stop(bench)
    lift(bench)
    cool(bench)
    began_s = r.now_s - 0.01
    while not bench.state.setpoints.power_off:
        bench.scan()
        assert r.now_s - began_s < 2.5, "docs/kinds/wheel-on-belt.md: 1.5 s + v / ramp + v / quick stop"
    assert r.now_s - began_s == pytest.approx(after_s, abs=0.03)


def test_a_fast_stop_is_safe_or_escalated_within_three_seconds(bench: Bench) -> None:
    bench.control.request_stop(bench.readings.now_s, "test", fast=True)
    out = bench.scans(3.0)
    assert out.power_off and out.jacket_silent and not out.contactor and not out.heat


def test_heat_that_does_not_go_off_leaves_the_jackets_lease_to_run_out(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.readings.wheel_speed_m_s = 0.1
    bench.scans(1.2)
    assert bench.state.setpoints.jacket_silent
    assert any(text.startswith("heat not off") for text in bench.texts("trip") + bench.texts("alarm"))


def test_a_contactor_that_stays_closed_is_reported_and_latched(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.readings.heat_percent = 0.0
    bench.scans(0.4)
    assert bench.state.mode is Mode.STOPPING
    bench.scans(0.7)
    assert bench.state.mode is Mode.LATCHED
    assert bench.state.trip is not None and bench.state.trip.name == "contactor welded"


@pytest.mark.parametrize(("hub_c", "mode"), [(30.0, Mode.LATCHED), (65.0, Mode.COOLDOWN)])
def test_a_stop_under_power_ends_although_the_heat_is_not_known_to_be_off(
    bench: Bench, hub_c: float, mode: Mode
) -> None:
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.control.view.heat.forget()
    bench.readings.hub_c, bench.readings.heat_percent = hub_c, 0.0
    bench.scan()
    bench.stale.add("jacket_at_s")  # silent, and the contactor stays closed
    bench.readings.jacket_at_s -= 5.0
    bench.control.request_stop(bench.readings.now_s, "test")
    lift(bench)
    stand(bench)
    bench.scans(0.9)
    assert bench.state.mode is Mode.STOPPING
    out = bench.scans(0.2)
    assert bench.state.mode is mode and bench.state.trip is not None
    assert (out.enable, out.creeps) == (mode is Mode.COOLDOWN, mode is Mode.COOLDOWN)


def test_speeds_that_are_old_do_not_end_a_stop(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    cool(bench)
    bench.stale.update(("wheel_at_s", "belt_at_s"))
    bench.readings.wheel_at_s -= 1.0
    bench.scans(0.2)
    assert bench.state.mode is Mode.FAST_STOP


def test_a_retracted_press_counts_as_unloaded_whatever_a_dead_cell_shows(bench: Bench) -> None:
    bench.state.load.contact_mm = 10.0
    stop(bench)
    cool(bench)
    stand(bench)
    bench.readings.cell_valid = False
    bench.readings.press_mm = 8.0
    bench.scans(0.1)
    assert bench.state.mode in (Mode.LATCHED, Mode.IDLE)


def test_a_retracted_press_does_not_count_as_unloaded_against_a_live_cell(bench: Bench) -> None:
    bench.state.load.contact_mm = 13.0
    stop(bench)
    cool(bench)
    stand(bench)
    bench.readings.press_mm = 10.5
    bench.readings.force_z_n = 95.0
    bench.scans(0.9)
    assert bench.state.mode is Mode.STOPPING and bench.state.setpoints.press_mm_s < 0.0
    bench.scans(0.2)
    assert bench.state.trip is not None and bench.state.trip.name == "not lifted"


def test_a_stop_does_not_end_before_the_heat_is_seen_off(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.readings.heat_percent = 0.0
    bench.scans(0.3)
    assert bench.state.mode is Mode.STOPPING
    cool(bench)
    bench.scan()
    assert bench.state.mode is Mode.IDLE


def test_heat_that_stays_on_is_reported_before_the_stop_ends_and_stays_silent_until_acknowledged(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.scans(2.0)
    assert bench.state.mode is Mode.FAST_STOP and bench.state.setpoints.jacket_silent
    cool(bench)
    bench.scans(1.0)
    assert bench.state.mode is Mode.LATCHED and bench.state.setpoints.jacket_silent
    bench.control.request_ack(bench.readings.now_s)
    bench.scans(0.1)
    assert bench.state.mode is Mode.IDLE and not bench.state.setpoints.jacket_silent


def test_a_jacket_that_is_silent_does_not_keep_a_stop_from_ending_with_the_contactor_open(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.readings.contactor_closed = False
    bench.readings.jacket_valid = False
    bench.scans(0.9)
    assert bench.state.mode is Mode.STOPPING
    bench.scans(0.2)
    assert bench.state.mode is Mode.LATCHED


def test_after_a_controlled_trip_a_hot_jacket_is_cooled_turning_and_then_latched(bench: Bench) -> None:
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.hub_c = 65.0
    bench.readings.surface_valid = False
    bench.scans(0.5)
    assert bench.state.trip is not None and bench.state.trip.reaction is Reaction.CONTROLLED
    lift(bench)
    cool(bench)
    stand(bench)
    bench.scan()
    assert bench.state.mode is Mode.COOLDOWN
    bench.readings.wheel_speed_m_s = 0.1
    bench.scans(20.0)
    assert bench.state.mode is Mode.COOLDOWN and bench.state.setpoints.wheel_rad_s > 0.0
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.hub_c = 55.0
    bench.scan()
    stand(bench)
    bench.scans(0.1)
    assert bench.state.mode is Mode.LATCHED


def test_the_mirrored_emergency_stop_commands_nothing_and_latches(bench: Bench) -> None:
    bench.readings.safety_chain = False
    out = bench.scan()
    assert bench.state.mode is Mode.EMERGENCY
    assert (out.wheel_rad_s, out.belt_m_s, out.press_mm_s) == (0.0, 0.0, 0.0)
    assert not (out.enable or out.heat or out.contactor) and out.quick_stop
    lift(bench)
    stand(bench)
    cool(bench)
    bench.scans(0.1)
    assert bench.state.mode is Mode.LATCHED


# -- hold ---------------------------------------------------------------------------------------------------------


def hold(bench: Bench) -> None:
    assert bench.control.request_hold(bench.demand, bench.readings.now_s, "test") == ""


def test_a_hold_lifts_matches_the_speeds_and_keeps_the_heat(bench: Bench) -> None:
    bench.state.load.in_contact = True
    hold(bench)
    out = bench.scan()
    assert bench.state.mode is Mode.HOLD and out.press_mm_s < 0.0
    assert out.belt_m_s == pytest.approx(0.8) and out.wheel_rad_s == pytest.approx(0.8 / 0.045)
    assert out.heat and out.contactor and out.enable and not out.quick_stop


def test_a_hold_that_lasts_too_long_is_a_controlled_stop_without_a_trip(bench: Bench) -> None:
    hold(bench)
    lift(bench)
    bench.readings.belt_speed_m_s, bench.readings.slip_m_s = 0.8, 0.0
    bench.state.mode_since_s -= bench.control.rig.interlocks.hold_at_most_s
    bench.scans(0.05)
    assert bench.state.mode is Mode.STOPPING and bench.state.trip is None


def test_a_hold_that_does_not_lift_is_a_fast_stop_and_then_takes_the_power_off(bench: Bench) -> None:
    hold(bench)
    bench.readings.belt_speed_m_s, bench.readings.slip_m_s = 0.8, 0.0
    bench.scans(0.9)
    assert bench.state.mode is Mode.HOLD
    bench.scans(0.2)
    assert bench.state.mode is Mode.FAST_STOP
    assert bench.state.trip is not None and bench.state.trip.name == "not lifted"
    assert bench.scans(2.0).power_off


@pytest.mark.parametrize("again", [1, 3])
def test_stops_in_a_hold_and_twice_are_one_stop(bench: Bench, again: int) -> None:
    hold(bench)
    for _ in range(again):
        bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    assert [text for text in bench.texts("mode") if text.startswith("hold ->")] == ["hold -> stopping: test"]


def test_no_hold_and_no_release_out_of_a_stop(bench: Bench) -> None:
    stop(bench)
    assert "stopping" in bench.control.request_hold(bench.demand, bench.readings.now_s, "test")
    assert "stopping" in bench.control.request_release(bench.readings.now_s, "test")
    assert bench.state.mode is Mode.STOPPING


def test_a_stop_that_cannot_end_takes_the_power_off_and_latches(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    cool(bench)
    bench.readings.press_mm = 9.0  # it never gets back to the lifted position
    bench.scans(1.8)
    assert bench.state.mode is Mode.STOPPING and bench.state.trip is None
    out = bench.scans(1.2)
    assert out.power_off and bench.state.trip is not None and bench.state.trip.name == "lift failed"
    assert bench.scans(0.1).power_off and bench.state.mode is Mode.LATCHED


def test_a_fast_stop_that_cannot_end_reports_it_and_latches(bench: Bench) -> None:
    bench.control.request_stop(bench.readings.now_s, "test", fast=True)
    stand(bench)
    lift(bench)
    bench.scans(10.2)
    assert bench.state.mode is Mode.LATCHED and bench.state.trip is not None


def test_a_stop_with_a_hot_hub_that_cannot_end_does_not_creep(bench: Bench) -> None:
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.readings.hub_c = 110.0
    bench.control.request_stop(bench.readings.now_s, "test")
    stand(bench)
    cool(bench)
    bench.readings.force_z_n, bench.readings.press_mm = 18.0, 11.0
    bench.scans(12.0)
    assert bench.state.mode is not Mode.COOLDOWN and bench.state.setpoints.wheel_rad_s == 0.0


def test_an_output_that_stays_on_trips_although_the_contactor_is_open(bench: Bench) -> None:
    stop(bench)
    lift(bench)
    stand(bench)
    bench.readings.contactor_closed = False
    bench.scans(1.2)
    assert bench.state.trip is not None and bench.state.trip.name == "output not off"
    assert bench.state.setpoints.jacket_silent and bench.state.mode is Mode.LATCHED
