"""One setting measured several times: common errors of its values, their agreement, and the difference of two."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, inf, nan, sqrt

import numpy as np
import pytest

from tester.analysis.difference import RIG
from tester.analysis.kelvin import TEMPERATURE_SENSITIVITY, Slope, SurfaceWarmth
from tester.analysis.measurand import Surroundings, with_budget
from tester.analysis.reference import CounterfaceDrift
from tester.analysis.repeated_settings import (
    PIECE,
    ErrorPart,
    SettingAgreement,
    SettingMeasurement,
    agreement,
    difference_of,
    measurement,
)
from tester.analysis.terms import Size
from tests.tester.analysis.test_measurand import BY, THREE

WHEELS, REPEATS = 0.03, 0.01
"""Relative standard deviations from wheel to wheel, and of a mean of repeats."""


def made(mu: float, piece: int, condition: int = 1, df: float = inf, repeats: float = REPEATS) -> SettingMeasurement:
    """Return a measurement of a coefficient near 1, with ``df`` degrees of freedom of a pooled repeatability."""
    own = ErrorPart("repeatability", repeats, "", "pool", df)
    return SettingMeasurement(condition, piece, mu, (own, ErrorPart("wheel to wheel", WHEELS, PIECE)))


def judged(*values: tuple[float, int]) -> SettingAgreement:
    found = agreement([made(mu, piece, number) for number, (mu, piece) in enumerate(values, start=1)])
    assert found is not None
    return found


def measured(piece: int = 1, by: Surroundings = BY) -> SettingMeasurement:
    """Return a condition of real terms as a measurement."""
    return measurement(1, piece, with_budget(THREE, by), by)


def error(of: SettingMeasurement, cause: str) -> ErrorPart:
    (found,) = [one for one in of.errors if one.cause == cause]
    return found


# -- common errors of measurements ------------------------------------------------------------------------------------


def test_all_terms_of_the_compound_s_budget_are_there_with_their_scopes() -> None:
    found = {one.cause: one.common for one in measured().errors}
    assert found.keys() == {one.name for one in with_budget(THREE, BY).compound_budget.contributions}
    assert found["axis misalignment"] == found[TEMPERATURE_SENSITIVITY] == RIG
    assert found["diameter worn off"] == found["diameter as installed"] == found["wheel to wheel"] == PIECE
    assert found["repeatability"] == found["drift"] == found["cell zero, load"] == ""


def test_on_one_wheel_its_own_factor_and_its_diameter_drop_out_of_a_difference() -> None:
    one = measured()
    own = hypot(*(part.value for part in one.errors if not part.common))
    assert difference_of(one, one).standard == pytest.approx(sqrt(2.0) * own)


def test_between_wheels_they_count_twice() -> None:
    one, other = measured(1), measured(2)
    own = hypot(*(part.value for part in one.errors if part.common != RIG))
    assert difference_of(one, other).standard == pytest.approx(sqrt(2.0) * own)
    assert difference_of(one, other).standard > sqrt(2.0) * 0.03 * THREE.mu_resultant


def test_the_wear_between_two_measurements_on_a_wheel_remains_of_its_diameter_s_error() -> None:
    early, late = (measured(by=replace(BY, size=Size(90.0, loss_mm))) for loss_mm in (0.1, 0.4))
    own = sum(part.value**2 for part in (*early.errors, *late.errors) if not part.common)
    off = error(late, "diameter worn off").value - error(early, "diameter worn off").value
    assert off == pytest.approx(0.75 * error(late, "diameter worn off").value, rel=0.02)
    assert difference_of(early, late).standard == pytest.approx(sqrt(own + off**2), rel=1e-4)


def test_checks_of_a_diameter_are_off_each_by_itself() -> None:
    one = measured(by=replace(BY, size=Size(90.0, 0.4, 0.02)))
    assert error(one, "diameter worn off").common == ""


def test_an_unknown_sensitivity_counts_as_far_as_the_temperatures_differ() -> None:
    def at(shown_c: float) -> SettingMeasurement:
        return measured(by=replace(BY, warmth=SurfaceWarmth(25.0, shown_c, 0.0, Slope(0.0, 0.02, "", known=False))))

    alike, apart = (difference_of(at(25.5), at(shown_c)).standard for shown_c in (25.5, 27.5))
    assert sqrt(apart**2 - alike**2) == pytest.approx(2.0 * 0.02 * THREE.mu_resultant, rel=0.01)


def test_a_change_of_the_counterface_is_no_excuse() -> None:
    drift = CounterfaceDrift(-1e-4, 1e-5, 8.0, 0.0, 1000.0, 3, 1, apart=False)
    blunt = replace(BY, drift=drift, travel_m=900.0)
    assert measured(by=blunt).errors == measured().errors


def test_a_difference_has_the_degrees_of_freedom_of_the_pool_once() -> None:
    one, other = (made(1.0, 1, number, df=8.0) for number in (1, 2))
    assert difference_of(one, other).df == pytest.approx(8.0)


# -- whether they agree -----------------------------------------------------------------------------------------------


def test_values_that_are_the_same_agree() -> None:
    found = judged((0.7, 1), (0.7, 1), (0.7, 2), (0.7, 2))
    assert found.kept and found.chi2 == pytest.approx(0.0, abs=1e-9) and found.mean == pytest.approx(0.7)


@pytest.mark.parametrize(("count", "limit"), [(2, 9.550), (4, 14.796), (9, 24.352)])
def test_the_limit_is_that_of_chi_squared_at_a_fifth_of_a_per_cent(count: int, limit: float) -> None:
    assert judged(*[(1.0, 1)] * count).limit == pytest.approx(limit, rel=1e-3)


def test_few_repeats_behind_the_repeatability_widen_the_limit() -> None:
    limits = [agreement([made(1.0, 1, n, df) for n in (1, 2)]) for df in (inf, 30.0, 6.0)]
    found = [one.limit for one in limits if one is not None]
    assert found == sorted(found) and found[2] > 2.0 * found[0]
    assert found[2] == pytest.approx(5.2076**2, rel=1e-4)  # t(0.999, 6) of printed tables, squared


def test_wheels_that_differ_as_wheels_do_agree_and_one_wheel_that_changes_as_much_does_not() -> None:
    assert judged((1.00, 1), (1.08, 2)).kept
    assert not judged((1.00, 1), (1.08, 1)).kept


def test_the_greatest_outlier_is_found() -> None:
    found = judged((1.00, 1), (1.01, 1), (1.09, 1), (1.03, 2))
    assert not found.kept and found.outstanding == 2
    assert found.off[2] == pytest.approx(0.085, abs=0.003)
    assert found.off_standard[2] == pytest.approx(REPEATS * sqrt(1.5), rel=0.03)


def test_of_two_values_neither_is_an_outlier() -> None:
    assert judged((1.0, 1), (1.2, 1)).outstanding is None


@pytest.mark.parametrize("unknown", [made(nan, 1), made(1.0, 1, repeats=nan)])
def test_a_measurement_without_value_or_uncertainty_is_left_out(unknown: SettingMeasurement) -> None:
    assert agreement([unknown, made(1.0, 1)]) is None
    found = agreement([made(1.0, 1), unknown, made(1.0, 1)])
    assert found is not None and len(found.measurements) == 2


def drawn(
    seed: int, pieces: list[int], df: int, changed: float = 0.0, repeats: float = REPEATS, known: float = 0.0
) -> list[SettingMeasurement]:
    """Return measurements on wheels with a repeatability that is estimated; the first is less by ``changed``.

    ``known``: standard deviation of each measurement's own error beside the repeats.
    """
    random = np.random.default_rng(seed)
    wheels = {piece: random.normal(0.0, WHEELS) for piece in sorted(set(pieces))}
    estimate = repeats * sqrt(random.chisquare(df) / df)
    values = [1.0 + wheels[piece] + random.normal(0.0, hypot(repeats, known)) for piece in pieces]
    values[0] -= changed
    found = [made(mu, piece, n, float(df), estimate) for n, (mu, piece) in enumerate(zip(values, pieces, strict=True))]
    return [replace(one, errors=(*one.errors, ErrorPart("zero", known))) for one in found]


@pytest.mark.parametrize(
    ("pieces", "df", "known"),
    [([1, 1, 2, 2], 8, 0.0), ([1, 1, 2, 2], 8, 0.005), ([1, 1, 1, 2, 3], 30, 0.003), ([1, 1], 4, 0.003),
     ([1, 1], 2, 0.002), ([1, 2], 2, 0.01)],
)  # fmt: skip
def test_false_alarms_are_no_more_than_the_level(pieces: list[int], df: int, known: float) -> None:
    found = [agreement(drawn(seed, pieces, df, known=known)) for seed in range(2000)]
    assert sum(one is not None and not one.kept for one in found) <= 11  # 4 are expected: the binomial's 99.9 %


def test_a_change_of_8_per_cent_on_a_wheel_is_found() -> None:
    found = [agreement(drawn(seed, [1, 1, 2, 2], 28, 0.08, 0.008)) for seed in range(200)]
    assert sum(one is not None and not one.kept for one in found) >= 190


@pytest.mark.parametrize(("pieces", "df"), [([1, 1], 8), ([1, 2], 8), ([1, 1], 28)])
def test_the_uncertainty_of_a_difference_covers_it(pieces: list[int], df: int) -> None:
    found = [difference_of(*drawn(seed, pieces, df)) for seed in range(1000)]
    assert 930 <= sum(not one.told_apart for one in found) <= 970
