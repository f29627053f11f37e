"""The standstill relay is provoked by a halted belt and a halted wheel; a relay that does not act is named."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt import standstill_relay
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.commission_step import CommissionStep
from tester.machine.commission.person import Walk
from tester.machine.commission.step_engine import CommissionOutcome, Ended
from tester.machine.prompts import Question
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named, nothing

STEPS = named("relay")


def tried(
    path: Path, *keys: str, twin: tuple[str, ...] = (), built: Callable[[WheelRig], None] = nothing, seed: int = 0,
    person: TwinPerson | None = None, look: Callable[[WheelRig], None] = nothing,
) -> tuple[Bench, CommissionOutcome]:  # fmt: skip
    bench = Bench(path / "r.jsonl", seed, rig=believed(*keys), machine=believed(*twin), steps=STEPS, built=built,
                  person=person, look=look)  # fmt: skip
    return bench, bench.run()


@pytest.mark.parametrize("seed", range(3))
def test_a_relay_that_acts_passes_with_its_times(tmp_path: Path, seed: int) -> None:
    fastest: list[float] = []
    deepest: list[float] = []

    def look(world: WheelRig) -> None:
        fastest.append(max(abs(world.rim_m_s), abs(world.belt_m_s)))
        deepest.append(world.plant.force_z_n)

    bench, outcome = tried(tmp_path, seed=seed, look=look)
    assert outcome.ended is Ended.DONE, outcome.text
    entry = bench.record.last("relay")
    assert entry is not None
    assert all(0 < entry.values[part]["after_ms"] <= 60 for part in ("belt", "wheel"))
    assert max(fastest) < 0.25 and max(deepest) == 0.0
    assert bench.world is not None and not any(drive.energised for drive in bench.world.axes.values())


def test_a_rig_that_states_none_has_none_provoked(tmp_path: Path) -> None:
    bench, outcome = tried(tmp_path, "arming.standstill_relay=false", twin=("sim.standstill_relay=false",))
    assert outcome.ended is Ended.DONE
    assert not any(question.key.startswith("relay") for question in bench.person.asked)


def test_a_relay_that_is_not_there_is_named_and_not_confirmed(tmp_path: Path) -> None:
    _, outcome = tried(tmp_path, twin=("sim.standstill_relay=false",))
    assert outcome.ended is Ended.REFUSED
    assert "the belt stood" in outcome.text and "arming.standstill_relay: true is not confirmed" in outcome.text


def test_a_relay_that_sees_and_does_not_act_is_named(tmp_path: Path) -> None:
    def built(world: WheelRig) -> None:
        assert world.relay is not None
        world.relay.works = False

    assert "not confirmed" in tried(tmp_path, built=built)[1].text


@pytest.mark.parametrize("drive", ["wheel", "belt"])
def test_a_drive_that_the_relay_does_not_reach_is_named(tmp_path: Path, drive: str) -> None:
    def built(world: WheelRig) -> None:
        assert world.relay is not None
        world.relay.reaches.remove(drive)

    assert f"the torque of the {drive} drive was on" in tried(tmp_path, built=built)[1].text


def test_a_relay_that_is_late_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standstill_relay, "REACTS_S", 0.2)
    assert "50 ms are allowed" in tried(tmp_path)[1].text


@pytest.mark.parametrize("step", ["spring", "watchdogs", "relay"])
def test_a_screen_shows_readings_throughout(tmp_path: Path, step: str) -> None:
    shown: set[str] = set()

    class Looks(TwinPerson):
        def look(self, step: CommissionStep, walk: Walk) -> None:
            super().look(step, walk)
            if step.readings is not None and walk.seat.ready:
                shown.update(one.label for one in step.readings(walk.seat))

    bench = Bench(tmp_path / "r.jsonl", steps=named(step), person=Looks())
    assert bench.run().ended is Ended.DONE
    assert shown


def test_a_belt_that_does_not_turn_is_not_the_relays_fault(tmp_path: Path) -> None:
    def look(world: WheelRig) -> None:
        if world.rim_m_s > 0.01:
            world.axes["belt"].block(True)

    text = tried(tmp_path, look=look)[1].text
    assert "not provoked: the belt turns at 0.000 m/s" in text and "not confirmed" not in text


def test_a_person_who_saw_no_relay_is_believed(tmp_path: Path) -> None:
    class Sees(TwinPerson):
        def answer(self, question: Question) -> str:
            return "no" if question.key == "relay seen" else super().answer(question)

    assert "did not see the relay act" in tried(tmp_path, person=Sees())[1].text
