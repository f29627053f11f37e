"""The end of a settling temperature, from its tail, with a valid uncertainty."""

from __future__ import annotations

from math import exp, isnan

import pytest

from sim.noise import NormalStream
from tester.kinds.wheel_on_belt.commission.settling import MEAN_S, SettlingFit

END_C, STEP_K, TIME_S, RISE_S = 34.0, 12.0, 120.0, 40.0
NOISE_K = 0.07
"""Of a mean of five seconds: 0.5 K of noise, ten readings a second."""


def temperature(t: float) -> float:
    """Return the surface over a hub that was heated: two modes, the faster one opposed, so that it starts flat."""
    slow, fast = TIME_S / (TIME_S - RISE_S), RISE_S / (TIME_S - RISE_S)
    return END_C - STEP_K * (slow * exp(-t / TIME_S) - fast * exp(-t / RISE_S))


def settled(seed: int, sure_k: float) -> tuple[float, float, float]:
    """Return the end, its standard uncertainty, and the time when that was reached, s."""
    noise, fit = NormalStream(seed, "settling"), SettlingFit()
    for number in range(200):
        fit.add(temperature(MEAN_S * number) + NOISE_K * noise.next())
        end, standard = fit.going()
        if standard <= sure_k:
            return end, standard, MEAN_S * number
    raise AssertionError("never settled")


def test_the_end_is_known_before_it_is_there() -> None:
    ends = [settled(seed, 0.3) for seed in range(40)]
    assert max(t for _, _, t in ends) < 3.5 * TIME_S
    assert sum(abs(end - END_C) for end, _, _ in ends) / len(ends) < 0.5


def test_the_uncertainty_holds() -> None:
    off = [abs(end - END_C) / standard for end, standard, _ in (settled(seed, 0.1) for seed in range(60))]
    assert sum(one <= 2.0 for one in off) >= 0.8 * len(off)
    assert sum(one <= 3.0 for one in off) >= 0.95 * len(off)


def test_an_unsettled_course_has_no_end() -> None:
    fit = SettlingFit()
    for number in range(60):
        fit.add(20.0 + 0.5 * number)
    assert all(isnan(one) for one in fit.going())


def test_a_minute_is_too_little() -> None:
    fit = SettlingFit()
    for number in range(12):
        fit.add(temperature(MEAN_S * number))
    assert isnan(fit.going()[1])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_cooling_is_as_good_as_warming(sign: float) -> None:
    fit = SettlingFit()
    for number in range(120):
        fit.add(sign * temperature(MEAN_S * number))
    assert fit.going()[0] == pytest.approx(sign * END_C, abs=0.1)
