"""Scatter of wheels, conditions and repeats, and the sigma that is stated of it."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace

import pytest

from sim.machines.wheel_on_belt.scatter import condition_factor, run_factor, stated_sigma, wheel_factor
from sim.noise import Autoregressive, NormalStream
from sim.physics.parameters import SimParameters

QUIET = replace(SimParameters(), scatter=0.0)


def test_wheels_scatter_by_their_sigma() -> None:
    factors = [wheel_factor(SimParameters(), 1, 1, wheel) for wheel in range(1500)]
    assert statistics.stdev(factors) == pytest.approx(0.03, rel=0.06)


@pytest.mark.parametrize(("compound", "sigma"), [("1#", 0.032), ("2#", 0.042), ("3#", 0.059)])
def test_conditions_scatter_by_the_sigma_of_the_compound(compound: str, sigma: float) -> None:
    factors = [condition_factor(SimParameters(), 1, compound, condition) for condition in range(1500)]
    assert statistics.stdev(factors) == pytest.approx(sigma, rel=0.06)


def test_repeats_scatter_by_their_sigma() -> None:
    factors = [run_factor(SimParameters(), 1, 1, 1, 1, repeat, 1) for repeat in range(1500)]
    assert statistics.stdev(factors) == pytest.approx(0.02, rel=0.06)


def test_scatter_scaled_to_nothing_is_exactly_one() -> None:
    assert wheel_factor(QUIET, 1, 1, 1) == condition_factor(QUIET, 1, "1#", 1) == 1.0
    assert run_factor(QUIET, 1, 1, 1, 1, 1, 1) == 1.0


def test_stated_sigma_is_what_the_means_of_repeats_scatter_by() -> None:
    parameters, window_s, process = SimParameters(), 10.6, Autoregressive(0.01, 0.3)
    process.retime(0.1)
    means: list[float] = []
    for seed in range(250):
        fixed = wheel_factor(parameters, seed, 1, 1) * condition_factor(parameters, seed, "1#", 1)
        repeats: list[float] = []
        for repeat in range(3):
            stream = NormalStream(seed, "within", 1, 1, 1, repeat, 1)
            process.restart(stream.next())
            within = statistics.fmean(process.step(stream.next()) for _ in range(106))
            repeats.append(fixed * run_factor(parameters, seed, 1, 1, 1, repeat, 1) * (1.0 + within))
        means.append(statistics.fmean(repeats))
    assert statistics.stdev(means) == pytest.approx(stated_sigma(parameters, "1#", 3, window_s), rel=0.12)


def test_stated_sigma_of_one_short_run_has_every_part() -> None:
    parts = (0.03, 0.059, 0.02, 0.01)
    assert stated_sigma(SimParameters(), "3#", 1, 1e-4) == pytest.approx(math.hypot(*parts), rel=1e-4)


def test_stated_sigma_keeps_what_repeats_cannot_average_out() -> None:
    parameters = SimParameters()
    assert stated_sigma(parameters, "2#", 10_000, 60.0) == pytest.approx(math.hypot(0.03, 0.042), rel=1e-3)
    assert stated_sigma(QUIET, "2#", 5, 60.0) == 0.0
    assert stated_sigma(replace(parameters, scatter=2.0), "2#", 5, 60.0) == pytest.approx(
        2.0 * stated_sigma(parameters, "2#", 5, 60.0)
    )
