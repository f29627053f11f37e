"""Whether a law describes conditions, on a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest

from tester.analysis.fit.fit_law import Common, FitPoint, Source
from tester.analysis.fit.lack import Lack, denominator_of, lack_of, neighbours
from tester.analysis.fit.resample import resample
from tester.analysis.fit.solve import FitProblem, solve
from tests.campaigns.fit.power import power_of
from tests.tester.analysis.fit.straight import LINE, line, point

stats = pytest.importorskip("scipy.stats", reason="needs the extra `report`")

XS = [0.1 * i for i in range(20)]
DRAWS = 1999
MANY = 99_999
"""Draws from which a figure can be compared with tables."""
SHARE = 0.002


def drawn(seed: int, share: float, bend: float = 0.0, **known: float) -> list[FitPoint]:
    """Return a line of conditions with errors of this share, bent by up to ``bend``, and their stated errors."""
    errors = np.random.default_rng(seed).normal(0.0, share, len(XS))
    bent = [bend * (4.0 * (x / XS[-1] - 0.5) ** 2 - 0.5) for x in XS]
    known = {"type_a": share, "df": inf} | known
    return [
        replace(one, value=one.value * float(np.exp(e + b)), **known)  # type: ignore[arg-type]
        for one, e, b in zip(line(XS), errors, bent, strict=True)
    ]


def problem_of(points: Sequence[FitPoint]) -> tuple[FitProblem, np.ndarray]:
    problem = FitProblem(LINE, points, {})
    return problem, solve(problem, [(1.0, 0.5)])


def lack(points: Sequence[FitPoint]) -> Lack:
    return lack_of(*problem_of(points), draws=DRAWS)


def left_over(shape: Sequence[float], squares: float, df: float = inf) -> list[FitPoint]:
    """Return a line of conditions whose fit leaves this shape, with squares that sum to ``squares`` times SHARE^2."""
    xs = np.array(XS[: len(shape)])
    tangent = np.stack([np.ones(len(xs)), xs], axis=-1) / (1.0 + 0.5 * xs[:, None])  # of ln mu, by ln m and by s
    rest = np.array(shape) - tangent @ np.linalg.lstsq(tangent, np.array(shape), rcond=None)[0]
    rest *= SHARE * sqrt(squares) / np.linalg.norm(rest)
    made = line(list(xs), type_a=SHARE, df=df)
    return [replace(one, value=one.value * float(np.exp(r))) for one, r in zip(made, rest, strict=True)]


def alternating(count: int = len(XS)) -> list[float]:
    return [float((-1) ** i) for i in range(count)]


def arched() -> list[float]:
    return [(x / XS[-1] - 0.5) ** 2 for x in XS]


def p_of(points: Sequence[FitPoint]) -> list[float]:
    return [one.p for one in lack_of(*problem_of(points), draws=MANY).tests]


def scatter(p: float) -> float:
    """Return four standard deviations of a share among MANY draws."""
    return 4.0 * sqrt(p * (1.0 - p) / MANY)


def test_the_right_law_is_refused_once_in_a_hundred() -> None:
    assert sum(bool(lack(drawn(seed, 0.02)).shown) for seed in range(200)) <= 7  # P(8 or more) = 0.1 %


def test_a_bend_is_refused() -> None:
    assert all(lack(drawn(seed, 0.02, bend=0.12)).shown for seed in range(20))


def test_repeats_known_worse_than_they_are_leave_the_signs_to_tell() -> None:
    found = lack(drawn(1, 0.002, bend=0.08, type_a=0.1))
    assert {one.name: one.failed for one in found.tests} == {"size of the residuals": False, "signs along x": True}


def test_the_signs_of_tiny_residuals_are_no_evidence() -> None:
    assert lack(drawn(1, 1e-5, bend=2e-4, type_a=0.01)).shown is False


def test_scatter_between_conditions_is_part_of_the_denominator() -> None:
    wide = drawn(3, 0.05, type_a=0.01)
    assert lack(wide).shown and not lack([replace(one, between=sqrt(0.05**2 - 0.01**2)) for one in wide]).shown


def test_a_condition_weighs_by_its_repeats_its_own_error_and_the_scatter_between_conditions() -> None:
    one = replace(point(0.0, 1.0), type_a=0.02, own=0.03, between=0.06, df=inf)
    problem = FitProblem(LINE, [one, replace(one, own=0.0), replace(one, between=0.0), replace(one, type_a=0.0)], {})
    assert problem.sigma == pytest.approx([0.07, sqrt(0.004), sqrt(0.0013), sqrt(0.0045)])
    assert problem.weight * problem.sigma == pytest.approx(problem.reference)


def test_an_error_in_common_is_held_by_its_own_uncertainty_and_no_more() -> None:
    source = Source("run", (Common("gain", 0.05),))
    points = [point(x, 1.0, source=source, type_a=0.02, df=inf) for x in XS]
    problem = FitProblem(LINE, points, {})
    off = problem.residuals(np.array([0.0, 0.5, 1.5]), problem.y, np.array([0.5]))
    assert off[-1] == pytest.approx(0.02)  # one standard uncertainty, in units of the conditions' own
    assert problem.logarithms(np.array([0.0, 0.0, 1.5])) == pytest.approx([1.5 * 0.05] * len(XS))


def test_resamples_have_the_errors_that_the_fit_has() -> None:
    source = Source("run", (Common("gain", 0.05),))
    problem = FitProblem(LINE, [replace(one, source=source) for one in drawn(2, 0.02)], {})
    fitted = solve(problem, [(1.0, 0.5)])
    found = resample(problem, fitted, 999).parameters
    jacobian = problem.jacobian(fitted, problem.y, np.zeros(1)) / problem.reference
    left = problem.residuals(fitted, problem.y, np.zeros(1)) / problem.reference
    spread = float(left @ left) / (len(XS) - 2) * (18.0 / 16.0)  # variance of Student's t, 18 degrees of freedom
    data, prior = jacobian[:-1], jacobian[-1:]
    taken = np.linalg.inv(jacobian.T @ jacobian)
    covariance = taken @ (spread * data.T @ data + prior.T @ prior) @ taken
    assert float(np.std(found[:, 1])) == pytest.approx(float(np.sqrt(covariance[1, 1])), rel=0.1)
    assert float(np.std(np.log(found[:, 0]))) == pytest.approx(float(np.sqrt(covariance[0, 0])), rel=0.1)


def test_the_denominator_is_made_of_the_same_three() -> None:
    points = [replace(point(x, 1.0), type_a=0.02, own=0.03, between=0.06, df=8.0) for x in XS]
    found = denominator_of(points)
    assert found is not None and (found.repeats, found.own, found.between) == pytest.approx((0.02, 0.03, 0.06))
    assert found.standard == pytest.approx(0.07)
    assert found.df == pytest.approx(0.07**4 / (0.02**4 / 8.0))


def test_without_repeats_there_is_no_verdict() -> None:
    found = lack([replace(one, type_a=float("nan"), df=0.0) for one in drawn(0, 0.02)])
    assert found.shown is None and found.tests == () and found.denominator is None


def test_conditions_of_a_run_share_the_degrees_of_freedom_of_its_repeatability() -> None:
    run, other = Source("run"), Source("other")
    points = [point(x, 1.0, source=source, type_a=0.02, df=10.0) for source in (run, other) for x in XS]
    found = denominator_of(points)
    assert found is not None and found.df == pytest.approx(20.0)
    alone = denominator_of(points[: len(XS)])
    assert alone is not None and alone.df == pytest.approx(10.0)


def test_a_departure_stated_as_visible_is_found() -> None:
    found = lack(drawn(5, 0.02))
    problem, fitted = problem_of(drawn(5, 0.02))
    direction = np.cos(np.linspace(0.0, 6.0 * np.pi, len(XS)))  # neither a line nor a sign that keeps
    departure = direction * found.visible / np.sqrt(np.mean(direction**2))
    assert 0.90 <= power_of(problem, fitted, departure, DRAWS) <= 1.0
    assert power_of(problem, fitted, 0.3 * departure, DRAWS) < 0.5


@pytest.mark.parametrize("n", [4, 20])
def test_the_visible_departure_follows_a_noncentral_chi_squared(n: int) -> None:
    found = lack_of(*problem_of(left_over(alternating(n), 1.0)), draws=MANY)
    critical = stats.chi2.ppf(1.0 - 0.01 / 2.0, n - 2)  # two tests share 1 %; two parameters are fitted
    length = next(x for x in np.linspace(0.0, 20.0, 4001) if stats.ncx2.sf(critical, n - 2, x**2) >= 0.95)
    assert found.visible == pytest.approx(SHARE * length / sqrt(n), rel=0.01)


def test_the_visible_departure_with_few_repeats_follows_a_noncentral_f() -> None:
    found = lack_of(*problem_of(left_over(alternating(), 1.0, df=6.0)), draws=MANY)
    critical = stats.f.ppf(1.0 - 0.01 / 2.0, 18, 6)
    length = next(x for x in np.linspace(0.0, 40.0, 4001) if stats.ncf.sf(critical, 18, 6, x**2) >= 0.95)
    assert found.visible == pytest.approx(SHARE * length / sqrt(20), rel=0.03)


@pytest.mark.parametrize("p", [0.5, 0.05, 0.01])
def test_chance_leaves_residuals_as_large_as_chi_squared_has_it(p: float) -> None:
    squares = stats.chi2.isf(p, 18)  # of 20 conditions, less two parameters
    assert p_of(left_over(alternating(), squares))[0] == pytest.approx(p, abs=scatter(p))


@pytest.mark.parametrize("p", [0.5, 0.05, 0.01])
def test_beside_few_repeats_chance_leaves_them_as_large_as_f_has_it(p: float) -> None:
    squares = 18.0 * stats.f.isf(p, 18, 6)
    assert p_of(left_over(alternating(), squares, df=6.0))[0] == pytest.approx(p, abs=scatter(p))


def test_chance_leaves_four_conditions_the_signs_of_a_plane() -> None:
    x = np.array(XS[:4])
    tangent = np.stack([np.ones(4), x], axis=-1) / (1.0 + 0.5 * x[:, None])
    plane = np.linalg.svd(tangent)[0][:, 2:]  # of all that a fit can leave; each direction is as likely
    turn = np.linspace(0.0, 2.0 * np.pi, 100_000, endpoint=False)
    signs = np.sign(np.stack([np.cos(turn), np.sin(turn)], axis=-1) @ plane.T)
    changes = np.sum(signs[:, 1:] != signs[:, :-1], axis=-1)
    bow = [replace(one, type_a=1.0) for one in left_over([1.0, -1.0, -1.0, 1.0], 100.0)]  # + - - +: two changes
    assert p_of(bow)[1] == pytest.approx(float(np.mean(changes <= 2)), abs=0.01)


@pytest.mark.parametrize(("p", "shown"), [(0.004, True), (0.007, False)])
def test_one_test_of_two_fails_at_half_the_level(p: float, shown: bool) -> None:
    found = lack_of(*problem_of(left_over(alternating(), stats.chi2.isf(p, 18))), draws=MANY)
    assert len(found.tests) == 2 and found.shown is shown


def test_the_last_test_has_the_whole_level_where_the_others_fail() -> None:
    found = lack_of(*problem_of(left_over(arched(), stats.chi2.isf(0.007, 18))), draws=MANY)
    assert [one.failed for one in found.tests] == [True, True] and found.tests[1].p < 0.005


def test_the_power_is_the_share_of_records_that_are_refused() -> None:
    bend = np.array([0.05 * (4.0 * (x / XS[-1] - 0.5) ** 2 - 0.5) for x in XS])
    power = power_of(*problem_of(drawn(0, 0.02)), bend, DRAWS)
    refused = sum(bool(lack(drawn(seed, 0.02, bend=0.05)).shown) for seed in range(100))
    assert refused == pytest.approx(100.0 * power, abs=20.0)


def test_neighbours_differ_in_one_variable_alone() -> None:
    points = [point(x, 1.0) for x in (0.3, 0.1, 0.2)]
    points.append(replace(points[0], nominal=(0.1, 40.0)))
    assert neighbours(points, 0).tolist() == [[1, 2], [2, 0]]
    assert neighbours(points, 1).tolist() == [[1, 3]]
