"""The steps of a track's commissioning on the twin: clean rigs pass, and faults are refused with a remedy."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tester.kinds.specimen_on_track.commission.first import recipe_of
from tester.kinds.specimen_on_track.commission.twin import TrackPerson
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Asks, Question
from tests.campaigns.mistakes.by_track import DISC, GROSCH, MISTAKES, ON_WIRES, clean
from tests.campaigns.mistakes.mistake import Mistake
from tests.tester.kinds.specimen_on_track.commission.track_twin import TrackTwin, believed

FEW = re.compile("cell sign|not balanced|dead|another radius|lift reversed|height sensor")
QUICK = [one for one in MISTAKES if FEW.search(one.name)]


@pytest.mark.parametrize("kind", [GROSCH, DISC])
def test_a_clean_rig_passes_every_step_on_the_wires_in_less_than_half_an_hour(tmp_path: Path, kind: str) -> None:
    twin = TrackTwin(tmp_path / "r.jsonl", rig=believed(kind), steps=ON_WIRES)
    outcome = twin.run()
    assert outcome.ended is Ended.DONE, outcome
    assert outcome.rig_s < 30 * 60
    force, zero = twin.record.last("force"), twin.record.last("zero")
    assert force is not None and all(abs(gain - 1.0) < 0.001 for gain in force.values["gains"].values())
    assert zero is not None and abs(zero.values["drag_n"]) < 0.02
    height = twin.record.last("height")
    assert height is not None
    assert ("zero_mm" in height.values) is (kind == DISC)


@pytest.mark.parametrize("mistake", QUICK, ids=lambda one: one.name)
def test_a_mistake_is_named(mistake: Mistake) -> None:
    found = mistake.find(1)
    assert any(re.search(mistake.named_by, text) for text in found), found


def test_the_track_moves_only_by_keys_and_has_power_only_then(tmp_path: Path) -> None:
    twin = TrackTwin(tmp_path / "r.jsonl", rig=believed(GROSCH), steps=("jog track", "travel"))
    powered: list[bool] = []

    class Watches(TrackPerson):
        def put(self, question: Question) -> None:
            if twin.world is not None:
                powered.append(any(drive.energised for drive in twin.world.axes.values()))
            super().put(question)

    twin.person = Watches()
    assert twin.run().ended is Ended.DONE
    assert len(powered) > 20 and not any(powered)


def test_weights_that_cannot_pull_backward_are_left_out(tmp_path: Path) -> None:
    class OneWay(TrackPerson):
        def answer(self, question: Question) -> str:
            one_way = question.key == "possible back" and question.asks is Asks.CHOICE
            return "no" if one_way else super().answer(question)

    twin = TrackTwin(tmp_path / "r.jsonl", rig=believed(DISC), steps=("force",), person=OneWay())
    assert twin.run().ended is Ended.DONE
    entry = twin.record.last("force")
    assert entry is not None and list(entry.values["gains"]) == ["forward"]


def test_the_first_condition_is_within_the_rig() -> None:
    rig = believed(DISC)
    _, speed, load, temperature_c = recipe_of(rig, "SBR")
    assert rig.limits.slowest_m_s <= speed <= rig.limits.track_speed_m_s
    assert load in rig.weights and temperature_c == rig.ambient_c


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(10))
def test_nothing_is_found_on_clean_rigs(seed: int) -> None:
    assert clean(seed) == []
