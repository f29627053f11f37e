"""Events of a run, row by row, on both packaged rigs."""

from __future__ import annotations

from math import isfinite

import pytest

from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.procedures.slide import Stationary
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import DISC, GROSCH, TrackBench


@pytest.fixture(scope="module", params=["grosch", "pin-on-disc"])
def done(request: pytest.FixtureRequest) -> TrackBench:
    """A short run without scatter, done to its end."""
    return TrackBench(request.param, overrides=("sim.scatter=0",)).to_the_end()


def test_it_comes_to_its_end_without_a_trip(done: TrackBench) -> None:
    assert done.run.outcome is Outcome.DONE and done.kept.trips == []


def test_its_rows_are_the_law(done: TrackBench) -> None:
    steps = {step.condition: step for step in done.plan.conditions()}
    for condition, result in done.kept.results:
        held = held_by(steps[condition].setpoint)
        sim = done.config.sim
        law = sim.contact.through(sim.friction_of("SBR"), held.interface)  # type: ignore[arg-type]
        mu = law.mu(23.0, held.load_n, held.track_m_s)
        assert result.valid and result.mu_resultant == pytest.approx(mu, rel=0.02)


def test_every_repeat_begins_with_a_tare_and_ends_raised(done: TrackBench) -> None:
    assert len(done.kept.tares) == len(done.kept.results) == 2
    assert done.world.lift_mm == pytest.approx(done.config.arm.raised_mm, abs=0.3) and done.world.track_m_s == 0.0


def test_a_linear_track_is_gone_there_and_back_and_a_disc_one_way(done: TrackBench) -> None:
    assert {result.bursts for _, result in done.kept.results} == {2 if done.config.linear else 1}


def test_the_track_is_at_rest_whenever_the_arm_moves_or_the_cell_is_not_tared() -> None:
    bench = TrackBench("grosch")
    while not bench.run.finished:
        bench.tick()
        if 0.3 < bench.world.lift_mm < 9.7 or (bench.world.plant.load_n > 0.0 and not bench.kept.tares):
            assert bench.world.track_m_s == 0.0, bench.now


def test_the_track_turns_back_before_the_end_of_its_travel() -> None:
    text = GROSCH.replace("distance: 0.4 mm", "distance: 120 mm").replace("[0.1 mm/s, 3 mm/s]", "10 mm/s")
    bench = TrackBench("grosch", text)
    far, near = 0.0, 300.0
    while not bench.run.finished:
        bench.tick()
        place_mm = bench.world.axes["track"].axis.position
        far, near = max(far, place_mm), min(near, place_mm)
    assert bench.run.outcome is Outcome.DONE and bench.kept.trips == []
    limits = bench.config.limits
    assert near > limits.travel_low_mm and 0.9 * limits.travel_high_mm < far < limits.travel_high_mm


def test_a_person_is_asked_for_weights_interface_and_arm_with_the_drives_off() -> None:
    bench = TrackBench("pin-on-disc")
    bench.prompts.automatic = False
    asked: list[str] = []
    while not bench.run.finished and len(asked) < 6:
        bench.tick()
        waiting = bench.prompts.waiting
        if waiting is not None:
            assert bench.run.engine.ctx.readings.drives_disabled and bench.world.track_m_s == 0.0
            asked.append(waiting.text)
            waiting.answer = "yes"
    assert asked[:5] == [
        "put specimen 1 on the arm and raise it: SBR",
        "hang 10 N of weights on the arm and make the track clean and dry",
        "lower the arm",
        "raise the arm",
        "make the track wet",
    ]


def test_a_hold_raises_the_arm_and_the_repeat_is_made_again() -> None:
    bench = TrackBench("grosch").phase("slide")
    assert bench.run.request_hold() == ""
    bench.until(lambda one: one.world.lift_mm > 9.7, bench.now + 5.0)
    assert bench.world.track_m_s == 0.0 and bench.run.request_release() == ""
    bench.to_the_end()
    assert bench.run.outcome is Outcome.DONE and [c for c, r in bench.kept.results if r.valid] == [1, 2]


def test_air_that_is_not_reached_leaves_no_value() -> None:
    text = DISC.replace("temperature: 23 degC", "temperature: 40 degC").replace("for: 1 s", "for: 1 s, at_most: 20 s")
    bench = TrackBench("pin-on-disc", text).to_the_end()
    assert bench.run.outcome is Outcome.DONE and bench.kept.results == []
    assert any("not reached" in text for _, kind, text in bench.kept.events if kind == "condition")


@pytest.mark.parametrize(("friction", "after"), [((10.0,) * 6, 4), ((20.0, 15.0, 12.0, 10.1, 10.09, 10.08, 10.0), 7)])
def test_friction_is_stationary_once_three_stretches_are_alike(friction: tuple[float, ...], after: int) -> None:
    stationary = Stationary(0.5)
    stationary.begin(7.0)
    found = [stationary.add(7.0 - number, one) for number, one in enumerate((*friction, friction[-1]))]
    assert found.index(True) == after - 1 if True in found else not isfinite(after)
