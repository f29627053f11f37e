"""Two runs along their repeats: the common grid, nothing outside the overlap, U where both have one."""

from __future__ import annotations

from math import hypot, isnan, nan
from pathlib import Path

import pytest

from tester.analysis.quantiles import t_quantile
from tester.results.compared import pairs
from tester.results.repeats_compared import RepeatPlace, common, compared_along
from tester.results.run_results import results_of
from tester.store.run_reader import RunReader
from tests.tester.results.test_so_far import running

FIRST = [RepeatPlace(0.0, 0.50, 0.010, 9.0), RepeatPlace(10.0, 0.60, 0.010, 9.0), RepeatPlace(30.0, 0.80, 0.030, 9.0)]
SECOND = [RepeatPlace(5.0, 0.70, 0.020, 9.0), RepeatPlace(20.0, 0.40, 0.020, 9.0), RepeatPlace(40.0, 0.50, 0.020, 9.0)]


def test_the_grid_is_every_place_of_either_inside_the_overlap_alone() -> None:
    assert [a.x for a, _ in common(FIRST, SECOND, exact=False)] == [5.0, 10.0, 20.0, 30.0]


def test_between_repeats_the_coefficient_is_linear_and_their_u_adds_in_squares() -> None:
    (a, b), *_ = common(FIRST, SECOND, exact=False)
    assert (a.mu, b.mu) == (pytest.approx(0.55), 0.70)
    assert a.u == pytest.approx(hypot(0.5 * 0.010, 0.5 * 0.010)) and b.u == 0.020
    assert a.df == pytest.approx(18.0)  # two equal parts of nine degrees of freedom


def test_runs_that_do_not_overlap_have_nothing_in_common() -> None:
    later = [one._replace(x=one.x + 100.0) for one in SECOND]
    assert list(common(FIRST, later, exact=False)) == [] == list(common(FIRST, [], exact=False))


def test_one_repeat_is_compared_at_its_own_place() -> None:
    ((a, b),) = common(FIRST, [RepeatPlace(20.0, 0.4, 0.02, 9.0)], exact=False)
    assert (a.x, a.mu, b.mu) == (20.0, pytest.approx(0.7), 0.4)


def test_numbers_of_repeats_are_compared_only_where_both_have_one() -> None:
    first = [RepeatPlace(float(n), 0.5, 0.01, 9.0) for n in (1, 2, 3)]
    second = [RepeatPlace(float(n), 0.6, 0.01, 9.0) for n in (1, 3, 4)]
    assert [a.x for a, _ in common(first, second, exact=True)] == [1.0, 3.0]


def test_a_repeat_without_u_has_a_difference_without_u() -> None:
    ((a, b),) = common([RepeatPlace(1.0, 0.5, nan, -1.0)], [RepeatPlace(1.0, 0.6, 0.01, 9.0)], exact=False)
    assert isnan(a.expanded) and b.expanded == pytest.approx(t_quantile(0.975, 9.0) * 0.01)


def test_difference_and_ratio_of_two_runs_with_their_u(tmp_path: Path) -> None:
    folders = [running(tmp_path / "a", (0.70, 0.72, 0.71)), running(tmp_path / "b", (0.80, 0.84))]
    with RunReader(folders[0]) as one, RunReader(folders[1]) as two:
        matched = list(pairs(results_of(one), results_of(two)))
        found = list(compared_along(matched, "repeat", (one.travels(), two.travels())))
        u = one.repeats()[0].result.uncertainty
    assert [(c.x, round(c.found.value, 9), round(c.ratio, 9)) for c in found] == [
        (1.0, 0.1, round(0.8 / 0.7, 9)), (2.0, 0.12, round(0.84 / 0.72, 9)),
    ]  # fmt: skip
    assert (found[0].found.standard, found[0].found.df) == (pytest.approx(hypot(u, u)), pytest.approx(18.0))
    a, b = u / 0.7, 0.8 * u / 0.7**2
    df = hypot(a, b) ** 4 / ((a**4 + b**4) / 9.0)
    assert found[0].ratio_u == pytest.approx(t_quantile(0.975, df) * hypot(a, b))
