"""Quantiles against printed tables and closed forms."""

from __future__ import annotations

from math import pi, sqrt, tan

import pytest

from tester.analysis.quantiles import f_quantile, incomplete_beta, t_quantile, t_upper_tail
from tests.tester.analysis.scipy_values import SCIPY_F, SCIPY_T

PRINTED_T = [
    (0.95, 1, 6.313752),
    (0.975, 2, 4.302653),
    (0.95, 4, 2.131847),
    (0.975, 4, 2.776445),
    (0.975, 9, 2.262157),
    (0.995, 10, 3.169273),
    (0.95, 30, 1.697261),
    (0.999, 120, 3.159539),
]

PRINTED_F = [
    (0.95, 1, 1, 161.4476),
    (0.95, 4, 10, 3.478050),
    (0.99, 5, 10, 5.636326),
    (0.95, 10, 20, 2.347878),
    (0.99, 2, 4, 18.00000),
]


@pytest.mark.parametrize(("p", "df", "printed"), PRINTED_T)
def test_t_quantile_is_that_of_the_printed_tables(p: float, df: float, printed: float) -> None:
    assert t_quantile(p, df) == pytest.approx(printed, rel=3e-7)


@pytest.mark.parametrize(("p", "df1", "df2", "printed"), PRINTED_F)
def test_f_quantile_is_that_of_the_printed_tables(p: float, df1: float, df2: float, printed: float) -> None:
    assert f_quantile(p, df1, df2) == pytest.approx(printed, rel=3e-7)


def test_t_quantile_is_that_of_scipy() -> None:
    found = [t_quantile(p, df) for p, df, _ in SCIPY_T]
    assert found == pytest.approx([value for *_, value in SCIPY_T], rel=1e-9)


def test_f_quantile_is_that_of_scipy() -> None:
    found = [f_quantile(p, df1, df2) for p, df1, df2, _ in SCIPY_F]
    assert found == pytest.approx([value for *_, value in SCIPY_F], rel=1e-9)


def test_t_quantile_with_one_degree_of_freedom_is_that_of_cauchy() -> None:
    assert t_quantile(0.9999, 1.0) == pytest.approx(tan(pi * 0.4999), rel=1e-9)


def test_t_quantile_with_two_degrees_of_freedom_has_its_closed_form() -> None:
    p = 0.9
    assert t_quantile(p, 2.0) == pytest.approx((2 * p - 1) * sqrt(2.0 / (4 * p * (1 - p))), rel=1e-10)


def test_t_quantile_without_limit_is_the_normal_one() -> None:
    assert t_quantile(0.975, float("inf")) == pytest.approx(1.959963985, rel=1e-9)


@pytest.mark.parametrize("df", [0.5, 0.9, 1.5, 2.5, 3.7, 7.25, 41.0, 1234.5])
@pytest.mark.parametrize("p", [0.6, 0.95, 0.999, 1 - 1e-6])
def test_t_quantile_inverts_the_tail(p: float, df: float) -> None:
    assert t_upper_tail(t_quantile(p, df), df) == pytest.approx(1.0 - p, rel=1e-8)


def test_lower_quantiles_mirror_the_upper_ones() -> None:
    assert t_quantile(0.05, 7.0) == -t_quantile(0.95, 7.0)
    assert t_quantile(0.5, 7.0) == 0.0


def test_incomplete_beta_of_equal_shapes_is_a_half_in_the_middle() -> None:
    assert incomplete_beta(3.3, 3.3, 0.5) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize(("p", "df"), [(0.0, 5.0), (1.0, 5.0), (0.9, 0.4), (0.9, float("nan"))])
def test_impossible_quantiles_are_refused(p: float, df: float) -> None:
    with pytest.raises(ValueError, match="quantile"):
        t_quantile(p, df)


def test_f_quantile_without_degrees_of_freedom_is_refused() -> None:
    with pytest.raises(ValueError, match="quantile"):
        f_quantile(0.9, 0.0, 3.0)


def test_incomplete_beta_outside_its_range_is_refused() -> None:
    with pytest.raises(ValueError, match="incomplete beta"):
        incomplete_beta(1.0, 1.0, 1.5)
