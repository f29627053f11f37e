"""Cool-down and rest: unwanted turning, contact, load or heat is detected and removed."""

from __future__ import annotations

from math import nan

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.control.conftest import Bench
from tests.tester.kinds.wheel_on_belt.control.test_stop_modes import cool, lift, stand


def rest(bench: Bench, mode: Mode = Mode.IDLE) -> None:
    """Stop, and come to rest; LATCHED by a guard that was open for a moment."""
    if mode is Mode.LATCHED:
        bench.readings.guard_closed = False
        bench.scan()
        bench.readings.guard_closed = True
    else:
        bench.state.cooled = True
        bench.control.request_stop(bench.readings.now_s, "test")
        bench.scan()
    lift(bench)
    stand(bench)
    cool(bench)
    bench.scans(0.1)
    assert bench.state.mode is mode
    bench.readings.drives_enabled, bench.readings.drives_disabled = False, True
    bench.scans(0.6)


def creep(bench: Bench) -> None:
    """Stop with a hot hub, and be in the cool-down."""
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.control.view.heat.forget()
    bench.readings.hub_c = 65.0
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    lift(bench)
    stand(bench)
    cool(bench)
    bench.scan()
    bench.readings.wheel_speed_m_s = 0.1
    bench.scans(1.0)
    assert bench.state.mode is Mode.COOLDOWN and bench.state.trip is None


@pytest.mark.parametrize(
    ("signal", "value", "row"),
    [
        ("wheel_speed_m_s", 0.9, "wheel speed"),
        ("belt_speed_m_s", 0.5, "belt speed"),
        ("press_mm", 1.0, "press speed"),
        ("drives_enabled", False, "drive dropped out"),
        ("force_z_n", 60.0, "not lifted"),
    ],
)
def test_the_cool_down_is_watched(bench: Bench, signal: str, value: float, row: str) -> None:
    creep(bench)
    setattr(bench.readings, signal, value)
    bench.scans(0.5)
    assert bench.state.trip is not None and bench.state.trip.name == row
    assert bench.state.mode is Mode.FAST_STOP


def test_a_second_stop_in_the_cool_down_changes_nothing(bench: Bench) -> None:
    creep(bench)
    for _ in range(5):
        bench.control.request_stop(bench.readings.now_s, "again")
        bench.scans(0.5)
    assert bench.state.mode is Mode.COOLDOWN and bench.state.trip is None


def test_a_creep_whose_shown_speed_does_not_change_loses_its_power(bench: Bench) -> None:
    creep(bench)
    bench.stale.add("wheel_changed_s")
    assert not bench.scans(0.9).power_off
    assert bench.scans(0.2).power_off
    assert bench.state.trip is not None and bench.state.trip.name == "wheel frozen"


def test_in_a_cool_down_only_the_wheel_keeps_its_power(bench: Bench) -> None:
    creep(bench)
    assert bench.state.setpoints.creeps
    bench.readings.hub_c = 30.0
    bench.control.view.jacket.forget(bench.readings.now_s)
    bench.scans(0.1)
    stand(bench)
    bench.scans(1.0)
    assert bench.state.mode is Mode.IDLE and not bench.state.setpoints.creeps


def test_at_rest_the_voltage_is_disabled_and_a_drive_that_claims_power_trips(bench: Bench) -> None:
    rest(bench)
    assert bench.scans(0.6).voltage_off and bench.state.trip is None
    bench.readings.drives_disabled = False
    assert bench.scans(0.2).power_off
    assert bench.state.trip is not None and bench.state.trip.name == "moving at rest"


def test_a_stop_that_wants_no_cool_down_ends_it(bench: Bench) -> None:
    creep(bench)
    bench.control.request_stop(bench.readings.now_s, "leave", cool=False)
    bench.readings.wheel_speed_m_s = 0.0
    bench.scans(0.5)
    assert bench.state.mode is Mode.IDLE


@pytest.mark.parametrize("mode", [Mode.IDLE, Mode.LATCHED])
@pytest.mark.parametrize("signal", ["wheel_speed_m_s", "belt_speed_m_s", "press_mm"])
def test_an_axis_that_moves_at_rest_under_power_loses_it_and_latches(bench: Bench, mode: Mode, signal: str) -> None:
    rest(bench, mode)
    bench.readings.drives_disabled = False
    setattr(bench.readings, signal, getattr(bench.readings, signal) + 0.5)
    out = bench.scans(0.2)
    assert out.power_off and bench.state.mode is Mode.LATCHED
    assert any(text.startswith("moving at rest") for text in bench.texts("trip") + bench.texts("alarm"))


def test_a_belt_turned_by_hand_trips_nothing_but_is_not_armed(bench: Bench) -> None:
    rest(bench)
    bench.readings.belt_speed_m_s = 0.3
    out = bench.scans(1.0)
    assert bench.state.mode is Mode.IDLE and not out.power_off
    assert "moving at rest" in bench.control.start(bench.readings)


def test_a_load_that_is_still_on_is_neither_acknowledged_nor_armed(bench: Bench) -> None:
    rest(bench, Mode.LATCHED)
    bench.readings.force_z_n = 152.0
    bench.scans(0.1)
    bench.control.request_ack(bench.readings.now_s)
    bench.scans(1.5)
    assert bench.state.mode is Mode.LATCHED
    assert any("loaded at rest" in text for text in bench.texts("acknowledgement"))


def test_a_power_that_was_taken_stays_off_until_the_acknowledgement(bench: Bench) -> None:
    bench.state.cooled = True
    bench.control.request_stop(bench.readings.now_s, "test")
    bench.scan()
    stand(bench)
    cool(bench)
    assert bench.scans(2.0).power_off
    lift(bench)
    assert bench.scans(1.0).power_off and bench.state.mode is Mode.LATCHED
    bench.control.request_ack(bench.readings.now_s)
    assert not bench.scan().power_off


def test_an_acknowledgement_while_a_drive_still_turns_takes_its_power_again(bench: Bench) -> None:
    rest(bench, Mode.LATCHED)
    bench.readings.drives_disabled = False
    bench.readings.belt_speed_m_s = 0.5
    assert bench.scans(0.2).power_off
    bench.control.request_ack(bench.readings.now_s)
    assert not bench.scan().power_off
    assert bench.scans(1.2).power_off and bench.state.mode is Mode.LATCHED


@pytest.mark.parametrize(("signal", "percent"), [("contactor_closed", 0.0), ("contactor_closed", 50.0)])
def test_a_contactor_that_closes_by_itself_at_rest_is_latched(bench: Bench, signal: str, percent: float) -> None:
    rest(bench)
    setattr(bench.readings, signal, True)
    bench.readings.heat_percent = percent
    out = bench.scans(1.0)
    assert bench.state.mode is Mode.LATCHED and bench.state.trip is not None
    assert out.jacket_silent is (percent > 0.0)


# -- in a run that has its drives off -----------------------------------------------------------------------------


def rest_in_run(bench: Bench, *, attended: bool = False) -> None:
    """Begin a run that does not need its drives yet; ``attended``: with a question."""
    rest(bench)
    demand = bench.demand
    demand.press, demand.load_n, demand.surface_c = Press.LIFT, 0.0, nan
    demand.wheel_speed_m_s = demand.belt_speed_m_s = 0.0
    demand.enabled, demand.attended = False, attended
    assert bench.control.start(bench.readings) == ""
    bench.scans(0.5, 0.1)
    assert bench.state.mode is Mode.RUN and bench.state.trip is None


def test_a_drive_that_takes_power_by_itself_in_a_run_at_rest_loses_it(bench: Bench) -> None:
    rest_in_run(bench)
    bench.readings.drives_disabled = False
    out = bench.scans(0.2, 0.1)
    assert out.power_off and bench.state.trip is not None and bench.state.trip.name == "moving at rest"


@pytest.mark.parametrize("stamp", ["wheel_at_s", "belt_at_s", "press_at_s"])
def test_an_unknown_drive_in_a_run_at_rest_trips(bench: Bench, stamp: str) -> None:
    rest_in_run(bench)
    bench.stale.add(stamp)
    bench.scans(1.0, 0.1)
    assert bench.state.trip is not None and bench.state.trip.name == "moving at rest"


@pytest.mark.parametrize(("signal", "value"), [("wheel_speed_m_s", 0.3), ("belt_speed_m_s", -0.1), ("press_mm", 0.5)])
def test_motion_while_the_drives_come_up_trips(bench: Bench, signal: str, value: float) -> None:
    rest_in_run(bench)
    bench.demand.enabled = True
    bench.readings.drives_disabled = False
    bench.scans(1.0, 0.05)
    assert bench.state.trip is None
    setattr(bench.readings, signal, value)
    bench.scans(0.2, 0.05)
    assert bench.state.trip is not None and bench.state.trip.name == "moving at rest"


@pytest.mark.parametrize(
    ("signal", "value"),
    [("force_z_n", 90.0), ("force_z_n", -40.0), ("wheel_speed_m_s", 0.15), ("belt_speed_m_s", 0.3),
     ("cell_valid", False), ("hub_c", 62.0), ("jacket_valid", False), ("surface_valid", False)],
)  # fmt: skip
def test_hands_at_the_wheel_trip_nothing(bench: Bench, signal: str, value: float) -> None:
    rest_in_run(bench, attended=True)
    before = getattr(bench.readings, signal)
    setattr(bench.readings, signal, value)
    if signal == "wheel_speed_m_s":
        bench.readings.force_z_n = 25.0
    bench.scans(3.0, 0.1)
    assert bench.state.trip is None
    setattr(bench.readings, signal, before)
    bench.readings.force_z_n = 0.0
    bench.scans(0.3, 0.1)
    bench.demand.attended = False
    bench.scans(0.3, 0.1)
    bench.demand.enabled, bench.readings.drives_disabled, bench.readings.drives_enabled = True, False, True
    bench.scans(3.0)
    assert bench.state.trip is None


def test_the_hub_is_watched_again_once_the_person_has_gone(bench: Bench) -> None:
    rest_in_run(bench, attended=True)
    bench.readings.jacket_valid = False
    bench.scans(3.0, 0.1)
    bench.demand.attended = False
    bench.scans(0.5, 0.1)
    assert bench.state.trip is not None and bench.state.trip.name == "hub sensor broken"


def test_an_output_that_is_on_at_rest_is_not_armed(bench: Bench) -> None:
    rest(bench)
    bench.readings.heat_percent = 40.0
    bench.scans(0.2)
    assert "output not off" in bench.control.start(bench.readings)
