"""A run under a fault script, as ``tester run --fault`` has it."""

from __future__ import annotations

from functools import cache

import pytest

from sim.faults.can import FaultyCanWire
from sim.machines.wheel_on_belt.faults import LANGUAGE
from tests.campaigns.faults.moments import rehearse
from tests.campaigns.faults.recipes import SHORT
from tests.campaigns.faults.stage import Stage


@cache
def started() -> Stage:
    """Return a run with its load held."""
    stage = Stage(SHORT)
    while not (stage.run.engine.ctx.contact.loaded and stage.rig.plant.force_z_n > 100.0):
        stage.tick()
    return stage


def under(text: str, seconds: float) -> Stage:
    """Continue from there for some time with a script; ``t=`` counts from there."""
    stage = started().copy()
    begin = stage.next_s
    injections = LANGUAGE.parse_script([text.replace("t=", f"t={begin + 0.001:.6f} s: ", 1)])
    stage.inject(*injections)
    while stage.next_s < begin + seconds:
        stage.tick()
    return stage


def tripped_by(stage: Stage) -> str:
    trip = stage.run.engine.control.state.trip
    return trip.name if trip is not None else ""


def test_a_rig_that_can_be_faulty_runs_as_a_plain_one_while_it_is_not():
    assert isinstance(started().rig.can, FaultyCanWire)
    assert not started().rig.can.spoiled
    assert rehearse("short")[1].run.outcome.value == "done"


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ("belt drive heartbeat lost", "drive fault"),
        ("wheel drive data lost", "drive data stale"),
        ("belt drive off the bus", "drive data stale"),
        ("CAN adapter gone", "bus lost"),
        ("second master SYNC", "second master"),
        ("CAN bus off", "CAN silent"),
        ("load cell silent", "load cell silent"),
        ("press drive inputs lost", "inputs stale"),
        ("guard opened", "guard open"),
        ("emergency stop pressed", "safety chain"),
        ("press drive in local mode", "drive fault"),
        ("scan stalled 400 ms", "drive fault"),
        ("clock jump 2 s", "scan late"),
    ],
)
def test_a_fault_is_noticed_by_the_row_that_is_for_it(fault: str, cause: str):
    stage = under(f"t={fault}", 1.5)
    assert cause in stage.run.engine.ctx.journal.trips  # type: ignore[attr-defined]
    assert not stage.observer.found


def test_inputs_that_are_lost_shortly_are_ridden_through():
    stage = under("t=press drive inputs lost for 120 ms", 2.0)
    assert stage.mode == "run"


@pytest.mark.parametrize(("fault", "within_s"), [("guard opened", 0.16), ("safety chain opened", 0.16)])
def test_an_input_whose_frame_is_lost_is_seen_with_the_next(fault: str, within_s: float):
    stage = started().copy()
    begin = stage.next_s
    stage.inject(*LANGUAGE.parse_script([f"t={begin:.6f} s: press drive inputs lost for 50 ms",
                                f"t={begin + 0.02:.6f} s: {fault}"]))
    while stage.next_s < begin + within_s:
        stage.tick()
    assert stage.mode in ("fast stop", "emergency stop mirrored")


def test_a_contactor_whose_off_is_lost_opens_all_the_same():
    stage = Stage(SHORT, ("sim.ambient=20 degC",))
    engine = stage.run.engine
    while not (engine.ctx.readings.contactor_closed and engine.control.state.setpoints.heat):
        stage.tick()
    stage.inject(*LANGUAGE.parse_script([f"t={stage.next_s:.6f} s: press drive outputs lost shortly for 300 ms"]))
    stage.tick()
    begin = stage.next_s
    stage.run.stays_latched = True
    stage.run.request_stop("enough", fast=True)
    while stage.next_s < begin + 0.5:
        stage.tick()
    io = stage.rig.axes["press"].io
    assert io is not None and not io.contactor_closed


def test_a_stall_shorter_than_the_limit_is_ridden_through():
    stage = under("t=scan stalled shortly", 2.0)
    assert stage.mode == "run"


def test_a_fault_that_is_over_lets_frames_pass_again():
    stage = under("t=CAN frames repeated for 300 ms", 1.0)
    assert not stage.rig.can.spoiled  # type: ignore[attr-defined]
    assert stage.mode == "run"


def test_after_a_kill_the_devices_stop_by_themselves():
    stage = under("t=process killed", 3.0)
    plant = stage.rig.plant
    assert stage.faulty.killed
    assert plant.force_z_n == 0.0 and plant.slip_m_s == 0.0
    assert stage.rig.axes["wheel"].axis.value == 0.0


def test_a_press_that_holds_without_power_keeps_its_force_and_everything_is_at_rest():
    stage = Stage(SHORT, ("sim.press_on_power_loss=hold", "axes.press.screw.spring=0 N"))
    while not (stage.run.engine.ctx.contact.loaded and stage.rig.plant.force_z_n > 100.0):
        stage.tick()
    stage.inject(*LANGUAGE.parse_script([f"t={stage.next_s:.6f} s: process killed"]))
    until = stage.next_s + 3.0
    while stage.next_s < until:
        stage.tick()
    assert stage.rig.plant.force_z_n > 50.0
    assert stage.rig.axes["wheel"].axis.value == stage.rig.axes["belt"].axis.value == 0.0


def test_a_drive_that_takes_no_setpoints_stops_for_want_of_our_heartbeat():
    stage = under("t=belt drive setpoints lost", 12.0)
    assert stage.rig.axes["belt"].axis.value == 0.0 or stage.mode == "run"
    assert not stage.observer.found


def test_injected_faults_are_in_the_journal_of_a_run():
    stage = started().copy()
    told: list[str] = []
    stage.ledger.event = lambda t, kind, text, *rest, **more: told.append(f"{kind}: {text}")  # type: ignore[method-assign]
    stage.inject(*LANGUAGE.parse_script([f"t={stage.next_s:.6f} s: guard opened"]))
    stage.tick()
    assert any(text.startswith("injected:") and "guard opened" in text for text in told)


def test_a_fault_waits_for_its_step():
    stage = Stage(SHORT)
    stage.inject(*LANGUAGE.parse_script(["step measure: operator stop"]))
    while not stage.run.finished:
        stage.tick()
    assert stage.run.outcome.value == "stopped"


def test_a_fault_waits_for_its_scan():
    stage = Stage(SHORT)
    stage.inject(*LANGUAGE.parse_script(["at scan 300: operator fast stop"]))
    while not stage.ended:
        stage.tick()
    assert 300 <= stage.run.engine.scans <= 303
