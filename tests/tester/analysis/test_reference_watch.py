"""Control charts of references, and the conditions that they make doubtful."""

from __future__ import annotations

from dataclasses import replace
from math import exp, hypot, isnan, log, nan, sqrt

import pytest

from tester.analysis.reference_watch import control_charts, doubted
from tests.tester.analysis.test_reference import KNOWN, RESERVED, U, on_wheels


def test_limits_are_three_sigma_of_a_difference_from_the_first() -> None:
    (chart,) = control_charts(on_wheels(1, 5), RESERVED)
    half = 3.0 * sqrt(2.0) * U
    assert chart.centre == pytest.approx(0.7)
    assert (chart.low, chart.high) == (pytest.approx(0.7 * exp(-half)), pytest.approx(0.7 * exp(half)))


def test_where_pieces_were_changed_their_difference_is_in_the_limits() -> None:
    (chart,) = control_charts(on_wheels(3, 2), KNOWN)
    assert log(chart.high / chart.centre) == pytest.approx(3.0 * sqrt(2.0) * hypot(U, 0.03))


def test_points_are_in_order_with_the_outliers() -> None:
    (chart,) = control_charts(on_wheels(1, 11), RESERVED)
    assert [point.number for point in chart.points] == list(range(1, 12))
    assert [point.within for point in chart.points] == [True] * 5 + [False] * 6 and not chart.kept
    assert chart.points[0].expanded == pytest.approx(0.7 * U * 2.0003, rel=1e-4)


def test_each_compound_has_its_chart() -> None:
    charts = control_charts(on_wheels(4, 1, compounds=("1#", "3#")), KNOWN)
    assert [(chart.compound, [point.number for point in chart.points]) for chart in charts] == [
        ("1#", [1, 3]),
        ("3#", [2, 4]),
    ]


def test_a_reference_without_a_value_is_on_the_chart_and_inside_nothing() -> None:
    first, second, third = on_wheels(1, 3)
    (chart,) = control_charts([first, replace(second, mu=nan), third], RESERVED)
    assert isnan(chart.points[1].mu) and not chart.points[1].within
    assert not control_charts([replace(first, mu=nan)], RESERVED)


def test_conditions_since_the_last_good_reference_are_doubted() -> None:
    charts = control_charts(on_wheels(1, 11)[:7], RESERVED)  # out of their limits: 6 and 7, at conditions 60 and 70
    between = [number for number in range(1, 71) if number % 10]
    assert doubted(charts, between) == {*range(51, 60), *range(61, 70)}


def test_a_reference_without_a_value_casts_no_doubt() -> None:
    first, second, third, *_ = on_wheels(1, 11)
    charts = control_charts([first, replace(second, mu=nan), third], RESERVED)
    assert doubted(charts, range(1, 31)) == frozenset()
