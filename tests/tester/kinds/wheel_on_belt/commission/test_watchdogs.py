"""Watchdogs are provoked one by one in front of a person, with their read-back values; a dead one is named."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.record import READING
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Question
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named

STEPS = named("watchdogs")


def readings(bench: Bench) -> dict[str, dict[str, object]]:
    return {one.text: dict(one.values) for one in bench.record.entries if one.what == READING}


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    bench = Bench(tmp_path_factory.mktemp("clean") / "r.jsonl", steps=STEPS)
    assert bench.run().ended is Ended.DONE
    return bench


@pytest.mark.parametrize("name", ["wheel", "belt", "press", "sideslip", "camber"])
def test_every_drive_stops_by_itself_without_our_heartbeat(clean: Bench, name: str) -> None:
    found = readings(clean)[f"heartbeat: {name} stopped by itself"]
    assert (found["object"], found["read_back_ms"], found["emergency"]) == ("0x1016:01", 200, "0x8130")
    after_ms = found["after_ms"]
    assert isinstance(after_ms, int) and 140 <= after_ms <= 260  # the last heartbeat left up to 50 ms before


@pytest.mark.parametrize("name", ["wheel", "belt", "press"])
def test_every_drive_with_a_deadline_stops_by_itself_without_setpoints(clean: Bench, name: str) -> None:
    found = readings(clean)[f"setpoints: {name} stopped by itself"]
    assert (found["object"], found["read_back_ms"], found["emergency"]) == ("0x1400:05", 200, "0x8250")
    after_ms = found["after_ms"]
    assert isinstance(after_ms, int) and 180 <= after_ms <= 260


def test_axes_that_the_rig_file_gives_no_deadline_have_none_tried(clean: Bench) -> None:
    assert not [text for text in readings(clean) if text.startswith(("setpoints: sideslip", "setpoints: camber"))]


def test_the_lease_of_the_heat_runs_out(clean: Bench) -> None:
    found = readings(clean)["heat: ended without our setpoint"]
    assert (found["kind"], found["read_back_s"], found["output_percent"]) == ("lease", 2.0, 0.0)
    after_s = found["after_s"]
    assert isinstance(after_s, float) and 2.0 <= after_s <= 4.0


def test_the_belt_creeps_at_each_proof_and_nothing_moves_before_go(tmp_path: Path) -> None:
    person = TwinPerson()
    moved: dict[str, float] = {}

    def look(world: WheelRig) -> None:
        key = person.asked[-1].key if person.asked else ""
        moved[key] = max(moved.get(key, 0.0), abs(world.belt_m_s))

    bench = Bench(tmp_path / "r.jsonl", steps=STEPS, person=person, look=look)
    assert bench.run().ended is Ended.DONE
    creep = bench.rig.arming.creep_m_s
    assert moved["watchdog heartbeat"] == pytest.approx(creep, rel=0.1)
    assert moved["watchdog setpoints"] == pytest.approx(creep, rel=0.1)
    assert moved["watchdog heat"] < 1e-6
    assert bench.world is not None and not any(drive.energised for drive in bench.world.axes.values())


class Deafens(TwinPerson):
    """Switch a watchdog off at the device before its trial, whatever the device reads back."""

    def __init__(self, at: str) -> None:
        super().__init__()
        self.key = at

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        if question.key != self.key:
            return
        if question.key == "watchdog setpoints":
            for received in self.hands.axes["belt"].pdos.rpdos:
                received.deadline_s = inf
        else:
            self.hands.jacket.lease_s = 0.0


def test_a_drive_without_a_deadline_that_works_is_named(tmp_path: Path) -> None:
    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, person=Deafens("watchdog setpoints")).run()
    assert outcome.ended is Ended.REFUSED
    assert "the belt drive did not stop with EMCY 0x8250" in outcome.text


def test_a_jacket_without_a_lease_that_works_is_named(tmp_path: Path) -> None:
    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, person=Deafens("watchdog heat")).run()
    assert outcome.ended is Ended.REFUSED
    assert "the jacket's lease did not end its heat" in outcome.text


def test_a_person_who_saw_it_run_on_is_believed(tmp_path: Path) -> None:
    class Sees(TwinPerson):
        def answer(self, question: Question) -> str:
            return "no" if question.key == "watchdog heartbeat seen" else super().answer(question)

    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, person=Sees()).run()
    assert outcome.ended is Ended.REFUSED
    assert "saw wheel or belt run on" in outcome.text


def test_a_jacket_whose_heat_a_relay_ends_is_left_to_a_person(tmp_path: Path) -> None:
    rig = believed("devices.jacket.profile=omron_e5cc", "devices.jacket.heat_off=relay")
    bench = Bench(tmp_path / "r.jsonl", steps=STEPS, rig=rig)
    outcome = bench.run()
    assert outcome.ended is Ended.DONE, outcome
    last = bench.record.last("watchdogs")
    assert last is not None and "relay" in str(last.values["heat"])


def test_a_rig_file_that_leaves_the_proof_out_is_refused(tmp_path: Path) -> None:
    rig = believed()
    rig = replace(rig, arming=replace(rig.arming, watchdog_proof=False))
    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, rig=rig).run()
    assert outcome.ended is Ended.REFUSED
    assert "arming.watchdog_proof" in outcome.text


def test_a_guard_opened_in_the_proof_stops_it(tmp_path: Path) -> None:
    def look(world: WheelRig) -> None:
        if abs(world.belt_m_s) > 0.01:
            world.axes["press"].set_guard(False)

    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, look=look).run()
    assert outcome.ended is Ended.FAILED
    assert "guard open" in outcome.text
