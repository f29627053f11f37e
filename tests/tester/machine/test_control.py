"""Modes, requests, trips and stops of any machine, on a lamp."""

from __future__ import annotations

import pytest

from tester.machine.mode_commands import bounded
from tester.machine.state import Mode
from tests.tester.machine.toy import HOLD_S, LampControl, LampDemand, LampReadings


class Lamp:
    """A lamp in RUN, and its hands."""

    def __init__(self) -> None:
        self.control = LampControl()
        self.readings = LampReadings(safety_chain=True, guard_closed=True)
        self.demand = LampDemand(enabled=True, light=1.0)
        assert self.control.start(self.readings) == ""

    @property
    def mode(self) -> Mode:
        return self.control.state.mode

    def scan(self, dt: float = 0.05) -> LampControl:
        self.readings.now_s += dt
        self.readings.drives_enabled = self.control.state.setpoints.light > 0.0
        self.control.step(self.demand, self.readings, dt)
        return self.control

    def scans(self, count: int) -> LampControl:
        for _ in range(count):
            self.scan()
        return self.control

    def texts(self, kind: str) -> list[str]:
        return [event.text for event in self.control.state.events if event.kind == kind]


@pytest.fixture
def lamp() -> Lamp:
    made = Lamp()
    made.scan()
    return made


def test_a_run_commands_its_demand(lamp: Lamp) -> None:
    assert lamp.mode is Mode.RUN and lamp.control.state.setpoints.light == 1.0
    assert lamp.texts("mode") == ["idle -> armed: every level clear", "armed -> run: start"]


def test_an_active_level_prevents_arming() -> None:
    control = LampControl()
    assert control.start(LampReadings(lamp_c=90.0)) == "not armed: chain, hot"
    assert control.state.mode is Mode.IDLE


def test_a_row_trips_when_it_has_held_for_its_delay(lamp: Lamp) -> None:
    lamp.readings.lamp_c = 90.0
    lamp.scan()
    assert lamp.mode is Mode.RUN and lamp.control.table.names_of(lamp.control.state.held) == ["hot"]
    lamp.scans(2)
    trip = lamp.control.state.trip
    assert lamp.mode is Mode.STOPPING and trip is not None and trip.name == "hot"
    assert (trip.compared.value, trip.compared.limit) == (90.0, 80.0)
    assert trip.text == "the lamp is hot (90 degC)"


def test_a_trip_names_the_reports_of_drives_and_devices(lamp: Lamp) -> None:
    lamp.readings.safety_chain, lamp.readings.drive_fault = False, "lamp drive: fault"
    lamp.scan()
    assert lamp.texts("trip") == ["chain: the safety chain is open [lamp drive: fault] (20 degC)"]


def test_a_second_cause_is_an_alarm_and_the_harder_reaction_wins(lamp: Lamp) -> None:
    lamp.readings.lamp_c = 90.0
    lamp.scans(3)
    lamp.readings.safety_chain = False
    lamp.control.state.setpoints.light = 1.0
    lamp.scan()
    assert lamp.mode is Mode.FAST_STOP and len(lamp.texts("alarm")) == 1


def test_a_warning_stops_nothing_and_is_reported_once_while_it_lasts(lamp: Lamp) -> None:
    lamp.readings.now_s += 2.0
    lamp.scan()
    assert lamp.mode is Mode.RUN and lamp.texts("warning") == ["late: a scan came late"]


def test_a_stop_records_its_initial_state_and_ends_in_idle(lamp: Lamp) -> None:
    lamp.control.request_stop(lamp.readings.now_s, "enough")
    lamp.scans(2)
    assert lamp.control.called == ["note stop", "stop outputs: stopping", "stop outputs: stopping", "note rest"]
    assert lamp.mode is Mode.IDLE and not lamp.control.state.setpoints.enable


def test_a_fast_stop_latches_until_it_is_acknowledged(lamp: Lamp) -> None:
    lamp.control.request_stop(lamp.readings.now_s, "now", fast=True)
    lamp.scans(2)
    assert lamp.mode is Mode.LATCHED and lamp.control.called[:2] == ["note stop", "note fast stop"]
    assert lamp.control.request_ack(lamp.readings.now_s, "me") == ""
    lamp.scan()
    assert lamp.mode is Mode.IDLE and lamp.texts("acknowledged") == ["me"]


def test_an_acknowledgement_with_the_cause_still_there_is_refused(lamp: Lamp) -> None:
    lamp.readings.safety_chain = False
    lamp.scans(3)
    lamp.control.request_ack(lamp.readings.now_s)
    lamp.scans(12)
    assert lamp.mode is Mode.LATCHED and lamp.texts("acknowledgement") == ["refused, still there: chain"]


def test_a_machine_that_must_not_stand_hot_cools_first(lamp: Lamp) -> None:
    lamp.control.must = "hot"
    lamp.readings.lamp_c = 70.0
    lamp.control.request_stop(lamp.readings.now_s, "enough")
    lamp.scans(2)
    assert lamp.mode is Mode.COOLDOWN and lamp.control.state.stop.creeps
    lamp.readings.lamp_c = 30.0
    lamp.scans(2)
    assert lamp.texts("mode")[-2:] == ["cooldown -> stopping: cool", "stopping -> idle: standstill"]


def test_a_hold_keeps_the_demand_of_the_kind_and_a_release_continues(lamp: Lamp) -> None:
    assert lamp.control.request_hold(lamp.demand, lamp.readings.now_s, "held") == ""
    lamp.scan()
    assert lamp.mode is Mode.HOLD and lamp.control.state.setpoints.light == 0.5
    assert lamp.control.request_release(lamp.readings.now_s, "go on") == ""
    lamp.scan()
    assert lamp.mode is Mode.RUN and lamp.control.state.setpoints.light == 1.0


def test_a_hold_that_lasts_too_long_ends_in_a_stop(lamp: Lamp) -> None:
    lamp.control.request_hold(lamp.demand, lamp.readings.now_s, "held")
    lamp.scan()
    lamp.readings.now_s += HOLD_S
    lamp.scan()
    assert lamp.mode is Mode.STOPPING and lamp.control.state.stop_requested == "held too long"


def test_an_output_with_power_at_rest_loses_it(lamp: Lamp) -> None:
    lamp.control.request_stop(lamp.readings.now_s, "enough")
    lamp.scans(2)
    lamp.readings.now_s += 0.05
    lamp.readings.drives_enabled = True
    lamp.control.step(lamp.demand, lamp.readings, 0.05)
    assert lamp.mode is Mode.LATCHED and lamp.control.state.setpoints.power_off


@pytest.mark.parametrize(
    ("value", "command"), [(0.5, 0.5), (-3.0, -2.0), (3.0, 2.0), (float("nan"), 0.0), (float("inf"), 0.0)]
)
def test_a_command_is_bounded_and_not_a_number_is_zero(value: float, command: float) -> None:
    assert bounded(value, 2.0) == command
