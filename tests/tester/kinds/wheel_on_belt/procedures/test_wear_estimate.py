"""Loss of diameter, wear rate and dent from the places of touches: made-up wheels whose truth is known."""

from __future__ import annotations

from math import hypot, nan
from random import Random

import pytest

from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.procedures.wear_estimate import (
    DECADES,
    DISAGREEMENTS,
    LoadMemory,
    WearEstimate,
    loss_per_n_m,
)
from tester.kinds.wheel_on_belt.procedures.wheel_life import AGREES_MM, WheelLife

TOUCH_N, STIFFNESS = 10.0, 145.0
PER_N_M = loss_per_n_m(90.0, 30.0)


class Rubber:
    """A wheel with a wear rate, and rubber that gives way by a share of a load in a decade of time."""

    def __init__(self, rate: float, share: float = 0.0, seed: int = 1) -> None:
        self.rate, self.share = rate, share
        self.estimate = WearEstimate()
        self.estimate.begin(0.08, 0.2, 0.0, 0.0)
        self.exposure_n_m = 0.0
        self.noise = Random(seed)

    @property
    def loss_mm(self) -> float:
        return self.rate * PER_N_M * self.exposure_n_m

    def touch(self, exposure_n_m: float, remembered_n: float, off_mm: float = 0.0) -> bool:
        """Slide on, then touch with a load remembered; the place is off by runout."""
        self.exposure_n_m += exposure_n_m
        lost_n = self.share * remembered_n
        dent_mm = depth_mm(TOUCH_N + lost_n, STIFFNESS) - depth_mm(TOUCH_N, STIFFNESS)
        place_mm = 10.0 + 0.5 * self.loss_mm + dent_mm + 0.018 * self.noise.gauss(0.0, 1.0) + 0.5 * off_mm
        self.estimate.slid(self.exposure_n_m, PER_N_M)
        return self.estimate.touch(place_mm, TOUCH_N, remembered_n, 2.0, STIFFNESS)

    def live(self, touches: int) -> None:
        self.touch(0.0, 0.0)
        self.touch(9600.0, 500.0)
        for i in range(touches):
            self.touch(1000.0 if i % 2 else 0.0, (300.0, 900.0, 500.0)[i % 3])


@pytest.mark.parametrize("rate", [0.08, 0.3, 0.6])
@pytest.mark.parametrize("share", [0.0, 0.03])
def test_wear_and_dent_are_separated(rate: float, share: float) -> None:
    rubber = Rubber(rate, share)
    rubber.live(30)
    found = rubber.estimate
    assert found.loss_mm == pytest.approx(rubber.loss_mm, abs=0.2)
    assert abs(found.loss_mm - rubber.loss_mm) < 3.0 * found.u_mm
    assert found.share == pytest.approx(share, abs=0.01)
    assert found.rate_mm3_per_n_m == pytest.approx(rate, abs=max(0.2 * rate, 0.03))


def test_a_touch_without_sliding_before_it_is_no_wear() -> None:
    rubber = Rubber(0.08, 0.03)
    rubber.touch(0.0, 0.0)
    for remembered_n in (600.0, 900.0, 300.0):
        rubber.touch(0.0, remembered_n)
    assert rubber.estimate.loss_mm == pytest.approx(0.0, abs=0.08) and rubber.estimate.share > 0.02


def test_the_first_touch_is_the_reference_of_a_wheel_that_is_worn_already() -> None:
    estimate = WearEstimate()
    estimate.begin(0.08, 0.2, 1.5, 7000.0, 0.15)
    estimate.slid(7000.0, PER_N_M)
    assert estimate.touch(10.75, TOUCH_N, 0.0, 2.0, STIFFNESS)
    assert estimate.loss_mm == 1.5 and estimate.place_mm == pytest.approx(10.0) and estimate.u_mm > 0.15


def test_no_rubber_gives_way_by_less_than_nothing() -> None:
    for seed in range(20):
        rubber = Rubber(0.08, 0.0, seed)
        rubber.live(12)
        assert rubber.estimate.share >= 0.0


def test_a_touch_that_is_off_by_more_than_both_uncertainties_is_not_used() -> None:
    rubber = Rubber(0.08)
    rubber.live(20)
    before_mm = rubber.estimate.loss_mm
    for count in range(1, DISAGREEMENTS + 1):
        assert not rubber.touch(0.0, 500.0, off_mm=2.0)
        assert rubber.estimate.disagreed == count
    assert rubber.estimate.loss_mm == pytest.approx(before_mm, abs=0.02)
    assert rubber.touch(0.0, 500.0) and rubber.estimate.disagreed == 0


def test_honest_touches_of_many_wheels_never_disagree() -> None:
    for seed in range(40):
        rubber = Rubber(0.02 + 0.014 * seed, 0.001 * seed, seed)
        rubber.live(30)
        assert rubber.estimate.disagreed == 0 and rubber.estimate.touches == 32


def test_a_growth_unlike_the_believed_one_is_followed_and_not_taken_for_wear() -> None:
    for seed in range(20):
        rubber = Rubber(0.3, seed=seed)
        rubber.estimate.warmed(25.0, 0.004)
        rubber.live(20)
        before_mm, rate = rubber.estimate.loss_mm, rubber.estimate.rate_mm3_per_n_m
        rubber.estimate.warmed(75.0, 0.004)
        for _ in range(3):
            assert rubber.touch(0.0, 500.0, off_mm=0.37)
        assert rubber.estimate.loss_mm - before_mm == pytest.approx(0.37, abs=0.12)
        assert rubber.estimate.rate_mm3_per_n_m == pytest.approx(rate, rel=0.1)


def test_a_check_replaces_the_loss_and_leaves_its_own_uncertainty() -> None:
    rubber = Rubber(0.3)
    rubber.live(4)
    rubber.estimate.measured(2.0, 0.01)
    assert rubber.estimate.loss_mm == 2.0 and rubber.estimate.u_mm == pytest.approx(0.01)


def test_a_load_is_remembered_and_forgotten_decade_by_decade() -> None:
    memory = LoadMemory()
    for _ in range(10_000):
        memory.add(200.0, 0.01)
    loaded_n = memory.remembered_n()
    assert 400.0 < loaded_n < 600.0
    for _ in range(1000):
        memory.add(nan, 0.01)
    rested_n = memory.remembered_n()
    assert 0.2 * loaded_n < rested_n < 0.6 * loaded_n
    assert len(memory.averages_n) == DECADES


def wheel(loss_mm: float, seen_mm: float, variance_mm2: float = 0.0036) -> WheelLife:
    made = WheelLife(wheel=1, installed_mm=90.0, loss_mm=loss_mm)
    made.estimate.begin(0.3, 0.02, seen_mm, 0.0)
    made.estimate.measured(seen_mm, variance_mm2**0.5)
    return made


def test_the_estimated_loss_is_kept_while_touches_agree_with_it() -> None:
    agreed = wheel(0.5, 0.6, 0.0025)
    assert agreed.follow() == 0.0 and agreed.loss_mm == 0.5 and agreed.rate_mm3_per_n_m == 0.0
    assert agreed.u_mm == pytest.approx(hypot(0.05, 0.1))


@pytest.mark.parametrize(("seen_mm", "variance_mm2"), [(0.5 + AGREES_MM + 0.01, 0.04), (0.66, 0.0025)])
def test_the_loss_follows_touches_that_contradict_it(seen_mm: float, variance_mm2: float) -> None:
    contradicted = wheel(0.5, seen_mm, variance_mm2)
    assert contradicted.follow() == pytest.approx(seen_mm - 0.5)
    assert contradicted.loss_mm == seen_mm and contradicted.rate_mm3_per_n_m == 0.3
