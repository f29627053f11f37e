"""Peaks, exponents and signs of a fitted law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from tester.analysis.fit.fit_law import FitPoint, Law, Source, Variable
from tester.analysis.fit.resample import Resamples
from tester.analysis.fit.trends import Trend, trends_of
from tests.tester.analysis.fit.straight import LINE

XS = [0.1 * i for i in range(1, 11)]
POINTS = [FitPoint("", "one", (x, 20.0), (x, 20.0), 1.0, Source("a")) for x in [*XS, 0.5]]


def law(value: Callable[..., object]) -> Law:
    return replace(LINE, variables=(Variable("x", "m"), LINE.variables[1]), value=value)  # type: ignore[arg-type]


def trend(value: Callable[..., object], resamples: Sequence[Sequence[float]], fitted: Sequence[float]) -> Trend:
    found = trends_of(law(value), POINTS, fitted, Resamples(np.array(resamples, dtype=float), len(resamples)))
    (only,) = found.each  # the other variable was not varied
    return only


def power(p, x):
    return p[..., 0, None] * x[..., 0] ** p[..., 1, None]


def bell(p, x):
    return 1.0 + p[..., 0, None] * np.exp(-((x[..., 0] - p[..., 1, None]) ** 2) / 0.02)


def test_the_exponent_of_a_power_law_is_its_own() -> None:
    found = trend(power, [(1.0, -0.4 + 0.01 * i) for i in range(-5, 6)], (1.0, -0.4))
    assert found.exponent == pytest.approx(-0.4, abs=1e-6)
    assert found.exponent_interval == pytest.approx((-0.4475, -0.3525), abs=1e-4)
    assert found.word == "falls" and np.isnan(found.peak) and found.inside == 0.0


def test_a_sign_on_which_resamples_do_not_agree_is_not_resolved() -> None:
    found = trend(power, [(1.0, 0.1), (1.0, 0.2), (1.0, -0.1)], (1.0, 0.1))
    assert found.agree == pytest.approx(2.0 / 3.0) and found.word == "not resolved from none"


def test_a_peak_inside_the_range_is_found_with_its_interval() -> None:
    found = trend(bell, [(0.5, 0.6 + 0.001 * i) for i in range(-20, 21)], (0.5, 0.6))
    assert found.peak == pytest.approx(0.6, abs=0.003)
    assert found.peak_interval == pytest.approx((0.581, 0.619), abs=0.004)
    assert found.inside == 1.0 and found.word == "rises to a peak, then falls"


def test_a_largest_value_at_the_end_of_the_range_is_no_peak() -> None:
    assert np.isnan(trend(bell, [(0.5, 1.2)] * 3, (0.5, 1.2)).peak)


def test_a_peak_in_some_resamples_only_is_not_resolved() -> None:
    found = trend(bell, [(0.5, 0.6), (0.5, 1.2)], (0.5, 0.6))
    assert found.inside == 0.5 and found.word.startswith("not resolved")


def test_trends_are_reported_at_the_values_that_most_conditions_share() -> None:
    found = trends_of(law(power), POINTS, (1.0, 0.3), Resamples(np.empty((0, 2)), 1))
    assert found.at == (0.5, 20.0)


def test_a_variable_without_a_true_zero_has_a_slope_and_no_exponent() -> None:
    shifted = replace(law(power), variables=(Variable("x", "degC", ratio=False), LINE.variables[1]))
    found = trends_of(shifted, POINTS, (1.0, 1.0), Resamples(np.empty((0, 2)), 1))
    assert found.each[0].exponent == pytest.approx(1.0 / 0.5, rel=1e-4)
