"""The simulated track's surfaces and talc, from the recipe to the rows."""

from __future__ import annotations

import pytest

from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.recipe.plan_steps import Cover, Prepare
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import GROSCH, TrackBench

TRACKS = GROSCH.replace("{name: one, ", "{name: clean, surface: [wavy glass, silicon carbide], ") + (
    "  - {name: talc, surface: silicon carbide, interface: talc, load: 20 N, temperature: 23 degC,"
    " track_speed: [0.1 mm/s, 3 mm/s]}\n"
)


@pytest.fixture(scope="module")
def done() -> TrackBench:
    return TrackBench("grosch", TRACKS.replace("0.1 mm/s", "1 mm/s").replace("3 mm/s", "10 mm/s"),
                      ("sim.scatter=0", "sim.sensors.air_bias=0")).leaping().to_the_end()  # fmt: skip


def test_every_track_is_measured_without_a_trip(done: TrackBench) -> None:
    assert done.run.outcome is Outcome.DONE and not done.kept.trips
    assert [result.valid for _, result in done.kept.results] == [True] * 6


def test_glass_adheres_most_and_talc_takes_that_much_more_than_the_rest(done: TrackBench) -> None:
    steps = {step.condition: held_by(step.setpoint) for step in done.plan.conditions()}
    mu = {
        (steps[number].surface, steps[number].interface, steps[number].track_m_s): result.mu_resultant
        for number, result in done.kept.results
    }
    slow = {track: mu[*track, 1e-3] for track in {key[:2] for key in mu}}
    glass, dry, talc = (slow[key] for key in (("wavy glass", "dry"), ("silicon carbide", "dry"),
                                              ("silicon carbide", "talc")))  # fmt: skip
    assert glass == pytest.approx(2.2, rel=0.05) and dry == pytest.approx(1.35, rel=0.05)
    assert talc / dry < 0.4 < 0.5 < mu["silicon carbide", "talc", 1e-2] / mu["silicon carbide", "dry", 1e-2]


def test_talc_has_a_cover_of_its_own_after_the_clean_tracks(done: TrackBench) -> None:
    asked = [step.surface if isinstance(step, Cover) else step.interface for step in done.plan.steps
             if isinstance(step, Cover | Prepare)]  # fmt: skip
    assert asked == ["wavy glass", "dry", "silicon carbide", "silicon carbide", "talc"]
