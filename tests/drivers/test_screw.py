"""Facts of a press's screw, and the torque that follows from them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivers.screw import Screw

SCREW = Screw(5.0, 0.87, 0.93, 0.010, 0.020, 40.0)
K = 0.005 / 6.283185307179586


def test_the_torque_for_a_force_is_that_of_the_most_friction() -> None:
    assert SCREW.torque_nm(440.0) == pytest.approx(K * 480.0 / 0.87 + 0.020)


@pytest.mark.parametrize("force_n", [0.0, 100.0, 440.0])
def test_the_torque_for_a_force_surely_brings_it_about(force_n: float) -> None:
    assert SCREW.reached_n(SCREW.torque_nm(force_n)) == pytest.approx(force_n, abs=1e-9)


def test_with_the_least_friction_the_same_torque_presses_more() -> None:
    assert SCREW.pushed_n(SCREW.torque_nm(440.0)) == pytest.approx((K * 480.0 / 0.87 + 0.010) * 0.93 / K - 40.0)


def test_a_standing_press_holds_more_than_any_torque_pushes() -> None:
    assert SCREW.held_n(0.46) > SCREW.pushed_n(0.46) > SCREW.reached_n(0.46)


def test_a_torque_less_than_drag_and_spring_presses_nothing() -> None:
    assert SCREW.pushed_n(0.005) == SCREW.reached_n(0.005) == 0.0


def test_a_spring_whose_force_grows_leaves_less_of_a_torque_for_the_wheel() -> None:
    grows = replace(SCREW, spring_rate_n_per_mm=0.5)
    assert grows.lifts_n(10.0) == 45.0
    assert grows.torque_nm(435.0, 10.0) == SCREW.torque_nm(440.0)
    assert grows.pushed_n(0.46, 10.0) == pytest.approx(SCREW.pushed_n(0.46) - 5.0)
    assert grows.reached_n(0.46, 10.0) == pytest.approx(SCREW.reached_n(0.46) - 5.0)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"lead_mm": 0.0}, "lead"),
        ({"efficiency_least": 0.5}, "efficiency"),
        ({"efficiency_most": 0.8}, "efficiency"),
        ({"efficiency_most": 1.1}, "efficiency"),
        ({"drag_least_nm": 0.03}, "drag_least"),
        ({"spring_n": -1.0}, "spring_n"),
        ({"spring_rate_n_per_mm": -0.1}, "spring_rate"),
        ({"spring_n": 0.0, "spring_rate_n_per_mm": 0.1}, "spring_rate"),
        ({"lead_mm": float("nan")}, "lead_mm"),
    ],
)
def test_a_screw_that_cannot_be_is_refused_by_name(wrong: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(SCREW, **wrong)
