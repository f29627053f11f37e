"""Torque at the shafts, and the force left to a press at a torque limit."""

from __future__ import annotations

import pytest

from sim.machines.wheel_on_belt.torque import PressScrew, ShaftTorque, capstan_n, shafts
from sim.physics.parameters import DriveParameters

K = 0.005 / 6.283185307179586
"""N m per N of a screw of 5 mm lead without friction."""


def screw(efficiency: float = 0.9, spring_n: float = 40.0) -> PressScrew:
    return PressScrew(DriveParameters(), efficiency, spring_n)


def moved(press: PressScrew, force_n: float, *places_mm: float) -> float:
    return [press.torque_nm(force_n, place_mm) for place_mm in places_mm][-1]


@pytest.mark.parametrize(("rad_s", "torque_nm"), [(10.0, 5.2), (-10.0, 4.8), (0.0, 5.0), (0.025, 5.1)])
def test_friction_of_a_shaft_is_against_its_motion(rad_s: float, torque_nm: float) -> None:
    assert ShaftTorque(0.2, 1.0).shown_nm(5.0, rad_s) == pytest.approx(torque_nm)


def test_a_drive_shows_its_torque_with_an_error_of_gain() -> None:
    assert ShaftTorque(0.2, 1.03).shown_nm(5.0, 10.0) == pytest.approx(1.03 * 5.2)


def test_a_shaft_that_turns_the_other_way_round_is_loaded_the_other_way_round() -> None:
    shaft = ShaftTorque(0.2, 1.0)
    shaft.way = -1.0
    assert shaft.shown_nm(5.0, 10.0) == pytest.approx(-4.8)


@pytest.mark.parametrize(("wrap_deg", "force_n"), [(180.0, 878.4), (90.0, 462.7)])
def test_a_roller_pulls_a_slipping_belt_by_its_wrap(wrap_deg: float, force_n: float) -> None:
    """1000 N in each strand and 0.3: with 180 deg the strands have 1439 and 561 N, a factor of exp(0.3 pi) = 2.566."""
    assert capstan_n(DriveParameters(belt_wrap=wrap_deg)) == pytest.approx(force_n, abs=0.1)


def test_pressing_takes_the_force_over_the_efficiency_and_the_drag() -> None:
    assert moved(screw(), 200.0, 10.0, 10.1) == pytest.approx(K * 240.0 / 0.9 + 0.015)


def test_going_back_friction_is_on_the_other_side() -> None:
    assert moved(screw(), 200.0, 10.1, 10.0) == pytest.approx(K * 240.0 * (2.0 - 1.0 / 0.9) - 0.015)


def test_a_press_at_rest_keeps_the_friction_it_came_to_rest_with() -> None:
    press = screw()
    pushed = moved(press, 200.0, 10.0, 10.1)
    assert moved(press, 200.0, 10.1, 10.1) == pushed
    assert moved(press, 200.0, 10.09) == pytest.approx(K * 240.0), "half of its presliding back: no friction"


@pytest.mark.parametrize("efficiency", [0.87, 0.93])
def test_the_force_pushed_and_the_force_held_are_those_of_the_torque(efficiency: float) -> None:
    pushed_n, held_n = screw(efficiency).pushed_n(0.46), screw(efficiency).held_n(0.46)
    assert moved(screw(efficiency), pushed_n, 10.0, 10.1) == pytest.approx(0.46)
    assert moved(screw(efficiency), held_n, 10.1, 10.0) == pytest.approx(0.46)
    assert pushed_n < 490.0 < 550.0 < held_n


def test_gains_and_efficiency_are_the_session_s_and_inside_their_bounds() -> None:
    drives = DriveParameters()
    sessions = [shafts(drives, 1.0, seed) for seed in range(60)]
    gains = [shaft.shown_nm(1.0, 0.0) for wheel, belt, _ in sessions for shaft in (wheel, belt)]
    efficiencies = [efficiency for _, _, efficiency in sessions]
    assert 0.97 <= min(gains) < 0.975 and 1.025 < max(gains) <= 1.03
    assert 0.87 <= min(efficiencies) < 0.875 and 0.925 < max(efficiencies) <= 0.93
    assert sessions[3][2] == shafts(drives, 1.0, 3)[2]
    assert shafts(drives, 0.0, 3)[2] == 0.9
