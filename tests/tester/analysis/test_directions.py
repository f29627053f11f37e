"""Both directions of sliding: errors absent from half the difference, and visible in half the sum."""

from __future__ import annotations

from math import degrees

import pytest

from tester.analysis.directions import as_pairs, is_reversed
from tester.analysis.reduce import without_value
from tester.analysis.results import RepeatStatus
from tests.tester.analysis.pairs import refused, series


def test_repeats_alternate_so_that_a_steady_change_drops_out_of_two_pairs() -> None:
    assert [is_reversed(repeat) for repeat in range(1, 9)] == [False, True, True, False] * 2
    assert sum(-1 if is_reversed(repeat) else 1 for repeat in range(1, 5)) == 0
    assert sum(-repeat if is_reversed(repeat) else repeat for repeat in range(1, 5)) == 0


@pytest.mark.parametrize("turned_deg", [-0.5, 0.2, 0.5])
@pytest.mark.parametrize("mu", [0.5, 0.73, 1.4])
def test_half_the_difference_is_free_of_misalignment_and_crosstalk(mu: float, turned_deg: float) -> None:
    one_way = series([mu], turned_deg, (0.005, -0.005))[0].mu_resultant
    (pair,) = as_pairs(series([mu, mu], turned_deg, (0.005, -0.005)))
    assert abs(one_way / mu - 1.0) > 0.002
    assert pair.mu_resultant == pytest.approx(mu, rel=1e-3)


@pytest.mark.parametrize("first", [1, 3])
def test_a_pair_has_the_sign_of_the_direction_that_was_asked_for(first: int) -> None:
    pair = as_pairs(series([0.7] * (first + 1), 0.5))[-1]
    assert pair.mu_longitudinal == pytest.approx(0.7, rel=1e-3)


def test_friction_is_shown_by_half_the_difference_and_the_rest_by_the_mean() -> None:
    (pair,) = as_pairs(series([0.7, 0.7]))
    assert pair.means.along == pytest.approx(140.0)
    assert pair.means["belt_speed_m_s"] == pytest.approx(0.8)


def test_a_pair_with_a_refused_repeat_is_refused_and_names_it() -> None:
    results = series([0.7] * 4)
    results[2] = refused(results[2])
    first, second = as_pairs(results)
    assert first.valid
    assert second.status is RepeatStatus.REFUSED and second.reason == "repeat 3: drifts by +4.0 % a window"


def test_a_pair_without_its_second_repeat_has_no_value() -> None:
    pairs = as_pairs(series([0.7] * 3))
    assert pairs[0].valid and pairs[1].status is RepeatStatus.TOO_FEW
    assert len(as_pairs(series([0.7] * 3), whole=True)) == 1


def test_a_pair_ends_as_the_repeat_that_ended_it() -> None:
    results = [series([0.7])[0], without_value(RepeatStatus.CANNOT_HOLD, "warms by 2 K/s")]
    (pair,) = as_pairs(results)
    assert pair.status is RepeatStatus.CANNOT_HOLD and pair.reason == "warms by 2 K/s"


def test_half_the_sum_over_one_plus_mu_squared_is_the_angle() -> None:
    one, other = series([0.73, 0.73], 0.4)
    sum_ = 0.5 * (one.mu_longitudinal + other.mu_longitudinal)
    assert degrees(sum_ / (1.0 + 0.73**2)) == pytest.approx(0.4, rel=1e-3)
