"""Vector slip and sideslip against the worked figures."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from sim.physics.friction import COMPOUNDS, UnknownCompoundError, coefficient
from sim.physics.slip import (
    CORNERING,
    SIDESLIP_DATA,
    belt_speed_for,
    cornering_factor,
    predict,
    slip_velocity,
    traction_direction,
)


@pytest.mark.parametrize(("d", "v"), [(0.0, 0.30000), (10.0, 0.319615), (20.0, 0.371814), (30.0, 0.444049)])
def test_slip_grows_with_the_sideslip_angle(d: float, v: float) -> None:
    assert slip_velocity(0.8, 0.5, d)[2] == pytest.approx(v, abs=5e-7)


def test_slip_is_a_vector_in_the_wheels_frame() -> None:
    vx, vy, v = slip_velocity(0.8, 0.5, 30.0)
    assert (vx, vy) == pytest.approx((0.8 - 0.5 * math.cos(math.pi / 6), 0.25))
    assert v == pytest.approx(math.hypot(vx, vy))


def test_yaw_to_the_other_side_turns_the_side_slip_round() -> None:
    left, right = slip_velocity(0.8, 0.5, -20.0), slip_velocity(0.8, 0.5, 20.0)
    assert left == pytest.approx((right[0], -right[1], right[2]))


def test_belt_runs_slower_than_the_wheel_by_the_slip_velocity() -> None:
    assert belt_speed_for(0.8, 0.3) == pytest.approx(0.5)
    assert belt_speed_for(0.8, -0.2) == pytest.approx(1.0)


@pytest.mark.parametrize(("compound", "mu"), [("1#", 0.72977), ("2#", 0.49736), ("3#", 1.04982)])
def test_prediction_gives_the_published_point(compound: str, mu: float) -> None:
    assert predict(compound, 0.3, 200.0, 25.0) == pytest.approx(mu, abs=5e-6)


@pytest.mark.parametrize(
    ("d", "mu", "fx", "fy"),
    [
        (0.0, 0.7298, 145.95, 0.0),
        (10.0, 0.8316, 160.07, 45.18),
        (20.0, 0.9893, 175.70, 91.01),
        (30.0, 1.1942, 197.39, 134.47),
    ],
)
def test_sideslip_of_1_gives_the_worked_coefficients_and_forces(d: float, mu: float, fx: float, fy: float) -> None:
    assert predict("1#", 0.3, 200.0, 25.0, d) == pytest.approx(mu, abs=5e-5)
    cx, cy = traction_direction(*slip_velocity(0.8, 0.5, d)[:2])
    assert (200.0 * mu * cx, 200.0 * mu * cy) == pytest.approx((fx, fy), abs=0.02)


def test_2_has_no_cornering_beyond_its_vector_slip() -> None:
    assert predict("2#", 0.3, 200.0, 25.0, 30.0) == pytest.approx(coefficient("2#", 25.0, 200.0, 0.444049), rel=1e-5)


def test_3_has_no_sideslip_data_and_no_factor() -> None:
    assert "3#" not in SIDESLIP_DATA
    assert cornering_factor("3#", 30.0) == 1.0


def test_cornering_factor_is_the_same_to_both_sides() -> None:
    assert cornering_factor("1#", -20.0) == cornering_factor("1#", 20.0) == pytest.approx(1.19837, abs=1e-5)


def test_every_compound_states_a_cornering_factor() -> None:
    assert CORNERING.keys() == COMPOUNDS.keys()
    with pytest.raises(UnknownCompoundError):
        cornering_factor("NR", 10.0)


def test_wheel_speed_matters_only_with_sideslip() -> None:
    assert predict("1#", 0.3, 200.0, 25.0, 0.0, 0.4) == pytest.approx(predict("1#", 0.3, 200.0, 25.0))
    assert predict("1#", 0.3, 200.0, 25.0, 20.0, 0.4) < predict("1#", 0.3, 200.0, 25.0, 20.0)


def test_braking_slip_has_the_same_coefficient_and_the_opposite_force() -> None:
    assert predict("1#", -0.3, 200.0, 25.0) == pytest.approx(predict("1#", 0.3, 200.0, 25.0))
    assert traction_direction(*slip_velocity(0.8, 1.1, 0.0)[:2]) == pytest.approx((-1.0, 0.0))


def test_prediction_with_an_angle_that_is_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        predict("1#", 0.3, 200.0, 25.0, math.nan)


def test_friction_acts_along_the_slip_where_there_is_slip() -> None:
    assert traction_direction(0.3, 0.4) == pytest.approx((0.6, 0.8), abs=1e-5)


def test_without_slip_friction_acts_along_the_creep() -> None:
    assert traction_direction(0.0, 0.0) == (1.0, 0.0)


def test_force_changes_continuously_through_the_reversal() -> None:
    speeds = [i * 1e-5 for i in range(-3000, 3001)]
    along = [traction_direction(v, 0.0)[0] for v in speeds]
    assert along[0] == -1.0
    assert along[-1] == 1.0
    assert all(0.0 <= b - a < 0.04 for a, b in pairwise(along))


def test_force_direction_is_never_longer_than_one() -> None:
    for vx in (-0.02, -0.0055, -0.001, 0.0, 0.004, 0.3):
        for vy in (-0.3, -0.0004, 0.0, 0.0007, 0.02):
            assert math.hypot(*traction_direction(vx, vy)) <= 1.0 + 1e-12
