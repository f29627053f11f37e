"""Leaps on a wheel: its rest and its cool-downs pass without scans, and later measurements stay the same."""

from __future__ import annotations

from dataclasses import fields
from math import inf, pi

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.machine.run import Outcome
from tester.machine.state import Mode
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

RESTED = SHORT.replace("25 degC", "50 degC").replace("measure:", "rest: {at_least: 2 min}\nmeasure:")


def results(run: Simulation) -> list[tuple[float, float]]:
    """Return coefficient and temperature (degC) of each repeat."""
    stored = [row for row in run.notes.fields("UPDATE repeat SET") if "mu_resultant" in row]
    return [(float(str(row["mu_resultant"])), float(str(row["surface_c"]))) for row in stored]


@pytest.fixture(scope="module", params=[0, 1])
def both(request: pytest.FixtureRequest) -> tuple[Simulation, Simulation]:
    """A run in which every scan is made, and the same run with leaps."""
    seed: int = request.param
    return Simulation(RESTED, seed=seed).to_the_end(), Simulation(RESTED, seed=seed).leaping().to_the_end()


def test_results_are_those_of_a_run_with_every_scan(both: tuple[Simulation, Simulation]) -> None:
    every, leapt = both
    assert leapt.run.outcome is every.run.outcome is Outcome.DONE
    assert len(results(every)) == len(results(leapt)) == 1
    for (mu, surface_c), (other_mu, other_c) in zip(results(every), results(leapt), strict=True):
        assert other_mu == pytest.approx(mu, rel=1e-9)
        assert other_c == pytest.approx(surface_c, abs=1e-6)


def test_most_of_the_rest_and_of_the_last_cooling_is_leapt(both: tuple[Simulation, Simulation]) -> None:
    every, leapt = both
    rest_s, cooling_s = (float(text.split()[0]) for text in leapt.notes.texts("leap"))
    assert rest_s > 0.6 * 120.0
    assert cooling_s > 100.0
    assert leapt.run.engine.leapt_s == pytest.approx(rest_s + cooling_s, abs=1.0)
    assert not every.notes.texts("leap")
    assert leapt.now == pytest.approx(every.now, abs=15.0)  # noise decides when the hub is cool


def test_nothing_is_leapt_in_contact_or_while_the_heat_is_on() -> None:
    bench = Simulation(RESTED).leaping()
    leaps = bench.leaps
    assert leaps is not None
    bench.until(lambda it: it.ctx.progress.phase.startswith("soak") and it.run.engine.period_s > 0.04)
    before_s = bench.run.engine.leapt_s
    assert "loaded" in leaps.hindered(bench.now)
    bench.until(lambda it: it.run.engine.control.state.mode is Mode.STOPPING)
    assert bench.run.engine.leapt_s == before_s


def test_a_fast_stop_ends_the_renewal_of_a_cool_down_at_once() -> None:
    bench = Simulation(RESTED).leaping()
    bench.until(lambda it: it.run.engine.control.state.mode is Mode.COOLDOWN and it.run.engine.renewing)
    asked_s = bench.now
    bench.run.request_stop("asked", fast=True)
    bench.until(lambda it: it.run.engine.last_scan_s >= asked_s)
    assert bench.run.engine.last_scan_s - asked_s < 0.06
    assert bench.run.engine.control.state.mode is Mode.FAST_STOP


def test_the_wheel_turns_on_while_its_encoder_stands_still() -> None:
    bench = Simulation(RESTED).leaping()
    engine, plant = bench.run.engine, bench.world.plant
    bench.until(lambda it: it.run.engine.control.state.mode is Mode.COOLDOWN and it.run.engine.renewing)
    leapt_s, turns, shown = engine.leapt_s, plant.wheel_angle_rev, bench.ctx.readings.wheel_angle_rev
    bench.until(lambda it: it.run.engine.leapt_s > leapt_s, at_most_s=5000.0)
    leap_s = engine.leapt_s - leapt_s
    turned, seen = plant.wheel_angle_rev - turns, bench.ctx.readings.wheel_angle_rev - shown
    rev_s = bench.world.wheel_rad_s / (2.0 * pi)
    assert turned - seen == pytest.approx(leap_s * rev_s, rel=0.15)


def test_every_time_stamp_of_the_readings_moves_with_a_leap() -> None:
    r = Readings()
    stamps = [one.name for one in fields(r) if one.name.endswith("_s") and getattr(r, one.name) in (0.0, -inf)]
    for name in stamps:
        setattr(r, name, 5.0)
    r.later(9.0)
    assert {name for name in stamps if getattr(r, name) != 14.0} <= {"leapt_s"}
