"""Wear and running-in."""

from __future__ import annotations

import pytest

from sim.physics.parameters import CounterfaceParameters
from sim.physics.wear import grip_kept, radius_loss_mm, running_in_factor


def test_a_minute_at_200_n_and_300_mm_s_takes_34_um_off_the_radius() -> None:
    assert radius_loss_mm(0.08, 200.0, 0.3 * 60.0, 90.0, 30.0) == pytest.approx(0.034, abs=5e-5)


def test_wear_is_a_volume_spread_over_the_tread() -> None:
    whole = radius_loss_mm(0.08, 200.0, 10.0, 90.0, 30.0)
    assert radius_loss_mm(0.08, 200.0, 10.0, 45.0, 60.0) == pytest.approx(whole)
    assert radius_loss_mm(0.08, 100.0, 20.0, 90.0, 30.0) == pytest.approx(whole)


def test_new_tread_has_the_whole_excess() -> None:
    assert running_in_factor(0.15, 10.0, 0.0) == 1.15


def test_pre_grinding_removes_the_running_in() -> None:
    assert running_in_factor(0.15, 10.0, 48.0) == pytest.approx(1.0, abs=0.0015)


BLUNT = CounterfaceParameters(loss=0.1)


def test_a_belt_loses_its_share_over_its_travel_and_the_same_share_again() -> None:
    assert grip_kept(BLUNT, 2000.0, 25.0) == pytest.approx(0.9)
    assert grip_kept(BLUNT, 4000.0, 25.0) == pytest.approx(0.81)
    assert grip_kept(BLUNT, 500.0, 25.0) ** 4 == pytest.approx(0.9)


def test_hot_rubber_clogs_it() -> None:
    assert grip_kept(BLUNT, 2000.0, 60.0) == pytest.approx(0.9)
    assert grip_kept(BLUNT, 2000.0, 85.0) == pytest.approx(0.9**1.5)


def test_a_belt_keeps_its_grip_unless_it_is_asked_to_lose_some() -> None:
    assert grip_kept(CounterfaceParameters(), 1e6, 85.0) == 1.0


@pytest.mark.parametrize("wrong", [{"loss": 1.0}, {"loss": -0.1}, {"loss_travel": 0.0}])
def test_what_is_no_share_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="CounterfaceParameters"):
        CounterfaceParameters(**wrong)
