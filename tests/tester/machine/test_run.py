"""A run from outside: its end, and the effect of a stop."""

from __future__ import annotations

from copy import deepcopy

import pytest

from drivers.cia402 import State
from sim.wires.modbus_wire import Impairment
from tester.machine.run import Outcome
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.bench import Simulation


@pytest.fixture
def running(mid_burst: Simulation) -> Simulation:
    """A run in the middle of a burst."""
    return deepcopy(mid_burst)


def test_a_recipe_that_is_finished_is_done(quiet_run: Simulation) -> None:
    assert (quiet_run.run.outcome, quiet_run.run.reason) == (Outcome.DONE, "")


def test_a_finished_run_is_at_rest_without_a_trip(quiet_run: Simulation) -> None:
    world, state = quiet_run.world, quiet_run.run.engine.control.state
    assert world.axes["wheel"].axis.value == world.axes["belt"].axis.value == 0.0
    assert state.mode is Mode.IDLE and state.trip is None


def test_released_drives_do_not_miss_our_heartbeat(quiet_run: Simulation) -> None:
    copied = deepcopy(quiet_run)
    copied.world.advance(copied.now + 5.0)
    assert all(axis.state is not State.FAULT for axis in copied.world.axes.values())


def test_a_rig_that_does_not_come_up_is_unreachable() -> None:
    simulation = Simulation()
    simulation.world.axes["belt"].power(False)
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE
    assert simulation.run.reason.startswith("belt drive (node 2)")


def test_an_unplugged_adapter_is_unreachable() -> None:
    simulation = Simulation()
    simulation.world.can.disconnect()
    simulation.to_the_end(100.0)
    assert simulation.run.outcome is Outcome.UNREACHABLE and simulation.run.reason.startswith("bus lost")


def test_a_bus_that_is_lost_on_the_way_is_a_trip(running: Simulation) -> None:
    running.world.can.disconnect()
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and "bus lost" in running.run.reason
    assert len(running.notes.written("INSERT INTO trip")) == 1


def test_a_trip_ends_a_run_with_its_cause(running: Simulation) -> None:
    running.world.axes["press"].set_guard(False)
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.run.reason.startswith("guard open")


@pytest.mark.parametrize(
    "line, unit_id, interlock",
    [("load_cell", 1, "load cell silent"), ("heat", 2, "thermometer silent"), ("heat", 1, "jacket silent")],
)
def test_a_device_that_falls_silent_is_a_trip(running: Simulation, line: str, unit_id: int, interlock: str) -> None:
    running.world.lines[line].impair = Impairment("silence", count=-1, unit_id=unit_id)
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.run.reason.startswith(interlock)


def test_a_trip_names_the_computer_that_was_late_before_it_and_no_other(running: Simulation) -> None:
    drives = running.run.engine.devices.drives
    drives[0].machine_late += [(running.now - 5.0, 400), (running.now - 0.2, 65), (running.now - 0.1, 20)]
    running.world.axes["press"].set_guard(False)
    running.to_the_end()
    assert running.run.reason.endswith("; the computer that simulates this machine was late by 65 ms")


def test_a_trip_names_its_own_computer_where_scans_came_late(running: Simulation) -> None:
    running.now += 0.08
    running.run.tick(running.now)
    running.world.axes["press"].set_guard(False)
    running.to_the_end()
    assert "; this computer was late by 8" in running.run.reason


def test_a_drive_that_goes_dark_is_a_trip(running: Simulation) -> None:
    running.world.axes["belt"].power(False)
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED
    assert running.world.plant.force_z_n < 5.0


def test_a_stop_ends_at_standstill_as_stopped(running: Simulation) -> None:
    running.run.request_stop("terminated")
    running.to_the_end()
    assert (running.run.outcome, running.run.reason) == (Outcome.STOPPED, "terminated")
    assert running.world.plant.force_z_n < 5.0 and running.world.axes["wheel"].axis.value == 0.0


def test_a_controlled_stop_takes_the_slip_out_before_the_speeds(running: Simulation) -> None:
    running.run.request_stop("terminated")
    loaded: list[float] = []
    while not running.run.finished:
        running.tick()
        if running.world.plant.force_z_n > 20.0:
            wheel = running.world.axes["wheel"].axis.value * 0.045
            loaded.append(abs(wheel) - abs(running.world.axes["belt"].axis.value))
    assert loaded and min(loaded) > -0.05 and running.run.engine.control.state.trip is None


def test_a_stop_that_is_asked_for_twice_is_one_stop(running: Simulation) -> None:
    running.run.request_stop("first")
    running.tick()
    running.run.request_stop("second")
    running.to_the_end()
    stops = [text for text in running.notes.texts("mode") if text.startswith("run ->")]
    assert len(stops) == 1 and running.run.reason == "first"


def test_a_second_request_can_make_a_stop_fast(running: Simulation) -> None:
    running.run.request_stop("first")
    running.tick()
    running.run.request_stop("now", fast=True)
    running.to_the_end()
    assert any("fast stop" in text for text in running.notes.texts("mode"))
    assert running.run.outcome is Outcome.STOPPED


def test_a_stop_commits_no_repeat(running: Simulation) -> None:
    running.run.request_stop("terminated")
    running.to_the_end()
    assert running.notes.written("UPDATE repeat") == []


def test_a_stop_before_the_rig_is_up_ends_at_once() -> None:
    simulation = Simulation()
    simulation.tick()
    simulation.run.request_stop("interrupted")
    assert simulation.run.finished and simulation.run.outcome is Outcome.STOPPED


def test_an_open_question_waits_and_a_stop_ends_the_waiting() -> None:
    simulation = Simulation()
    simulation.ctx.prompts.automatic = False
    simulation.until(lambda s: s.run.waiting)
    simulation.run.request_stop("terminated")
    assert not simulation.run.waiting
    simulation.to_the_end()
    assert simulation.run.outcome is Outcome.STOPPED


def test_a_failure_of_the_recipe_fails_the_run(running: Simulation) -> None:
    running.run.engine.executor.failed = "load cell zero drifted"
    running.run.engine.executor.finished = True
    running.to_the_end()
    assert (running.run.outcome, running.run.reason) == (Outcome.FAILED, "load cell zero drifted")
