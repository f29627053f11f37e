"""Commands of the control, and the inputs of each row: an unknown input trips."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import pytest

from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs, WayMonitor
from tester.kinds.specimen_on_track.interlocks.table import TABLE
from tester.machine.interlock_table import RigTable
from tester.machine.state import Mode
from tests.tester.kinds.specimen_on_track.bench import TrackBench
from tests.tester.machine.seldom import expect_every_scan


@pytest.fixture
def sliding() -> TrackBench:
    """A block that slides at 0.1 mm/s, stationary."""
    bench = TrackBench("grosch").phase("slide")
    return bench.until(lambda one: one.run.engine.ctx.gate == 0, bench.now + 120.0)


def held(bench: TrackBench) -> list[str]:
    """Return the names of the rows that hold now."""
    view = bench.run.engine.control.view
    return TABLE.names_of(RigTable(TABLE, view.parameters).held(view))


def test_no_row_holds_while_it_slides(sliding: TrackBench) -> None:
    assert held(sliding) == []


def test_a_row_that_is_seldom_evaluated_holds_in_every_scan_in_which_its_condition_does(sliding: TrackBench) -> None:
    view: TrackInputs = sliding.run.engine.control.view
    expect_every_scan(TABLE, view, [view, view.readings, view.demand, view.setpoints])


def unknown(name: str, value: object = nan) -> Callable[[TrackInputs], None]:
    """Return a change that makes a reading unknown."""
    return lambda v: setattr(v.readings, name, value)


@pytest.mark.parametrize(
    ("row", "spoil"),
    [
        ("safety chain", unknown("safety_chain", value=False)),
        ("guard open", unknown("guard_closed", value=False)),
        ("drive data stale", unknown("track_at_s", -inf)),
        ("drive data stale", unknown("lift_at_s", nan)),
        ("inputs stale", unknown("inputs_at_s", -inf)),
        ("drive dropped out", unknown("drives_enabled", value=False)),
        ("overspeed", unknown("track_now_m_s")),
        ("end of travel", unknown("track_mm")),
        ("track speed", lambda v: setattr(v.track, "off_m", nan)),
        ("load cell silent", unknown("cell_at_s", -inf)),
        ("load cell silent", unknown("cell_silent", value=True)),
        ("load cell saturated", unknown("cell_valid", value=False)),
        ("load cell frozen", unknown("cell_changed_s", -inf)),
        ("overload", unknown("force_n")),
        ("friction beyond load", unknown("force_n")),
        ("contact lost", lambda v: (setattr(v.demand, "sliding_m", 1.0), setattr(v.readings, "friction_n", nan))),
        ("air silent", unknown("air_at_s", -inf)),
        ("air sensor broken", unknown("air_c")),
        ("chamber beyond its range", unknown("air_c")),
        ("chamber runaway", unknown("air_c")),
        ("line noisy", unknown("line_errors")),
        ("device refused", unknown("device_fault", "load cell refuses")),
    ],
)
def test_a_row_holds_where_its_input_is_unknown(
    sliding: TrackBench, row: str, spoil: Callable[[TrackInputs], None]
) -> None:
    view: TrackInputs = sliding.run.engine.control.view
    view.arrived_c = 23.0
    spoil(view)
    assert row in held(sliding)


def test_the_arm_between_its_ends_holds_a_row_while_the_track_moves(sliding: TrackBench) -> None:
    view: TrackInputs = sliding.run.engine.control.view
    view.readings.lowered, view.readings.track_now_m_s = False, 1e-4
    assert "arm not in place" in held(sliding)


def test_a_track_that_keeps_moving_though_its_drive_is_to_switch_off_holds_a_row(sliding: TrackBench) -> None:
    view: TrackInputs = sliding.run.engine.control.view
    view.demand.enabled = False
    assert "not switched off" in held(sliding)


def test_force_with_the_arm_raised_holds_a_row() -> None:
    bench = TrackBench("grosch").phase("slide").phase("lift")
    bench.until(lambda one: one.run.engine.ctx.readings.raised, bench.now + 5.0)
    bench.run.engine.control.view.readings.force_n = 5.0
    assert "force with the arm raised" in held(bench)


@pytest.mark.parametrize("field", ["tared", "lowered"])
def test_the_track_is_not_commanded_with_an_arm_that_is_not_in_place(sliding: TrackBench, field: str) -> None:
    engine = sliding.run.engine
    target = engine.ctx.demand if field == "tared" else engine.ctx.readings
    setattr(target, field, False)
    engine.control.run_outputs(engine.ctx.demand, engine.ctx.readings, 0.05)
    assert engine.control.state.setpoints.track_m_s == 0.0


@pytest.mark.parametrize(("place_mm", "goes"), [(284.0, True), (285.0, False), (nan, False)])
def test_the_track_is_not_commanded_over_the_end_of_its_travel(
    sliding: TrackBench, place_mm: float, *, goes: bool
) -> None:
    engine = sliding.run.engine
    engine.ctx.readings.track_mm = place_mm
    engine.control.run_outputs(engine.ctx.demand, engine.ctx.readings, 0.05)
    assert (engine.control.state.setpoints.track_m_s > 0.0) is goes


def test_a_stop_leaves_the_arm_where_it_is_and_the_chamber_off(sliding: TrackBench) -> None:
    sliding.run.request_stop("enough")
    while not sliding.run.finished:
        sliding.tick()
        assert sliding.world.lift_mm < 0.1
    chamber = sliding.world.chamber
    assert chamber is not None and not chamber.running and sliding.world.track_m_s == 0.0


def test_a_drive_in_local_mode_loses_its_power_although_the_stop_waits_for_the_chamber(sliding: TrackBench) -> None:
    chamber, track = sliding.world.chamber, sliding.world.axes["track"]
    assert chamber is not None
    chamber.stuck_output = 100.0
    track.set_local(True)
    began_s = sliding.now
    sliding.until(lambda one: not track.energised, began_s + 2.0)
    state = sliding.run.engine.control.state
    assert state.mode is Mode.FAST_STOP and state.setpoints.power_off


def test_a_speed_that_reads_zero_ends_no_stop_before_its_ramp_can_be_over() -> None:
    bench = TrackBench("pin-on-disc").phase("settle")
    control = bench.run.engine.control
    assert control.motion_over()
    control.state.setpoints.track_m_s = 0.3
    control.note_stop()
    assert not control.motion_over()
    readings = control.view.readings
    readings.now_s = readings.track_at_s = control.view.stop_start.ramp_until_s
    assert control.motion_over()


def test_a_stop_while_the_arm_comes_down_stops_it_there() -> None:
    bench = TrackBench("grosch").until(lambda one: 2.0 < one.world.lift_mm < 8.0, 200.0)
    place_mm = bench.world.lift_mm
    bench.run.request_stop("enough")
    bench.to_the_end(bench.now + 20.0)
    assert bench.world.lift_mm == pytest.approx(place_mm, abs=2.0)
    assert bench.run.engine.control.state.mode is Mode.IDLE


def followed(seconds: float, gone_m_s: float, told_m_s: float = 1e-6) -> WayMonitor:
    """Return a monitor of a track that moves differently from its command."""
    monitor = WayMonitor(0.02)
    for number in range(1, round(seconds / 0.05) + 1):
        monitor.follow(0.05 * number, gone_m_s * 0.05 * number, told_m_s, 0.05)
    return monitor


@pytest.mark.parametrize(("gone_m_s", "sound"), [(1e-6, True), (0.0, False), (2e-6, False), (-1e-6, False)])
def test_a_micrometre_a_second_that_is_not_gone_is_seen(gone_m_s: float, *, sound: bool) -> None:
    monitor = followed(3.0, gone_m_s)
    assert (abs(monitor.off_m) <= monitor.allowed_m(0.3, 2e-5 * 0.0105)) is sound


@pytest.mark.parametrize(("air_k", "percent", "trips"), [(0.1, 100.0, True), (0.1, -100.0, True), (0.5, 100.0, False)])
def test_full_output_that_does_not_move_the_air_is_a_frozen_sensor(
    sliding: TrackBench, air_k: float, percent: float, *, trips: bool
) -> None:
    control = sliding.run.engine.control
    readings, demand = control.view.readings, control.view.demand
    control.state.setpoints.chamber = True
    seen = False
    for scan in range(2000):
        readings.now_s += 0.1
        readings.chamber_percent, readings.air_c = percent, 23.0 + air_k * (scan % 2)
        control.look(demand, readings, 0.1, 0.1)
        seen = seen or "air sensor frozen" in held(sliding)
    assert seen is trips


@pytest.mark.parametrize(("rise_percent", "trips"), [(0.0, False), (60.0, True), (-60.0, True)])
def test_output_that_rises_without_effect_is_a_frozen_sensor_and_a_steady_one_is_none(
    sliding: TrackBench, rise_percent: float, *, trips: bool
) -> None:
    control = sliding.run.engine.control
    readings, demand, view = control.view.readings, control.view.demand, control.view
    control.state.setpoints.chamber = True
    readings.air_c, readings.chamber_percent = 80.0, 20.0
    view.chamber_mean_percent = view.usual_percent = 20.0
    view.full_c, view.excess_s, view.full_s = 80.0, 0.0, 0.0
    most_s = 0.0
    for scan in range(12000):
        readings.now_s += 0.1
        readings.chamber_percent = 20.0 + rise_percent * scan / 12000
        control.look(demand, readings, 0.1, 0.1)
        most_s = max(most_s, view.unanswered_s)
    assert (most_s > 120.0) is trips
