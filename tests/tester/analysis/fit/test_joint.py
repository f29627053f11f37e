"""The joint fit of a group, on a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import log

import numpy as np
import pytest

from tester.analysis.fit.check import errors_of
from tester.analysis.fit.fit_law import Band, Common, FitError, FitPoint, Source
from tester.analysis.fit.joint import GroupFit, fit_group, fit_only, overall
from tester.analysis.fit.resample import resample
from tester.analysis.fit.solve import ROBUST, FitProblem, cost, solve, solve_many
from tests.tester.analysis.fit.straight import LINE, line, point

pytest.importorskip("scipy", reason="needs the extra `report`")

XS = [0.1 * i for i in range(10)]


def fitted(points: Sequence[FitPoint], **held: float) -> GroupFit:
    return fit_group(LINE, "one", points, (0,), held, count=99)


def noisy(share: float, seed: int = 0, **given: float) -> list[FitPoint]:
    random = np.random.default_rng(seed)
    scattered = random.normal(0.0, share, len(XS))
    made = line(XS, **given)
    return [replace(one, value=one.value * float(np.exp(e))) for one, e in zip(made, scattered, strict=True)]


def test_the_fit_recovers_the_true_parameters() -> None:
    found = fitted(line(XS))
    assert found.parameters == pytest.approx((1.0, 0.5), abs=1e-9)
    assert found.errors.largest < 1e-9 and found.errors.near == found.errors.rows == len(XS)


def test_it_is_the_measured_value_of_a_variable_that_is_fitted() -> None:
    shifted = [replace(one, measured=(one.nominal[0] + 0.05, 20.0), value=1.0 + 0.5 * (one.nominal[0] + 0.05))
               for one in line(XS)]  # fmt: skip
    assert fit_only(LINE, "one", shifted) == pytest.approx((1.0, 0.5), abs=1e-9)


def test_one_odd_condition_moves_the_fit_by_less_than_its_share() -> None:
    odd = [*line(XS), point(1.0, 3.0)]
    robust, plain = fit_only(LINE, "one", odd), np.polyfit([*XS, 1.0], [*(1.0 + 0.5 * x for x in XS), 3.0], 1)
    assert abs(robust[1] - 0.5) < 0.25 * abs(plain[0] - 0.5)


def test_residuals_are_of_logarithms() -> None:
    problem = FitProblem(LINE, line(XS), {})
    doubled = problem.residuals(problem.inward((2.0, 1.0)), problem.y, np.zeros(0))
    assert doubled == pytest.approx([log(2.0)] * len(XS))


def test_the_batch_agrees_with_scipy() -> None:
    problem = FitProblem(LINE, noisy(0.05, seed=3), {})
    start = problem.inward((1.0, 0.5))
    best = solve(problem, [(1.0, 0.5)])
    many, ended = solve_many(problem, start, problem.y, np.zeros((2, 0)), np.ones((2, len(XS))))
    assert ended.all()
    assert many == pytest.approx(np.array([best, best]), abs=1e-6)


def test_the_batch_counts_a_condition_by_its_weight() -> None:
    points = noisy(0.05, seed=4)
    counts = np.array([[2.0, 0.0] + [1.0] * (len(XS) - 2)])
    problem = FitProblem(LINE, points, {})
    many, _ = solve_many(problem, problem.inward((1.0, 0.5)), problem.y, np.zeros((1, 0)), counts)
    again = fit_only(LINE, "one", [points[0], points[0], *points[2:]])
    assert problem.natural(many[0]) == pytest.approx(again, abs=1e-6)


def test_the_cost_is_the_square_of_small_residuals_and_grows_slowly_with_large_ones() -> None:
    small, large = (float(cost(np.array([r]), np.ones(1))) for r in (0.01 * ROBUST, 100.0 * ROBUST))
    assert small == pytest.approx((0.01 * ROBUST) ** 2, rel=1e-4)
    assert large < 0.02 * (100.0 * ROBUST) ** 2


def test_a_condition_of_steadier_repeats_counts_more() -> None:
    low = [replace(one, type_a=0.2, df=4.0) for one in line(XS)]
    high = [replace(one, type_a=0.001, df=4.0) for one in line(XS, m=1.03)]
    assert fit_only(LINE, "one", [*low, *high])[0] > 1.02


def test_intervals_hold_the_fit_and_grow_with_the_noise() -> None:
    narrow, wide = (fitted(noisy(share)) for share in (0.005, 0.05))
    for found in (narrow, wide):
        for value, (low, high) in zip(found.parameters, found.intervals, strict=True):
            assert low < value < high
    assert wide.intervals[1][1] - wide.intervals[1][0] > 5.0 * (narrow.intervals[1][1] - narrow.intervals[1][0])


def test_intervals_hold_the_truth_as_often_as_they_claim() -> None:
    held = 0
    for seed in range(200):
        problem = FitProblem(LINE, noisy(0.03, seed), {})
        found = resample(problem, solve(problem, [(1.0, 0.5)]), 199, seed)
        low, high = found.interval(found.parameters[:, 1])
        held += low <= 0.5 <= high
    assert 179 <= held <= 198  # 95 % of 200 within 3.3 standard deviations


def test_without_any_knowledge_of_repeats_there_are_no_intervals_and_the_reason() -> None:
    found = fitted(noisy(0.02))
    assert found.sound and all("nothing is known of the repeatability" in found.why_no_interval(n) for n in ("m", "s"))


def test_a_law_that_does_not_describe_has_no_intervals() -> None:
    found = fitted([replace(one, value=1.0 + one.nominal[0] ** 2, type_a=0.001, df=50.0) for one in line(XS)])
    assert found.lack.shown and not found.sound
    assert found.why_no_interval("s") == "the law does not describe the conditions"


@pytest.mark.parametrize(
    ("band", "reason"),
    [(Band(0.6, 2.0, "a source"), "outside 0.6 to 2 1/m (a source)"), (Band(0.48, 2.0, "it"), "open beyond 0.48 to")],
)
def test_a_parameter_or_an_interval_outside_its_band_is_named_and_the_fit_silent(band: Band, reason: str) -> None:
    law = replace(LINE, parameters=(LINE.parameters[0], replace(LINE.parameters[1], band=band)))
    quiet = [replace(one, type_a=0.02, df=50.0) for one in noisy(0.01)]
    found = fit_group(law, "one", quiet, (0,), {}, count=99)
    assert reason in found.impossible["s"] and not found.sound
    assert found.why_no_interval("m") == "no such rubber has this s"


def test_an_effect_that_is_the_contacts_own_heat_has_no_interval_and_is_no_failure() -> None:
    quiet = [replace(one, type_a=0.02, df=50.0, own_heat_k=40.0 * one.nominal[0]) for one in noisy(0.01)]
    found = fitted(quiet)
    assert "friction warms the contact" in found.why_no_interval("s") and found.sound
    assert found.trends.each[0].word.startswith("not resolved: friction warms the contact by up to 36.0 K")


def test_the_same_conditions_give_the_same_intervals() -> None:
    assert fitted(noisy(0.02)).intervals == fitted(noisy(0.02)).intervals


def test_an_error_common_to_a_run_is_in_the_intervals() -> None:
    alone, shared = Source("run"), Source("run", (Common("gain", 0.05),))
    quiet = noisy(0.005)
    of = {source: fitted([replace(one, source=source) for one in quiet]) for source in (alone, shared)}
    widths = {source: found.intervals[0][1] - found.intervals[0][0] for source, found in of.items()}
    assert widths[alone] < 0.03 and widths[shared] == pytest.approx(4 * 0.05, rel=0.4)


def test_two_runs_that_differ_by_a_common_error_are_brought_together() -> None:
    runs = [Source(name, (Common("gain", 0.05),)) for name in ("first", "second")]
    points = [replace(one, source=run, value=one.value * (1.0 + off), type_a=0.002, df=4.0)
              for run, off in zip(runs, (0.04, -0.04), strict=True) for one in line(XS)]  # fmt: skip
    plain = [replace(one, source=Source("all")) for one in points]
    assert fitted(points).lack.residual < 0.2 * fitted(plain).lack.residual


def test_pieces_of_a_run_that_differ_are_brought_together() -> None:
    source = Source("run", tuple(Common("piece to piece", 0.05, piece=number) for number in (1, 2)))
    points = [replace(one, source=source, piece=number, value=one.value * (1.0 + off), type_a=0.002, df=4.0)
              for number, off in ((1, 0.04), (2, -0.04)) for one in line(XS)]  # fmt: skip
    one_piece = [replace(one, piece=1) for one in points]
    assert fitted(points).lack.residual < 0.2 * fitted(one_piece).lack.residual


def test_a_common_shift_of_a_variable_is_also_an_unknown() -> None:
    source = Source("run", (Common("offset", 0.1, 0),))
    problem = FitProblem(LINE, [replace(one, source=source) for one in line(XS)], {})
    moved = problem.logarithms(np.array([0.0, 0.5, 2.0]))
    assert np.exp(moved) == pytest.approx([1.0 + 0.5 * (x + 0.2) for x in XS])


def test_each_cell_is_left_out_in_turn() -> None:
    found = fitted(line(XS))
    assert found.left_out.rows == len(XS) and found.cells_kept == 0 and found.left_out.largest < 1e-6


def test_a_condition_that_is_off_shows_when_it_is_left_out() -> None:
    found = fitted([*line(XS), point(1.0, 3.0)])
    assert found.left_out.largest > found.errors.largest


def test_residuals_are_reported_by_level() -> None:
    found = fitted([*line(XS), point(XS[0], 1.1)])
    first = found.residuals[0][0]
    assert (first.value, first.count) == (XS[0], 2) and first.mean > 0.0


def test_a_held_parameter_stays() -> None:
    found = fitted(line(XS), s=0.4)
    assert found.parameters[1] == 0.4 and found.held == ("s",)
    assert found.intervals[1] == (0.4, 0.4)


@pytest.mark.parametrize(
    ("points", "held", "message"),
    [
        (line([0.2] * 6), {}, r"one: one x only \(200 mm\), and s need at least 2.*--hold s"),
        (line([0.0, 0.5, 1.0]), {}, "3 conditions for 2 parameters .expected at least 5."),
        (line(XS), {"m": 1.0, "s": 1.0}, "there is nothing to fit"),
        (line(XS), {"k": 1.0}, r"no parameter k of the law line \(it has m, s\)"),
        (line(XS), {"m": -1.0}, "m is held at -1 .expected above 0."),
    ],
)
def test_a_set_that_cannot_be_fitted_is_refused_with_a_remedy(
    points: list[FitPoint], held: dict[str, float], message: str
) -> None:
    with pytest.raises(FitError, match=message):
        fitted(points, **held)


def test_conditions_that_cannot_separate_two_parameters_are_refused() -> None:
    twins = replace(
        LINE,
        parameters=(*LINE.parameters, replace(LINE.parameters[1], name="t")),
        value=lambda p, x: p[..., 0, None] + (p[..., 1, None] + p[..., 2, None]) * x[..., 0],
        published={"one": (1.0, 0.2, 0.3)},
    )
    with pytest.raises(FitError, match=r"cannot tell s, t apart .*hold one of them"):
        fit_group(twins, "one", noisy(0.02), (0,), {}, count=9)


def test_errors_count_conditions_within_their_limits() -> None:
    found = errors_of([1.04, 1.06, 1.11], [1.0, 1.0, 1.0])
    assert (found.rows, found.near, found.far) == (3, 1, 2)
    assert (found.mean, found.median, found.largest) == pytest.approx((0.07, 0.06, 0.11))


def test_errors_over_all_groups_weigh_conditions_not_groups() -> None:
    fits = [fit_group(LINE, name, line(XS[:n]), (0,), {}, count=9) for name, n in (("one", 5), ("two", 9))]
    every = overall(fits, {"one": [point(0.3, 2.0 * (1.0 + 0.5 * 0.3))], "three": [point(0.3, 1.0)]})
    assert every.fitted.rows == 14
    assert every.validation is not None and every.validation.rows == 1
    assert every.validation.mean == pytest.approx(0.5)
    assert overall(fits, None).validation is None
