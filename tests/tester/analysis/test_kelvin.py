"""Sensitivity to temperature, and the coefficient at the requested temperature."""

from __future__ import annotations

from dataclasses import replace
from math import exp, hypot, sqrt

import pytest

from tester.analysis.kelvin import CONDITION_SCATTER, UNKNOWN, Slope, SurfaceWarmth, slope_of_pairs
from tester.kinds.wheel_on_belt.budget import TERMS

LAG_S, THERMOMETER_K = 0.15, 1.0 / sqrt(3.0)
STEEP = Slope(0.02, 0.003, "tried")


def bell(at_c: float) -> float:
    """A coefficient whose logarithm is a parabola: 2 %/K at 25 degC, none at 65."""
    return exp(-0.00025 * (at_c - 65.0) ** 2)


@pytest.mark.parametrize("at_c", [25.0, 40.0, 55.0])
def test_three_temperatures_give_the_slope_of_a_parabola(at_c: float) -> None:
    found = slope_of_pairs(at_c, [(t, bell(t)) for t in (25.0, 40.0, 55.0)])
    assert found is not None and found.per_kelvin == pytest.approx(-0.0005 * (at_c - 65.0))


def test_the_middle_of_three_is_known_by_the_scatter_of_its_neighbours() -> None:
    found = slope_of_pairs(40.0, [(t, bell(t)) for t in (25.0, 40.0, 55.0)])
    assert found is not None and found.u_per_kelvin == pytest.approx(CONDITION_SCATTER * sqrt(2.0) / 30.0)


def test_two_temperatures_give_their_chord_with_half_of_it_for_curvature() -> None:
    found = slope_of_pairs(25.0, [(25.0, 1.0), (35.0, exp(0.1))])
    assert found is not None and found.per_kelvin == pytest.approx(0.01)
    assert found.u_per_kelvin == pytest.approx(hypot(CONDITION_SCATTER * sqrt(2.0) / 10.0, 0.005))


def test_temperatures_close_together_are_no_pair() -> None:
    assert slope_of_pairs(25.0, [(25.0, 1.0), (27.0, 1.1)]) is None


def test_the_coefficient_is_brought_back_by_offset_and_lag() -> None:
    warm = SurfaceWarmth(55.0, 56.0, 2.0, STEEP)
    assert warm.correction(TERMS) == pytest.approx(exp(-0.02 * (1.0 + LAG_S * 2.0)))


def test_without_a_known_sensitivity_nothing_is_corrected() -> None:
    assert SurfaceWarmth(55.0, 56.0, 2.0, UNKNOWN).correction(TERMS) == 1.0


def test_the_sensitivity_s_own_uncertainty_counts_over_offset_and_thermometer() -> None:
    found = SurfaceWarmth(55.0, 56.0, 0.0, STEEP).contribution(0.8, TERMS)
    assert found.standard == pytest.approx(0.003 * 0.8 * hypot(1.0, THERMOMETER_K))


def test_an_unknown_sensitivity_is_named_with_its_2_6_percent_a_kelvin() -> None:
    found = SurfaceWarmth(55.0, 55.0, 0.0, UNKNOWN).contribution(0.8, TERMS)
    assert found.standard == pytest.approx(0.026 * 0.8 * THERMOMETER_K) and "2.6 %/K" in found.source


def test_a_temperature_that_was_not_measured_moves_nothing() -> None:
    assert SurfaceWarmth(slope=STEEP).correction(TERMS) == 1.0


def test_at_the_end_of_three_the_parabola_s_departure_from_the_chord_counts() -> None:
    """Weights of the derivative at 25 degC by hand; slopes 2 %/K at 25 degC and 1.25 %/K in the mean."""
    found = slope_of_pairs(25.0, [(t, bell(t)) for t in (25.0, 40.0, 55.0)])
    scattered = CONDITION_SCATTER * sqrt(0.1**2 + (2.0 / 15.0) ** 2 + (1.0 / 30.0) ** 2)
    assert found is not None and found.u_per_kelvin == pytest.approx(hypot(scattered, 0.0075 / sqrt(3.0)))


def test_a_slope_that_is_only_a_prior_corrects_nothing() -> None:
    assert SurfaceWarmth(55.0, 56.0, 2.0, replace(STEEP, known=False)).correction(TERMS) == 1.0
