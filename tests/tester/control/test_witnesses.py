"""The witnesses of force and friction at their bounds: nothing just inside, their row just outside, either way."""

from __future__ import annotations

import math

import pytest

from tests.tester.control.conftest import Bench


def first(bench: Bench) -> str:
    """Return what trips within half a second, or ""."""
    bench.until_trip(0.5)
    return bench.state.trip.name if bench.state.trip is not None else ""


@pytest.mark.parametrize(("by_n", "row"), [(13.0, ""), (-13.0, ""), (15.0, "force step"), (-15.0, "force step")])
def test_a_step_of_the_force(bench: Bench, by_n: float, row: str) -> None:
    bench.scans(0.2)
    bench.readings.force_z_n += by_n
    assert first(bench) == row


def test_a_change_of_force_that_the_press_explains_is_no_step(bench: Bench) -> None:
    bench.demand.load_n = 260.0
    stiffness = bench.control.rig.loops.load.stiffness_n_per_mm
    for _ in range(20):
        bench.readings.press_mm += 0.02
        bench.readings.force_z_n += 0.02 * stiffness * (bench.readings.force_z_n / 200.0) ** 0.23
        bench.scan()
    assert first(bench) == ""


@pytest.mark.parametrize(
    ("witness", "off_n", "row"),
    [("least", 19.0, ""), ("least", 21.0, "press torque"), ("most", -19.0, ""), ("most", -21.0, "press torque")],
)
def test_a_force_outside_what_the_torque_allows(bench: Bench, witness: str, off_n: float, row: str) -> None:
    """The torque is that at which the least, or the greatest, force it can mean is this far from the one shown."""
    bench.screws = False
    band, force_n = bench.control.view.press_band, bench.readings.force_z_n + off_n + 40.0
    if witness == "least":
        bench.readings.press_torque_nm = force_n / band.least_n_per_nm + band.drag_nm
    else:
        bench.readings.press_torque_nm = force_n / band.most_n_per_nm - band.drag_nm
    assert first(bench) == row


def test_a_press_without_a_screw_in_the_rig_file_has_no_witness(bench: Bench) -> None:
    bench.screws = False
    bench.control.view.press_band.known = False
    bench.readings.press_torque_nm = math.nan
    assert first(bench) == ""


@pytest.mark.parametrize("slip", [0.3, -0.3])
@pytest.mark.parametrize(("with_n", "row"), [(24.0, ""), (26.0, "friction sign")])
def test_friction_that_acts_with_the_slip(bench: Bench, slip: float, with_n: float, row: str) -> None:
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.8 - slip
    bench.state.setpoints.belt_m_s = 0.8 - slip
    bench.control.view.belt.begin(0.8 - slip)
    bench.readings.force_x_n = -math.copysign(with_n, slip)
    assert first(bench) == row


@pytest.mark.parametrize("force_x_n", [-140.0, 140.0])
def test_friction_has_no_sure_sign_where_the_slip_is_not_clear(bench: Bench, force_x_n: float) -> None:
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.76
    bench.control.view.belt.begin(0.76)
    bench.readings.slip_m_s, bench.readings.force_x_n = 0.04, force_x_n
    assert first(bench) == ""


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond_w", "row"), [(-2.0, ""), (2.0, "shaft power")])
def test_shafts_that_take_another_power_than_friction(bench: Bench, sign: float, beyond_w: float, row: str) -> None:
    """146 N go round: 116.8 W in at the wheel, 73 W back at the belt, 43.8 W of friction between."""
    bench.shafts = False
    share = 0.05
    through_w = 116.8 + 73.0
    # What is added at the wheel goes round, too.
    off_w = sign * (30.0 + share * through_w + beyond_w) / (1.0 - sign * share)
    bench.readings.drive_torque_nm += off_w / bench.readings.wheel_rad_s
    assert first(bench) == row


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond_n", "row"), [(-2.0, ""), (2.0, "friction beyond load")])
def test_more_friction_than_a_load_can_make(bench: Bench, sign: float, beyond_n: float, row: str) -> None:
    bench.readings.slip_m_s = bench.readings.force_x_n = 0.0
    bench.readings.force_y_n = sign * (2.0 * 200.0 + 250.0 + beyond_n)
    bench.control.view.force.cross_share = 1.0
    assert first(bench) == row
