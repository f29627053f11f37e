"""Wear and running-in."""

from __future__ import annotations

import pytest

from sim.physics.wear import radius_loss_mm, running_in_factor


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
