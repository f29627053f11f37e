"""Errors of a slip ring: whether they gather at an angle, with an angle whose scale is off."""

from __future__ import annotations

from math import isnan
from random import Random

import pytest

from tester.analysis.ring_errors import LEAST_ERRORS, sector_of, speed_class, speed_words, trend_of


def away_deg(one: float, other: float) -> float:
    """Return the angle between two directions, degrees."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


@pytest.mark.parametrize("seed", range(20))
def test_a_worn_place_is_found_whatever_the_scale_of_the_speed(seed: int) -> None:
    draw = Random(seed)
    centre, off = draw.uniform(0.0, 360.0), draw.uniform(-0.008, 0.008)
    noted: list[float] = []
    for _ in range(4000):  # requests at any time
        true = draw.uniform(0.0, 3000.0)
        drift = draw.gauss(0.0, 0.01)
        bad = away_deg(360.0 * true, centre) <= 20.0
        if draw.random() < (0.5 if bad else 0.005):
            noted.append(true / (1.0 + off) + drift)
    found = sector_of(sorted(noted))
    assert found.found
    assert away_deg(found.centre_deg, centre) < 15.0
    assert found.half_deg < 25.0
    assert found.off == pytest.approx(off, abs=1e-4)
    assert sum(found.sectors) == found.errors == len(noted)


def test_errors_at_any_angle_seldom_look_like_a_worn_place() -> None:
    said = 0
    for seed in range(200):
        draw = Random(f"anywhere {seed}")
        said += sector_of(sorted(draw.uniform(0.0, 500.0) for _ in range(40))).found
    assert said <= 2  # CHANCE allows at most one in a thousand


def test_few_errors_are_no_evidence() -> None:
    few = sector_of([0.25 + turn for turn in range(LEAST_ERRORS - 1)])
    assert not few.found
    assert isnan(few.centre_deg)
    assert not sector_of([]).found


@pytest.mark.parametrize(("rev_s", "place"), [(0.0, 0), (0.019, 0), (0.02, 1), (1.0, 2), (3.2, 3), (4.0, 4)])
def test_speeds_have_classes(rev_s: float, place: int) -> None:
    assert speed_class(rev_s) == place


def test_classes_have_words() -> None:
    expected = ["standing", "0 to 1 rev/s", "1 to 2 rev/s", "2 to 4 rev/s", "from 4 rev/s"]
    assert [speed_words(place) for place in range(5)] == expected


@pytest.mark.parametrize("seed", range(10))
def test_errors_that_grow_with_age_are_a_trend_and_equal_ones_are_none(seed: int) -> None:
    draw = Random(seed)
    ages = [5000.0 * number for number in range(1, 9)]
    growing = [(age, 20_000, sum(draw.random() < 0.0005 + 1e-7 * age for _ in range(20_000))) for age in ages]
    trend = trend_of(growing)
    assert trend.grows
    assert trend.per_thousand_turns == pytest.approx(0.1, abs=0.06)
    assert not trend_of([(age, 20_000, 20) for age in ages]).grows


def test_one_run_or_none_with_errors_has_no_trend() -> None:
    assert isnan(trend_of([(5000.0, 1000, 3)]).per_thousand_turns)
    assert isnan(trend_of([(5000.0, 1000, 0), (9000.0, 1000, 0)]).per_thousand_turns)


@pytest.mark.parametrize(("late", "says"), [(60, "grows"), (10, "no trend beyond chance"), (0, "falls")])
def test_a_trend_is_reported_in_words(late: int, says: str) -> None:
    assert trend_of([(1000.0, 10_000, 10), (2000.0, 10_000, late)]).words.endswith(says)
