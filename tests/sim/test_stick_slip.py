"""The saw-tooth of a contact that sticks and slips."""

from __future__ import annotations

import itertools
from copy import deepcopy

import pytest

from sim.noise import SLIP_SHARE, NormalStream, StickSlip

STEPS = 20_000


def course(frequency_hz: float = 4.0, seed: int = 1) -> list[float]:
    made = StickSlip(0.2, frequency_hz, NormalStream(seed, "periods"))
    return [made.factor(0.001) for _ in range(STEPS)]


def test_its_mean_is_one_and_its_ends_are_the_share_away() -> None:
    found = course()
    assert sum(found) / STEPS == pytest.approx(1.0, abs=0.002)
    assert min(found) == pytest.approx(0.8, abs=0.005) and max(found) == pytest.approx(1.2, abs=0.005)


def test_it_falls_within_a_part_of_its_period() -> None:
    found = course()
    falling = sum(b < a for a, b in itertools.pairwise(found)) / STEPS
    assert falling == pytest.approx(SLIP_SHARE, abs=0.02)


def test_it_comes_so_often_a_second_in_the_mean() -> None:
    found = course(5.0)
    crossings = sum(a < 1.0 <= b for a, b in itertools.pairwise(found))
    assert crossings / (0.001 * STEPS) == pytest.approx(5.0, rel=0.03)


def test_a_copy_continues_independently_and_identically() -> None:
    one = StickSlip(0.2, 4.0, NormalStream(1, "periods"))
    for _ in range(700):
        one.factor(0.01)
    other = deepcopy(one)
    assert [one.factor(0.01) for _ in range(200)] == [other.factor(0.01) for _ in range(200)]
