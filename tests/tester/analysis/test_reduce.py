"""From blocks to a repeat's result."""

from __future__ import annotations

from itertools import islice
from math import exp, hypot
from random import Random

import pytest

from tester.analysis.blocks import BlockCounter
from tester.analysis.flags import NOT_SHOWN
from tester.analysis.reduce import batch_means, bursts_of, reduce_repeat, standard_deviation, without_value
from tester.analysis.results import RepeatStatus
from tester.analysis.stability import Window
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tests.tester.analysis.series import REVOLUTION_S, block, blocks, correlated, sample

STEADY = [0.7, 0.701] * 15


def test_a_full_steady_window_is_valid() -> None:
    result = reduce_repeat(blocks(STEADY), Window(30))
    assert (result.status, result.valid, result.reason) == (RepeatStatus.VALID, True, "")
    assert result.mu_resultant == pytest.approx(0.7005)
    assert (result.revolutions, result.truncated, result.bursts) == (30, 0, 1)
    assert result.window_s == pytest.approx(30 * REVOLUTION_S)


def test_the_coefficient_is_a_ratio_of_means_with_the_measured_load() -> None:
    made = [block(0.0, force_x_n=100.0, force_z_n=100.0), block(0.0, force_x_n=100.0, force_z_n=300.0)] * 5
    assert reduce_repeat(made).mu_resultant == pytest.approx(0.5)  # a mean of ratios would be 0.667


def test_noise_of_the_forces_does_not_bias_the_coefficient() -> None:
    random = Random(2)
    counter = BlockCounter(QUANTITIES)
    for i in range(20000):
        counter.add(
            sample(
                time_s=0.01 * i,
                wheel_angle_rev=0.0283 * i,
                force_x_n=random.gauss(20.0, 20.0),
                force_y_n=random.gauss(0.0, 20.0),
                force_z_n=random.gauss(100.0, 20.0),
            )
        )
    result = reduce_repeat(counter.blocks)
    assert result.mu_resultant == pytest.approx(0.2, abs=4 * 0.2 / 20000**0.5)
    assert result.mu_longitudinal == pytest.approx(0.2, abs=4 * 0.2 / 20000**0.5)


def test_resultant_is_that_of_longitudinal_and_lateral() -> None:
    result = reduce_repeat([block(0.5, force_x_n=-60.0, force_y_n=80.0)] * 10)
    assert (result.mu_longitudinal, result.mu_lateral) == pytest.approx((-0.3, 0.4))
    assert result.mu_resultant == pytest.approx(hypot(0.3, 0.4))


def test_means_are_those_of_the_blocks_that_are_left() -> None:
    random = Random(1)
    values = [0.7 * (1.0 + 0.2 * exp(-i / 2.0) + random.gauss(0.0, 0.004)) for i in range(60)]
    made = blocks(values, surface=[20.0 + 0.1 * i for i in range(60)])
    result = reduce_repeat(made, Window(30))
    kept = made[result.truncated :]
    assert result.truncated > 0
    assert result.flags == "extended; truncated"
    assert result.means.temperature == pytest.approx(sum(b.means.temperature for b in kept) / len(kept))
    assert result.revolutions == len(kept)
    assert (result.started_s, result.ended_s) == (made[0].started_s, made[-1].ended_s)


def test_fewer_revolutions_than_the_window_are_too_few() -> None:
    result = reduce_repeat(blocks(STEADY[:20]), Window(30))
    assert (result.status, result.reason) == (RepeatStatus.TOO_FEW, "20 of 30 revolutions")
    assert result.mu_resultant == pytest.approx(0.7005)


def test_fewer_seconds_than_the_window_are_too_few() -> None:
    result = reduce_repeat(blocks(STEADY), Window(None, 60.0))
    assert (result.status, result.reason) == (RepeatStatus.TOO_FEW, "30 revolutions in less than 60 s")


def test_a_drifting_repeat_is_flagged_where_it_is_judged_alone() -> None:
    random = Random(9)
    values = [0.7 * (1.0 + 0.05 * i / 30 + random.gauss(0.0, 0.01)) for i in range(45)]
    result = reduce_repeat(blocks(values), Window(30), alone=True)
    assert result.valid and result.flags == NOT_SHOWN
    assert result.bound_percent > result.drift_percent == pytest.approx(5.0, abs=1.0)
    assert reduce_repeat(blocks(values), Window(30)).flags == ""


def test_the_drift_of_rolling_is_not_judged() -> None:
    result = reduce_repeat(blocks([0.02 + 0.001 * i for i in range(45)]), Window(30), rolling=True, alone=True)
    assert result.valid and result.flags == "rolling"
    assert result.drift_percent != result.drift_percent


def test_a_window_that_its_transient_leaves_short_is_too_few() -> None:
    random = Random(1)
    values = [0.7 * (1.0 + 0.2 * exp(-i / 2.0) + random.gauss(0.0, 0.002)) for i in range(32)]
    result = reduce_repeat(blocks(values), Window(30))
    assert result.status is RepeatStatus.TOO_FEW and "more are transient" in result.reason


def test_no_blocks_give_no_value() -> None:
    result = reduce_repeat([], Window(30))
    assert result.status is RepeatStatus.TOO_FEW
    assert result.mu_resultant != result.mu_resultant


def test_a_condition_at_zero_slip_is_flagged_rolling() -> None:
    assert reduce_repeat(blocks(STEADY), Window(30), rolling=True).flags == "rolling"


def test_a_window_of_exactly_the_asked_length_is_not_extended() -> None:
    assert "extended" not in reduce_repeat(blocks(STEADY), Window(20.0)).flags


def test_load_that_is_no_load_gives_no_value() -> None:
    result = reduce_repeat([block(0.7, force_z_n=0.0)] * 10)
    assert not result.valid
    assert result.mu_longitudinal != result.mu_longitudinal


def test_ten_batches_of_nearly_equal_length() -> None:
    assert len(batch_means(blocks(STEADY))) == 10
    assert len(batch_means(blocks([0.7] * 37))) == 10
    assert len(batch_means(blocks([0.7] * 7))) == 7


def test_uncertainty_of_correlated_noise_covers_the_truth() -> None:
    covered = 0
    for seed in range(100):
        result = reduce_repeat(blocks([0.7 * (1.0 + x) for x in islice(correlated(Random(seed)), 45)]), Window(30))
        covered += abs(result.mu_resultant - 0.7) <= 2.262 * result.uncertainty  # t of ten batches
    assert covered >= 90


def test_bursts_are_counted_with_their_revolutions_and_temperatures() -> None:
    made = blocks([0.7] * 5, per_burst=3, surface=[24.0, 25.0, 26.0])
    first, second = bursts_of(made)
    assert (first.number, first.revolutions, first.surface_first_c, first.surface_last_c) == (1, 3, 24.0, 26.0)
    assert (second.number, second.revolutions, second.surface_last_c) == (2, 2, 25.0)
    assert bursts_of([]) == []


def test_a_repeat_without_a_value_keeps_its_reason() -> None:
    result = without_value(RepeatStatus.CANNOT_HOLD, "warming 3 K/s", 10.0, 20.0)
    assert (result.status, result.reason, result.ended_s) == (RepeatStatus.CANNOT_HOLD, "warming 3 K/s", 20.0)


def test_one_value_has_no_standard_deviation() -> None:
    assert standard_deviation([1.0]) != standard_deviation([1.0])
    assert standard_deviation([1.0, 3.0]) == pytest.approx(2.0**0.5)
