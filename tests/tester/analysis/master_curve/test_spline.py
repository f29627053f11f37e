"""Cubic splines by least squares."""

from __future__ import annotations

import numpy as np
import pytest

from tester.analysis.master_curve.spline import basis, left_over, orthonormal, quantile_knots, slopes

X = np.sort(np.random.default_rng(1).uniform(-4.0, 6.0, 80))


@pytest.mark.parametrize("interior", [0, 1, 7])
def test_b_splines_add_up_to_one_everywhere_with_both_ends(interior: int) -> None:
    found = basis(X, quantile_knots(X, interior))
    assert found.shape == (80, interior + 4)
    assert np.allclose(np.sum(found, axis=1), 1.0, atol=1e-12) and np.all(found >= -1e-12)


def test_a_cubic_is_met_to_rounding() -> None:
    y = 0.3 * X**3 - X**2 + 2.0
    assert np.max(np.abs(left_over(orthonormal(basis(X, quantile_knots(X, 3))), y))) < 1e-9


def test_slopes_are_those_of_the_spline() -> None:
    knots = quantile_knots(X, 5)
    inside = X[5:-5]
    ahead, behind = basis(inside + 1e-6, knots), basis(inside - 1e-6, knots)
    assert np.allclose(slopes(inside, knots), (ahead - behind) / 2e-6, atol=1e-6)


def test_knots_stand_at_quantiles() -> None:
    inner = quantile_knots(X, 3)[4:-4]
    assert [int(np.sum(X < one)) for one in inner] == [20, 40, 60]  # noqa: SIM300


def test_redundant_columns_drop_out() -> None:
    one = np.ones((10, 1))
    assert orthonormal(np.hstack([one, 2.0 * one, np.arange(10.0)[:, None]])).shape == (10, 2)
