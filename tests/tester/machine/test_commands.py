"""Hold, release, acknowledge, stop and abort on a whole run: idempotent, and in any order with faults."""

from __future__ import annotations

from copy import deepcopy

import pytest

from tester.base.words import duration
from tester.machine.run import Outcome
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation, in_burst

OVERCURRENT = 0x2310


@pytest.fixture
def running(mid_burst: Simulation) -> Simulation:
    """A run in the middle of a burst."""
    return deepcopy(mid_burst)


def mode(simulation: Simulation) -> Mode:
    return simulation.run.engine.control.state.mode


def tick_for(simulation: Simulation, seconds: float) -> Simulation:
    until = simulation.now + seconds
    return simulation.until(lambda s: s.now > until)


@pytest.fixture(scope="module")
def held_run(mid_burst: Simulation) -> Simulation:
    """A run that was held in a burst for a minute and released, to its end."""
    run = deepcopy(mid_burst)
    assert run.run.request_hold() == ""
    tick_for(run, 60.0)
    assert run.run.request_release() == ""
    return run.to_the_end()


def test_a_hold_lifts_and_takes_the_slip_out_with_the_heat_as_it_was(running: Simulation) -> None:
    wanted = running.ctx.demand.surface_c
    assert running.run.request_hold() == ""
    tick_for(running, 2.0)
    world, out = running.world, running.run.engine.control.state.setpoints
    assert mode(running) is Mode.HOLD and world.plant.force_z_n == 0.0
    wheel, belt = world.axes["wheel"].axis.value * 0.045, world.axes["belt"].axis.value
    assert wheel == pytest.approx(0.8, abs=0.01) and belt == pytest.approx(0.8, abs=0.01)
    assert out.enable and out.heat is (wanted == wanted)


def test_a_hold_stays_until_it_is_released(running: Simulation) -> None:
    running.run.request_hold()
    tick_for(running, 60.0)
    assert mode(running) is Mode.HOLD and running.run.engine.control.state.trip is None


def test_a_held_repeat_is_void_and_done_again_in_a_second_attempt(held_run: Simulation) -> None:
    assert held_run.run.outcome is Outcome.DONE
    begun = held_run.notes.fields("INSERT INTO repeat")
    assert [(row["repeat"], row["attempt"]) for row in begun] == [(1, 1), (1, 2)]
    ended = [row for row in held_run.notes.fields("UPDATE repeat SET") if "flags" in row]
    assert ended[0]["status"] == "void" and len(ended) == 2


def test_no_sample_of_a_hold_belongs_to_a_repeat(held_run: Simulation) -> None:
    texts = [(t, text) for t, kind, text, _ in held_run.notes.events if kind == "mode"]
    held = next(t for t, text in texts if text.startswith("run -> hold"))
    released = next(t for t, text in texts if text.startswith("hold -> run"))
    keys = {row["repeat_key"] for row in held_run.rows() if held < row["time_s"] <= released}
    assert keys == {0.0}


def test_the_end_of_a_hold_states_its_duration(held_run: Simulation) -> None:
    events = held_run.notes.events
    changes = "run -> hold", "hold ->"
    began, ended = (next(t for t, _, text, _ in events if text.startswith(change)) for change in changes)
    ((at, said),) = [(t, text) for t, kind, text, _ in events if kind == "held"]
    assert at == ended and said == f"HOLD lasted {duration(ended - began)}"


def test_the_surface_is_conditioned_again_after_a_hold(held_run: Simulation) -> None:
    released = next(t for t, kind, text, _ in held_run.notes.events if text.startswith("hold -> run"))
    begun = held_run.notes.fields("INSERT INTO repeat")[1]
    assert float(str(begun["begun_s"])) > released + 2.0


def test_a_pre_grinding_that_was_held_grinds_its_whole_time() -> None:
    text = SHORT + "pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 20 s}\n"
    run = Simulation(text, seed=1)
    run.until(lambda s: s.ctx.progress.phase.startswith("grind 10"))
    run.run.request_hold()
    tick_for(run, 10.0)
    run.run.request_release()
    run.until(lambda s: s.ctx.progress.title.startswith("1#"))
    ground = [row for row in run.rows() if row["force_z_n"] > 190.0 and 0.18 < row["slip_m_s"] < 0.22]
    assert len(ground) == pytest.approx(2000, abs=60)


def test_commands_that_do_not_apply_are_refused_and_change_nothing(running: Simulation) -> None:
    before = mode(running)
    assert "nothing to release" in running.run.request_release()
    assert "nothing to acknowledge" in running.run.request_ack()
    assert mode(running) is before


def test_a_hold_asked_for_twice_is_one_hold(running: Simulation) -> None:
    assert running.run.request_hold() == "" and running.run.request_hold() == ""
    tick_for(running, 1.0)
    assert len([text for text in running.notes.texts("mode") if "-> hold" in text]) == 1


@pytest.mark.parametrize("first", ["hold", "fault"])
def test_hold_and_fault_end_latched_in_either_order(running: Simulation, first: str) -> None:
    def fault() -> None:
        running.world.advance(running.now)
        running.world.axes["belt"].fault(OVERCURRENT)

    if first == "hold":
        running.run.request_hold()
        fault()
    else:
        fault()
        running.run.request_hold()
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.run.reason.startswith("drive fault")
    assert running.world.plant.force_z_n == 0.0


def test_an_abort_out_of_a_hold_ends_at_standstill(running: Simulation) -> None:
    running.run.request_hold()
    tick_for(running, 2.0)
    running.run.request_stop("aborted by the operator")
    running.to_the_end()
    assert running.run.outcome is Outcome.STOPPED and running.world.axes["wheel"].axis.value == 0.0


def test_a_trip_waits_for_its_acknowledgement_on_request(running: Simulation) -> None:
    running.run.stays_latched = True
    running.world.axes["belt"].fault(OVERCURRENT)
    running.until(lambda s: mode(s) is Mode.LATCHED)
    tick_for(running, 5.0)
    assert not running.run.finished
    assert running.run.request_ack() == ""
    running.until(lambda s: mode(s) is Mode.IDLE)
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED


def test_a_trip_is_recorded_with_value_limit_unit_and_acknowledger(running: Simulation) -> None:
    running.run.stays_latched = True
    running.run.engine.control.view.limits.load_n = 150.0
    running.until(lambda s: mode(s) is Mode.LATCHED)
    assert running.run.request_ack("ada, user id 1000") == ""
    running.until(lambda s: mode(s) is Mode.IDLE)
    (trip,) = running.notes.written("INSERT INTO trip")
    (said,) = running.notes.written("UPDATE trip")
    assert trip[3] == "overload" and trip[5:] == (pytest.approx(200.0, abs=20.0), 150.0, "N")
    assert said[0] > trip[1] and said[2:] == ("ada, user id 1000", 1)  # type: ignore[operator]


def test_an_acknowledgement_with_the_chain_open_is_refused(running: Simulation) -> None:
    running.run.stays_latched = True
    running.world.axes["press"].set_safety_chain(False)
    running.until(lambda s: mode(s) is Mode.LATCHED)
    assert running.run.request_ack() == ""
    tick_for(running, 2.0)
    assert mode(running) is Mode.LATCHED
    assert running.notes.texts("acknowledgement") == ["refused, still there: safety chain"]


def test_an_open_safety_chain_is_mirrored_with_every_command_zero(running: Simulation) -> None:
    running.world.axes["press"].set_safety_chain(False)
    running.until(lambda s: mode(s) is Mode.EMERGENCY)
    out = running.run.engine.control.state.setpoints
    assert (out.wheel_rad_s, out.belt_m_s, out.press_mm_s) == (0.0, 0.0, 0.0)
    assert not out.heat and not out.contactor and not out.enable
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.world.plant.force_z_n == 0.0


def test_an_emergency_message_without_a_fault_trips_in_the_scan_that_receives_it(running: Simulation) -> None:
    belt = running.world.axes["belt"]
    running.world.advance(running.now)
    belt.error(0x4210, running.world.now_s)  # drive too hot: reported, not acted on
    engine = running.run.engine
    running.until(lambda s: engine.devices.axes.belt.emergency is not None)
    assert mode(running) is Mode.FAST_STOP
    kinds = [kind for _, kind, _, _ in running.notes.events[-3:]]
    assert kinds == ["emergency", "trip", "mode"]


def test_a_lost_serial_line_is_a_trip_with_the_drives_still_commanded(running: Simulation) -> None:
    running.world.lines["load_cell"].disconnect()
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.run.reason.startswith("bus lost")
    assert running.world.plant.force_z_n == 0.0 and running.world.axes["wheel"].axis.value == 0.0


def test_a_lost_can_bus_takes_the_heat_off_over_the_other_line(running: Simulation) -> None:
    running.world.can.disconnect()
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and not running.world.jacket.running


def test_nothing_is_sent_on_a_bus_that_comes_back(running: Simulation) -> None:
    running.world.can.disconnect()
    running.until(lambda s: mode(s) is Mode.FAST_STOP)
    running.world.can.reconnect()
    before = running.world.can.occupied_s
    sent: list[int] = []

    def frame(t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        if from_pc:
            sent.append(can_id)

    running.world.can.watch(frame)
    running.to_the_end()
    assert sent == [] and running.world.can.occupied_s >= before


def test_a_second_master_while_running_is_a_trip(running: Simulation) -> None:
    running.world.advance(running.now)
    running.world.can.inject(0x203, b"\x0f\x00\x00\x00\x00\x00", running.now)
    running.to_the_end()
    assert running.run.outcome is Outcome.TRIPPED and running.run.reason.startswith("second master")


def test_a_stop_without_cool_down_leaves_at_standstill_with_a_hot_jacket(running: Simulation) -> None:
    running.world.plant.heat.hub_c = 80.0
    running.run.engine.control.view.jacket.forget(running.now + 3600.0)
    running.run.request_stop("terminated", cool=False)
    began = running.now
    running.to_the_end()
    assert running.now - began < 5.0 and running.world.axes["wheel"].axis.value == 0.0


def test_a_stop_while_the_watchdogs_are_tried_out_releases_the_drives() -> None:
    run = Simulation()
    run.until(lambda s: s.world.axes["wheel"].axis.value > 0.5)
    run.run.request_stop("interrupted")
    run.to_the_end()
    run.world.advance(run.now + 5.0)
    assert run.run.outcome is Outcome.STOPPED
    assert all(abs(axis.axis.value) < 1e-6 for axis in (run.world.axes["wheel"], run.world.axes["belt"]))
    assert run.run.engine.devices.all_off()


def test_a_burst_begins_again_after_a_hold(held_run: Simulation) -> None:
    assert not in_burst(held_run) and len(held_run.notes.written("INSERT INTO burst")) >= 1
