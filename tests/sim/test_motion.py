"""Motion of simulated axes: closed-form trajectories that do not depend on the step length."""

from __future__ import annotations

import copy
from math import exp, inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.nodes.motion import PositionAxis, VelocityAxis

cuts = st.lists(st.floats(0.0005, 0.1), min_size=1, max_size=40)


def run(axis: VelocityAxis | PositionAxis, seconds: float, dt: float = 0.01) -> None:
    for _ in range(round(seconds / dt)):
        axis.step(dt)


def test_velocity_ramps_linearly_at_the_acceleration() -> None:
    axis = VelocityAxis(acceleration=2.0)
    axis.aim(1.0)
    axis.step(0.3)
    assert axis.value == pytest.approx(0.6)
    assert axis.position == pytest.approx(0.5 * 2.0 * 0.3**2)


def test_velocity_reaches_the_target_exactly_and_settles() -> None:
    axis = VelocityAxis(acceleration=2.0)
    axis.aim(1.0)
    run(axis, 1.0)
    assert axis.value == 1.0
    assert axis.settled
    assert not axis.still
    assert axis.position == pytest.approx(0.25 + 0.5)


def test_deceleration_has_its_own_rate() -> None:
    axis = VelocityAxis(acceleration=10.0, deceleration=1.0)
    axis.aim(2.0)
    run(axis, 1.0)
    axis.aim(0.0)
    axis.step(0.5)
    assert axis.value == pytest.approx(1.5)


def test_reversal_decelerates_to_zero_and_accelerates_beyond() -> None:
    axis = VelocityAxis(acceleration=2.0, deceleration=1.0)
    axis.aim(1.0)
    run(axis, 1.0)
    axis.aim(-1.0)
    axis.step(1.25)  # 1 s down at 1 unit/s2, 0.25 s up at 2 unit/s2
    assert axis.value == pytest.approx(-0.5)


def test_a_stopped_axis_is_still() -> None:
    axis = VelocityAxis(acceleration=2.0, lag_s=0.01)
    axis.aim(1.0)
    run(axis, 1.0)
    axis.aim(0.0)
    run(axis, 1.0)
    assert axis.still
    assert axis.value == 0.0


def test_lag_follows_a_ramp_by_slope_times_lag() -> None:
    axis = VelocityAxis(acceleration=2.0, lag_s=0.01)
    axis.aim(10.0)
    axis.step(1.0)
    assert axis.demand == pytest.approx(2.0)
    assert axis.value == pytest.approx(2.0 - 2.0 * 0.01)


def test_lag_is_exponential_after_the_ramp() -> None:
    axis = VelocityAxis(acceleration=1e9, lag_s=0.1)
    axis.aim(1.0)
    axis.step(0.1)
    assert axis.value == pytest.approx(1.0 - exp(-1.0), abs=1e-6)


@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(0.0, 0.05), cuts)
def test_velocity_trajectory_does_not_depend_on_the_cuts(
    first: float, second: float, lag: float, steps: list[float]
) -> None:
    whole = VelocityAxis(acceleration=7.0, deceleration=3.0, lag_s=lag)
    whole.aim(first)
    whole.step(0.4)
    pieces = copy.deepcopy(whole)
    whole.aim(second)
    pieces.aim(second)
    whole.step(sum(steps))
    for dt in steps:
        pieces.step(dt)
    assert pieces.value == pytest.approx(whole.value, abs=3e-6)
    assert pieces.position == pytest.approx(whole.position, abs=3e-5)


def test_blocked_shaft_is_at_rest_while_the_demand_moves_on() -> None:
    axis = VelocityAxis(acceleration=2.0)
    axis.aim(1.0)
    run(axis, 1.0)
    axis.block(True)
    before = axis.position
    run(axis, 0.5)
    assert (axis.value, axis.demand, axis.position) == (0.0, 1.0, before)


def test_freed_shaft_returns_to_the_demand() -> None:
    axis = VelocityAxis(acceleration=2.0, lag_s=0.01)
    axis.aim(1.0)
    axis.block(True)
    run(axis, 1.0)
    axis.block(False)
    run(axis, 0.5)
    assert axis.value == 1.0


def test_hard_stop_ends_the_motion_at_its_position() -> None:
    axis = VelocityAxis(acceleration=100.0, position=5.0, low=0.0)
    axis.aim(-20.0)
    run(axis, 1.0)
    assert (axis.position, axis.value, axis.still) == (0.0, 0.0, True)


def test_axis_leaves_a_hard_stop_with_a_new_target() -> None:
    axis = VelocityAxis(acceleration=100.0, position=1.0, low=0.0, high=2.0)
    axis.aim(-20.0)
    run(axis, 1.0)
    axis.aim(1.0)
    run(axis, 0.5)
    assert axis.value == 1.0
    assert 0.4 < axis.position < 0.5


@pytest.mark.parametrize("rate", [0.0, -1.0, inf, nan])
def test_a_useless_acceleration_is_refused(rate: float) -> None:
    with pytest.raises(ValueError, match="acceleration"):
        VelocityAxis(acceleration=rate)


def test_short_move_is_a_triangle() -> None:
    axis = PositionAxis(max_speed=100.0, acceleration=2.0)
    axis.move(2.0, 100.0)
    axis.step(1.0)
    assert axis.position == pytest.approx(1.0)
    assert axis.value == pytest.approx(2.0)
    axis.step(1.0)
    assert (axis.position, axis.value, axis.still) == (2.0, 0.0, True)


def test_long_move_is_a_trapezoid_at_the_speed_limit() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0, deceleration=5.0)
    axis.move(-20.0, 5.0)  # 0.5 s up, 1 s down, 20 - 1.25 - 2.5 units at 5 units/s between
    axis.step(2.0)
    assert axis.value == -5.0
    axis.step(0.5 + 1.0 + 16.25 / 5.0 - 2.0 + 1e-9)
    assert (axis.position, axis.value, axis.still) == (-20.0, 0.0, True)


def test_retarget_behind_brakes_and_returns() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0)
    axis.move(10.0, 5.0)
    axis.step(1.0)
    axis.move(0.0, 5.0)
    axis.step(0.25)
    assert axis.value == pytest.approx(2.5)
    axis.step(10.0)
    assert (axis.position, axis.still) == (0.0, True)


def test_retarget_too_near_to_brake_overshoots_and_comes_back() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0)
    axis.move(10.0, 5.0)
    axis.step(1.0)
    near = axis.position + 0.1
    axis.move(near, 5.0)
    axis.step(0.5)
    assert axis.position > near
    axis.step(5.0)
    assert (axis.position, axis.still) == (near, True)


def test_lower_speed_on_the_way_brakes_to_it() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0)
    axis.move(100.0, 5.0)
    axis.step(1.0)
    axis.move(100.0, 1.0)
    axis.step(1.0)
    assert axis.value == 1.0


def test_stop_ramps_down_and_rests_where_it_ends() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0)
    axis.move(100.0, 5.0)
    axis.step(1.0)
    start = axis.position
    axis.stop(25.0)
    axis.step(1.0)
    assert axis.still
    assert axis.position == axis.target == pytest.approx(start + 0.5)


def test_blocked_positioning_axis_falls_behind_its_demand_and_keeps_its_target() -> None:
    axis = PositionAxis(max_speed=5.0, acceleration=10.0)
    axis.move(1.0, 5.0)
    axis.block(True)
    axis.step(1.0)
    assert (axis.position, axis.value, axis.demand) == (0.0, 0.0, 1.0)
    axis.block(False)
    axis.step(2.0)
    assert axis.position == 1.0


@given(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0), st.floats(0.0, 3.0), cuts)
def test_position_trajectory_does_not_depend_on_the_cuts(
    first: float, second: float, lead: float, steps: list[float]
) -> None:
    whole = PositionAxis(max_speed=12.0, acceleration=30.0, deceleration=20.0)
    whole.move(first, 12.0)
    whole.step(lead)
    pieces = copy.deepcopy(whole)
    whole.move(second, 8.0)
    pieces.move(second, 8.0)
    whole.step(sum(steps))
    for dt in steps:
        pieces.step(dt)
    assert pieces.position == pytest.approx(whole.position, abs=1e-6)


@given(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0), st.floats(0.0, 3.0))
def test_every_move_ends_on_its_target(first: float, second: float, lead: float) -> None:
    axis = PositionAxis(max_speed=12.0, acceleration=30.0, deceleration=20.0)
    axis.move(first, 12.0)
    axis.step(lead)
    axis.move(second, 12.0)
    run(axis, 30.0, 0.1)
    assert axis.position == second
    assert axis.still
