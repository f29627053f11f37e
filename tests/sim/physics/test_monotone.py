"""The cubic that never overshoots."""

from __future__ import annotations

import numpy as np
import pytest

from sim.physics.monotone import MonotoneCubic


def test_a_straight_line_stays_one() -> None:
    x = np.array([0.0, 1.0, 3.0, 3.5])
    at = np.linspace(0.0, 3.5, 50)
    assert MonotoneCubic(x, 2.0 - 3.0 * x)(at) == pytest.approx(2.0 - 3.0 * at, abs=1e-12)
    assert MonotoneCubic(x[:2], x[:2])(np.array([0.25])) == pytest.approx([0.25])


def test_between_two_points_it_stays_between_their_values() -> None:
    random = np.random.default_rng(3)
    for _ in range(50):
        x = np.cumsum(random.uniform(0.01, 1.0, 12))
        y = random.standard_normal(12)
        curve = MonotoneCubic(x, y)
        for i in range(11):
            inside = curve(np.linspace(x[i], x[i + 1], 40))
            assert np.all(np.diff(inside) * (y[i + 1] - y[i]) >= -1e-12)


def test_a_smooth_curve_is_met_with_the_square_of_the_step_at_least() -> None:
    errors = []
    for points in (11, 21, 41):
        x = np.linspace(0.0, 2.0, points)
        at = np.linspace(0.0, 2.0, 999)
        errors.append(float(np.max(np.abs(MonotoneCubic(x, np.exp(x))(at) - np.exp(at)))))
    assert errors[0] < 3e-3 and errors[1] < errors[0] / 4.0 and errors[2] < errors[1] / 4.0
