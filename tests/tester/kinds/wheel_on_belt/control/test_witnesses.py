"""The witnesses of force and friction at their bounds: nothing just inside, their row just outside, either way."""

from __future__ import annotations

import math

import pytest

from tests.tester.kinds.wheel_on_belt.control.conftest import Bench


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
def test_a_force_outside_the_range_of_the_torque(bench: Bench, witness: str, off_n: float, row: str) -> None:
    """Set the torque whose least, or greatest, possible force is this far from the reading."""
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
    # Power added at the wheel also circulates.
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


def _takes(bench: Bench, belt_nm: float) -> str:
    bench.shafts = False
    bench.readings.belt_torque_nm = belt_nm
    return first(bench)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond_nm", "row"), [(-0.05, ""), (0.05, "belt torque")])
def test_a_belt_drive_that_takes_another_torque_than_friction(
    bench: Bench, sign: float, beyond_nm: float, row: str
) -> None:
    """146 N on the belt are 7.3 N m of braking at its roller of 50 mm."""
    assert _takes(bench, -7.3 + sign * (3.0 + 0.05 * 7.3 + beyond_nm)) == row


@pytest.mark.parametrize("angle_deg", [30.0, -30.0])
def test_a_wheel_at_an_angle_loads_the_belt_with_both_forces_along_it(bench: Bench, angle_deg: float) -> None:
    """At 30 deg a slip of (0.37, 0.25) m/s: 146 N of friction, 64 N of it along the belt."""
    r, angle = bench.readings, math.radians(angle_deg)
    r.positions["sideslip"] = bench.demand.positions["sideslip"] = angle_deg
    along, across = 0.8 - 0.5 * math.cos(angle), 0.5 * math.sin(angle)
    r.slip_m_s = math.hypot(along, across)
    r.force_x_n, r.force_y_n = 146.0 * along / r.slip_m_s, 146.0 * across / r.slip_m_s
    belt_n = r.force_x_n * math.cos(angle) - r.force_y_n * math.sin(angle)
    bench.control.view.force.forget()
    assert _takes(bench, -0.05 * belt_n + 0.4) == ""
    assert _takes(bench, -0.05 * belt_n + 4.0) == "belt torque"


@pytest.mark.parametrize("slip", [0.3, -0.3])
@pytest.mark.parametrize(("pull_nm", "after_s"), [(9.9, 0.05), (10.1, 0.01)])
def test_a_belt_drive_that_acts_like_friction_trips_at_once(
    bench: Bench, slip: float, pull_nm: float, after_s: float
) -> None:
    """Below belt_pull it is as soon as "belt torque" is."""
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.8 - slip
    bench.state.setpoints.belt_m_s = 0.8 - slip
    bench.control.view.belt.begin(0.8 - slip)
    bench.readings.force_x_n = math.copysign(146.0, slip)
    bench.shafts = False
    bench.readings.belt_torque_nm = math.copysign(pull_nm, slip)
    assert bench.until_trip(0.5) == pytest.approx(after_s, abs=1e-6)


def test_a_belt_drive_pulls_at_will_while_nothing_slides_for_sure(bench: Bench) -> None:
    """Rolling, friction may act either way: only the load cell shows its direction."""
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.78
    bench.control.view.belt.begin(0.78)
    bench.state.setpoints.belt_m_s = 0.78
    bench.readings.slip_m_s, bench.readings.force_x_n, bench.readings.drive_torque_nm = 0.02, -400.0, -18.0
    bench.control.view.force.cross_share = 1.0
    assert _takes(bench, 20.0) == ""


@pytest.mark.parametrize(("scan_s", "row"), [(0.05, "belt caught"), (0.01, "belt torque")])
def test_rolling_the_load_cell_gives_the_belt_torque_at_once_only_while_scans_are_slow(
    bench: Bench, scan_s: float, row: str
) -> None:
    """While a command changes, Fx and torque, read at two times, may have opposite signs."""
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.8
    bench.control.view.belt.begin(0.8)
    bench.state.setpoints.belt_m_s = 0.8
    bench.readings.slip_m_s = 0.0
    bench.shafts = False
    bench.readings.belt_torque_nm, bench.readings.drive_torque_nm = 44.0, 6.6
    assert bench.until_trip(0.5, scan_s) == pytest.approx(0.05)
    assert bench.state.trip is not None and bench.state.trip.name == row


def _reverse(bench: Bench) -> None:
    """Let the belt be faster than the wheel by 0.3 m/s, and friction turn round with it."""
    bench.demand.belt_speed_m_s = bench.readings.belt_speed_m_s = bench.state.setpoints.belt_m_s = 1.1
    bench.control.view.belt.begin(1.1)
    bench.readings.force_x_n = -146.0


def test_a_reversed_slip_trips_nothing_while_all_agree(bench: Bench) -> None:
    _reverse(bench)
    assert first(bench) == ""


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond_w", "row"), [(-2.0, ""), (2.0, "shaft power")])
def test_shafts_that_take_another_power_than_friction_reversed(
    bench: Bench, sign: float, beyond_w: float, row: str
) -> None:
    """146 N go round the other way: 160.6 W in at the belt, 116.8 W back at the wheel, 43.8 W of friction between."""
    _reverse(bench)
    bench.scan()
    bench.shafts = False
    share = 0.05
    off_w = sign * (30.0 + share * (116.8 + 160.6) + beyond_w) / (1.0 + sign * share)
    bench.readings.drive_torque_nm += off_w / bench.readings.wheel_rad_s
    assert first(bench) == row


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("beyond_nm", "row"), [(-0.05, ""), (0.05, "belt torque")])
def test_a_belt_drive_that_takes_another_torque_than_friction_reversed(
    bench: Bench, sign: float, beyond_nm: float, row: str
) -> None:
    """The belt pulls the wheel on with 7.3 N m. At 1.1 m/s 3.4 N m more are 74 W: after 200 ms "shaft power" trips."""
    _reverse(bench)
    bench.scan()
    bench.shafts = False
    bench.readings.belt_torque_nm = 7.3 + sign * (3.0 + 0.05 * 7.3 + beyond_nm)
    bench.until_trip(0.15)
    assert (bench.state.trip.name if bench.state.trip is not None else "") == row
