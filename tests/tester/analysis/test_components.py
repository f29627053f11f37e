"""Adhesion and hysteresis from dry and film, against sums by hand."""

from __future__ import annotations

from dataclasses import replace
from math import exp, hypot, inf, isnan, sqrt

import numpy as np
import pytest

from tester.analysis.components import RUBBER_K, SENSITIVITY, PartValue, between, by_film, mean_of
from tester.analysis.kelvin import UNKNOWN, Slope
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import ConditionStatus
from tester.analysis.uncertainty import Contribution, budget, contribution
from tester.base.quantities import Means
from tester.kinds.specimen_on_track.quantities import QUANTITIES

LOAD_N, CELL_N, WEIGHTS_N = 10.0, 0.1, 0.01
NO_SLOPE = Slope(0.0, 0.0, "none")


def result(mu: float, own: float = 0.0, at_c: float = 23.0, df: float = inf) -> ConditionResult:
    common = [
        contribution("cell", CELL_N, 1.0 / LOAD_N, common="rig"),
        contribution("weights", WEIGHTS_N, mu / LOAD_N, common="rig"),
    ]
    means = Means(QUANTITIES, [at_c if one.name == "contact_c" else 1.0 for one in QUANTITIES.averaged])
    found = budget([*common, Contribution("repeatability", own, df)])
    return ConditionResult(ConditionStatus.OK, mu_resultant=mu, measured=means, budget=found)


def test_the_parts_add_up_to_the_dry_coefficient() -> None:
    parts = by_film(result(2.0), result(1.2), NO_SLOPE)
    assert parts.adhesion.value + parts.hysteresis.value == pytest.approx(2.0, rel=1e-12)
    assert parts.share.value == pytest.approx(0.6, rel=1e-12)


def test_common_errors_drop_out_of_the_difference() -> None:
    parts = by_film(result(2.0), result(1.2), NO_SLOPE)
    assert parts.adhesion.common["cell"][0] == pytest.approx(0.0, abs=1e-15)
    assert parts.adhesion.standard == pytest.approx(WEIGHTS_N * 0.8 / LOAD_N, rel=1e-9)
    assert parts.hysteresis.standard == pytest.approx(hypot(CELL_N, WEIGHTS_N * 1.2) / LOAD_N, rel=1e-9)
    assert parts.share.standard == pytest.approx(CELL_N / LOAD_N * (1.0 - 0.6) / 2.0, rel=1e-9)


def test_individual_errors_add_in_squares() -> None:
    parts = by_film(result(2.0, 0.04), result(1.2, 0.03), NO_SLOPE)
    common = WEIGHTS_N * 0.8 / LOAD_N
    assert parts.adhesion.standard == pytest.approx(sqrt(0.05**2 + common**2), rel=1e-9)


def test_the_standard_uncertainty_is_that_of_drawn_errors() -> None:
    random = np.random.default_rng(1)
    cell, weights = (1.0 * random.standard_normal(200_000) for _ in range(2))
    dry, film = (
        (mu * LOAD_N + CELL_N * cell) / (LOAD_N + WEIGHTS_N * weights) + own * random.standard_normal(200_000)
        for mu, own in ((2.0, 0.02), (1.2, 0.03))
    )
    parts = by_film(result(2.0, 0.02), result(1.2, 0.03), NO_SLOPE)
    assert parts.share.standard == pytest.approx(float(np.std(film / dry)), rel=0.02)
    assert parts.adhesion.standard == pytest.approx(float(np.std(dry - film)), rel=0.02)


def test_the_film_is_taken_to_the_temperature_of_the_dry_contact() -> None:
    parts = by_film(result(2.0, at_c=33.0), result(1.2, at_c=23.0), Slope(-0.01, 0.002, "known"))
    assert parts.warmer_k == 10.0
    assert parts.hysteresis.value == pytest.approx(1.2 * exp(-0.1), rel=1e-12)
    expected = 1.2 * exp(-0.1) * hypot(10.0, RUBBER_K) * 0.002
    assert parts.hysteresis.common[SENSITIVITY][0] == pytest.approx(expected, rel=1e-12)


def test_the_error_of_the_film_is_carried_to_that_temperature() -> None:
    parts = by_film(result(2.0, at_c=33.0), result(1.2, 0.03, at_c=23.0), Slope(-0.05, 0.0, "known"))
    own = hypot(0.03, hypot(CELL_N, WEIGHTS_N * 1.2) / LOAD_N)
    assert parts.hysteresis.standard == pytest.approx(own * exp(-0.5), rel=1e-12)


def test_a_sensitivity_has_its_stated_uncertainty() -> None:
    parts = by_film(result(2.0), result(1.2), UNKNOWN)
    assert parts.hysteresis.expanded == pytest.approx(1.96 * parts.hysteresis.standard, rel=1e-3)


def test_the_fewest_degrees_of_freedom_of_a_common_error_stand_in_a_mean() -> None:
    common = [PartValue(0.6, ((0.03, inf),), {"cell": (0.04, df)}) for df in (3.0, 50.0)]
    assert mean_of(common).common["cell"][1] == 3.0


def test_an_unknown_sensitivity_widens_pairs_of_different_temperature() -> None:
    colder, same, warmer = (by_film(result(2.0, 0.02, at), result(1.2, 0.02), UNKNOWN) for at in (13.0, 23.0, 33.0))
    assert colder.share.value == same.share.value == warmer.share.value
    assert warmer.share.standard > 0.6 * 10.0 * UNKNOWN.u_per_kelvin > 5.0 * same.share.standard
    assert same.share.common[SENSITIVITY][0] == pytest.approx(0.6 * RUBBER_K * UNKNOWN.u_per_kelvin, rel=1e-12)
    assert colder.share.common[SENSITIVITY] == warmer.share.common[SENSITIVITY]


def test_few_degrees_of_freedom_widen_the_expanded_uncertainty() -> None:
    many, few = (by_film(result(2.0, 0.02, df=df), result(1.2, 0.02, df=df), NO_SLOPE).adhesion for df in (inf, 2.0))
    assert many.expanded == pytest.approx(1.96 * many.standard, rel=1e-3)
    assert few.expanded > 1.3 * many.expanded and few.standard == many.standard


def test_without_a_budget_there_is_no_uncertainty() -> None:
    parts = by_film(result(2.0), replace(result(1.2), budget=budget([])), NO_SLOPE)
    assert parts.share.value == pytest.approx(0.6) and isnan(parts.share.expanded)


def test_common_errors_of_conditions_do_not_average_out() -> None:
    one = PartValue(0.6, ((0.03, inf),), {"cell": (0.04, inf)})
    found = mean_of([one] * 9)
    assert found.value == pytest.approx(0.6, rel=1e-12)
    assert found.standard == pytest.approx(hypot(0.01, 0.04), rel=1e-12)


def test_the_mean_weights_by_certainty() -> None:
    known = [PartValue(0.5, ((0.01, inf),)), PartValue(0.6, ((0.1, inf),))]
    found = mean_of([*known, PartValue(9.0, ((float("nan"), 1.0),))])
    assert found.value == pytest.approx((0.5 * 100.0 + 0.6) / 101.0, rel=1e-12)
    assert isnan(mean_of([]).value)


def test_conditions_that_truly_differ_weigh_alike_in_their_mean() -> None:
    apart = [PartValue(value, ((0.001, inf),)) for value in (0.1, 0.2, 0.3)]
    found = mean_of(apart)
    assert found.value == pytest.approx(0.2, rel=1e-9)
    assert found.standard == pytest.approx(0.001 / sqrt(3.0), rel=1e-9)  # all of these conditions are known


def test_with_unequal_weights_differences_of_conditions_are_in_their_mean() -> None:
    apart = [PartValue(value, ((u, inf),)) for value, u in ((0.1, 0.001), (0.2, 0.002), (0.3, 0.1))]
    found, d = mean_of(apart), between(apart)
    weights = np.array([1.0 / (own[0][0] ** 2 + d**2) for own in (one.own for one in apart)])
    weights /= weights.sum()
    assert found.value == pytest.approx(float(weights @ [0.1, 0.2, 0.3]), rel=1e-9)
    unequal = d * float(np.linalg.norm(weights - 1.0 / 3.0))
    own = float(np.linalg.norm(weights * [0.001, 0.002, 0.1]))
    assert found.standard == pytest.approx(hypot(unequal, own), rel=1e-9)
    assert abs(found.value - 0.2) < found.expanded


def test_differences_of_conditions_are_found_beside_their_uncertainties() -> None:
    random = np.random.default_rng(4)
    drawn = [PartValue(0.1 + float(off), ((0.01, inf),)) for off in random.normal(0.0, np.hypot(0.03, 0.01), 2000)]
    assert between(drawn) == pytest.approx(0.03, rel=0.05)


def test_a_scatter_that_uncertainties_explain_is_no_difference() -> None:
    assert between([PartValue(0.10, ((0.01, inf),)), PartValue(0.11, ((0.01, inf),))]) == 0.0
    assert between([PartValue(0.10, ((0.01, inf),))]) == 0.0
