"""The apparent angle of the cell's axes, pooled over conditions measured in both directions."""

from __future__ import annotations

from math import isnan
from random import Random
from statistics import fmean

import pytest

from tester.analysis.repeats import ConditionResult, combine_repeats
from tester.analysis.schemes import NOT_KNOWN, PAIRS, misalignment
from tests.tester.analysis.pairs import series


def measured(random: Random, mu: float, turned_deg: float, pairs: int = 3) -> ConditionResult:
    return PAIRS.combine(series([mu * (1.0 + random.gauss(0.0, 0.02)) for _ in range(2 * pairs)], turned_deg), pairs)


def test_the_angle_of_steady_conditions_is_that_of_the_cell() -> None:
    found = misalignment(PAIRS.combine(series([mu] * 6, 0.4), 3) for mu in (0.5, 0.73, 1.2))
    assert found.deg == pytest.approx(0.4, abs=0.001) and found.pairs == 9 and found.df == 6


def test_one_condition_of_three_pairs_knows_it_to_a_fifth_of_a_degree() -> None:
    random = Random(1)
    sizes = [misalignment([measured(random, 0.73, 0.3)]).standard_deg for _ in range(200)]
    assert fmean(size * size for size in sizes) ** 0.5 == pytest.approx(0.22, abs=0.02)


def test_the_interval_of_a_session_contains_the_angle_at_its_stated_rate() -> None:
    random, hits = Random(2), 0
    for _ in range(400):
        found = misalignment(measured(random, mu, -0.35) for mu in (0.5, 0.7, 0.9, 1.3))
        hits += abs(found.deg + 0.35) <= found.expanded_deg
    assert 0.92 <= hits / 400 <= 0.98


def test_more_conditions_know_it_better() -> None:
    random = Random(3)
    few, many = (misalignment(measured(random, 0.73, 0.3) for _ in range(n)).standard_deg for n in (2, 32))
    assert many < 0.4 * few


def test_conditions_of_one_direction_give_no_angle() -> None:
    assert misalignment([combine_repeats(series([0.7, 0.7, 0.7]), 3)]) == NOT_KNOWN
    assert isnan(NOT_KNOWN.expanded_deg)
