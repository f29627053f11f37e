"""Device parameters: a start names those that differ from the last good run on the rig."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.kinds import load_rig
from tester.machine.run import Outcome
from tester.run.part_run import RunNotes
from tester.run.provenance import read_back
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.set_up import NAMED, DeviceParameter, GoodRun, last_good_run, stored
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT, Simulation
from tests.tester.run.test_session import Screen, run

BRIEF = SHORT.replace("window: 14 rev", "window: 4 rev")


@pytest.fixture(scope="module")
def connected() -> Simulation:
    """A run whose drives are set up, before anything moves."""
    return Simulation(BRIEF, QUIET).until(lambda one: one.run.connected)


def good(simulation: Simulation) -> GoodRun:
    engine = simulation.run.engine
    return GoodRun("yesterday", stored(engine.ctx.rig, read_back(engine.ctx.rig, engine.devices, 0.0)))


def told(simulation: Simulation, before: GoodRun) -> str:
    engine = simulation.run.engine
    return before.differences(engine.ctx.rig, read_back(engine.ctx.rig, engine.devices, 1.0))


def test_a_rig_as_it_was_is_not_spoken_of(connected: Simulation) -> None:
    assert told(connected, good(connected)) == ""


def test_an_exchanged_drive_is_named_with_both_serial_numbers(connected: Simulation) -> None:
    before = good(connected)
    belt = dict(before.devices["belt"]) | {"0x1018:04": DeviceParameter("77", "serial number")}
    found = told(connected, GoodRun("yesterday", {**before.devices, "belt": belt}))
    assert found == "differs from the last good run yesterday: belt 0x1018:04 (serial number): was 77, is 2"


def test_an_unread_parameter_is_no_difference(connected: Simulation) -> None:
    before = good(connected)
    belt = dict(before.devices["belt"]) | {"0x607E:00": DeviceParameter("64", "polarity")}
    assert told(connected, GoodRun("yesterday", {"belt": belt, "lost": belt})) == ""


def test_of_many_differences_some_are_reported_and_their_number(connected: Simulation) -> None:
    before = good(connected)
    other = {key: DeviceParameter("-1") for key in before.devices["belt"]}
    found = told(connected, GoodRun("yesterday", {"belt": other}))
    assert found.count("was -1") == NAMED
    assert found.endswith(f"; and {len(other) - NAMED} more")


def test_a_start_warns_in_its_record_and_on_the_screen_and_continues() -> None:
    simulation = Simulation(BRIEF, QUIET)
    said: list[str] = []
    before = GoodRun("yesterday", {"belt": {"0x6076:00": DeviceParameter("1", "rated torque")}})
    notes = RunNotes(simulation.run, simulation.notes, before, said.append)  # type: ignore[arg-type]
    simulation.until(lambda one: one.run.connected)
    notes.poll(simulation.now)
    notes.poll(simulation.now)
    (text,) = said
    assert text.startswith("warning: differs from the last good run yesterday: belt 0x6076:00")
    assert [event[2] for event in simulation.notes.events if event[1] == "arming" and event[3] == "warning"] == [
        text.removeprefix("warning: ")
    ]
    assert simulation.to_the_end().run.outcome is Outcome.DONE


def test_the_last_good_run_is_found_and_handed_to_the_next_on_real_wires(tmp_path: Path) -> None:
    rig = load_rig()
    assert last_good_run(rig, tmp_path / "runs") is None
    done = run(tmp_path, *QUIET, text=BRIEF)
    found = last_good_run(rig, done.out)
    assert found is not None
    assert found.name == done.folder.name
    assert found.devices["belt"]["0x1018:04"].value == "2"     # read while connecting and at the end
    assert found.devices["belt"]["0x6076:00"].name == "motor rated torque (mN m)"
    assert last_good_run(replace(rig, rig="another"), done.out) is None
    session = Session(SessionOptions(recipe="", out=done.out), Screen())
    wired = replace(rig, can=replace(rig.can, interface="virtual"))
    assert session._job(done.out / "next", 0, wired).good == found
    assert session._job(done.out / "next", 0, rig).good is None
