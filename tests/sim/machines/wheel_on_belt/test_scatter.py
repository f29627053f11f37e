"""Scatter of wheels, conditions and repeats, and the sigma that is stated of it."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace
from typing import Any

import pytest

from sim.machines.wheel_on_belt.rubbing import WheelSetting, condition_factor, run_factor, wheel_factor
from sim.noise import Autoregressive, NormalStream
from sim.physics.parameters import SimParameters
from tests.campaigns.acceptance.sigma import stated_sigma

QUIET = replace(SimParameters(), scatter=0.0)
MIDDLE = WheelSetting(0.3, 200.0, (0.0, 0.0), 40.0)


def test_wheels_scatter_by_their_sigma() -> None:
    factors = [wheel_factor(SimParameters(), 1, 1, wheel) for wheel in range(1500)]
    assert statistics.stdev(factors) == pytest.approx(0.03, rel=0.06)


@pytest.mark.parametrize(("compound", "sigma"), [("1#", 0.032), ("2#", 0.042), ("3#", 0.059)])
def test_conditions_scatter_by_the_sigma_of_the_compound(compound: str, sigma: float) -> None:
    factors = [
        condition_factor(SimParameters(), 1, compound, MIDDLE._replace(load_n=50.0 + 0.1 * i)) for i in range(1500)
    ]
    assert statistics.stdev(factors) == pytest.approx(sigma, rel=0.06)


def factor(setting: WheelSetting, compound: str = "1#", seed: int = 1) -> float:
    return condition_factor(SimParameters(), seed, compound, setting)


def test_a_setting_has_one_factor_of_its_compound_and_seed() -> None:
    assert factor(MIDDLE) == factor(WheelSetting(0.3, 200.0, (0.0, 0.0), 40.0))
    assert len({factor(MIDDLE), factor(MIDDLE, "2#"), factor(MIDDLE, seed=2)}) == 3


@pytest.mark.parametrize("other", [
    {"slip_m_s": 0.2}, {"load_n": 100.0}, {"angles_deg": (5.0, 0.0)}, {"angles_deg": (0.0, 2.0)},
    {"temperature_c": 55.0},
])  # fmt: skip
def test_each_of_its_values_distinguishes_settings(other: dict[str, Any]) -> None:
    assert factor(MIDDLE._replace(**other)) != factor(MIDDLE)


def test_the_last_digits_of_a_float_and_the_way_of_sliding_make_no_other_setting() -> None:
    assert factor(WheelSetting(0.1 + 0.2, 200.0 + 1e-9, (0.0, -0.0), 40.0 - 1e-12)) == factor(MIDDLE)
    turned = MIDDLE._replace(angles_deg=(5.0, 0.0))
    assert factor(turned._replace(slip_m_s=-0.3, angles_deg=(-5.0, 0.0))) == factor(turned)


def test_the_coldest_setting_that_a_recipe_may_ask_for_has_a_factor() -> None:
    assert factor(MIDDLE._replace(temperature_c=-50.0)) > 0.5


def test_repeats_scatter_by_their_sigma() -> None:
    factors = [run_factor(SimParameters(), 1, 1, 1, 1, repeat, 1) for repeat in range(1500)]
    assert statistics.stdev(factors) == pytest.approx(0.02, rel=0.06)


def test_scatter_scaled_to_nothing_is_exactly_one() -> None:
    assert wheel_factor(QUIET, 1, 1, 1) == condition_factor(QUIET, 1, "1#", MIDDLE) == 1.0
    assert run_factor(QUIET, 1, 1, 1, 1, 1, 1) == 1.0


def test_stated_sigma_is_the_scatter_of_the_means_of_repeats() -> None:
    parameters, window_s, process = SimParameters(), 10.6, Autoregressive(0.01, 0.3)
    process.retime(0.1)
    means: list[float] = []
    for seed in range(250):
        fixed = wheel_factor(parameters, seed, 1, 1) * condition_factor(parameters, seed, "1#", MIDDLE)
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


def test_stated_sigma_keeps_errors_that_repeats_cannot_average_out() -> None:
    parameters = SimParameters()
    assert stated_sigma(parameters, "2#", 10_000, 60.0) == pytest.approx(math.hypot(0.03, 0.042), rel=1e-3)
    assert stated_sigma(QUIET, "2#", 5, 60.0) == 0.0
    assert stated_sigma(replace(parameters, scatter=2.0), "2#", 5, 60.0) == pytest.approx(
        2.0 * stated_sigma(parameters, "2#", 5, 60.0)
    )
