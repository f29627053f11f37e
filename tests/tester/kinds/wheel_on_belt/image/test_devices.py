"""From drivers to the process image and back."""

from __future__ import annotations

from math import hypot

import pytest

from drivers.cia402 import Goal, State
from tester.kinds.wheel_on_belt.image.devices import OUTPUT_CONTACTOR, Devices
from tester.kinds.wheel_on_belt.image.process_image import Readings, Setpoints
from tester.machine.rig_ports import Ports
from tester.run.simulated import simulated_ports
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import Simulation


@pytest.fixture
def devices() -> Devices:
    """Drivers that have received nothing yet."""
    ports, _, _ = simulated_ports(rig(), 0, None)
    return Devices(rig(), ports)


def filled(devices: Devices, diameter_mm: float = 90.0, now: float = 1.0) -> Readings:
    readings = Readings(diameter_mm=diameter_mm)
    for drive in devices.drives:
        drive.news = True  # the tests set states by hand
    devices.fill(readings, now)
    return readings


def enabled(devices: Devices) -> None:
    for drive in devices.drives:
        drive.state = State.OPERATION_ENABLED


def test_a_device_never_received_is_stale(devices: Devices) -> None:
    r = filled(devices)
    stamps = (r.wheel_at_s, r.belt_at_s, r.press_at_s, r.cell_at_s, r.surface_at_s, r.jacket_at_s)
    assert set(stamps) == {float("-inf")}
    assert not (r.cell_valid or r.surface_valid or r.jacket_valid or r.drives_enabled)


def test_the_rim_speed_is_that_of_the_current_diameter(devices: Devices) -> None:
    devices.axes.wheel.actual = 10.0
    assert filled(devices, 88.0).wheel_speed_m_s == pytest.approx(0.44)


def test_slip_is_the_resultant_of_speeds_and_sideslip(devices: Devices) -> None:
    devices.axes.wheel.actual, devices.axes.belt.actual = 0.8 / 0.045, 0.5
    devices.axes.positioned["sideslip"].actual = 20.0
    assert filled(devices).slip_m_s == pytest.approx(0.371814, abs=1e-6)


@pytest.mark.parametrize("late", ["sideslip", "camber"])
def test_positions_are_as_old_as_the_drive_with_the_oldest_report(devices: Devices, late: str) -> None:
    for name, drive in devices.axes.positioned.items():
        drive.stamp_s = 1.0 if name == late else 2.0
    r = Readings(diameter_mm=90.0)
    devices.fill(r, 2.5)
    assert r.positions_at_s == 1.0


def test_all_drives_have_to_be_enabled_to_count_as_enabled(devices: Devices) -> None:
    enabled(devices)
    assert filled(devices).drives_enabled
    devices.axes.press.state = State.SWITCHED_ON
    r = filled(devices)
    assert not r.drives_enabled and not r.drives_disabled


@pytest.mark.parametrize("state", [State.FAULT, State.FAULT_REACTION])
def test_a_drive_in_fault_is_named(devices: Devices, state: State) -> None:
    devices.axes.belt.state = state
    assert filled(devices).drive_fault == "belt drive: fault"


def test_a_lost_drive_is_named(devices: Devices) -> None:
    devices.axes.positioned["camber"].lost = True
    assert filled(devices).drive_fault == "camber drive: heartbeat lost"


def test_angles_add_up_from_the_drive_s_own_time_stamps(devices: Devices) -> None:
    wheel, r = devices.axes.wheel, Readings()
    wheel.actual = 2.0 * 3.141592653589793
    for stamp in (0.0, 0.1, 0.1, 0.2):
        wheel.stamp_s = stamp
        devices.fill(r, stamp)
    assert r.wheel_angle_rev == pytest.approx(0.2)


@pytest.mark.parametrize("bit, name", [(16, "safety_chain"), (17, "guard_closed"), (18, "contactor_closed")])
def test_safety_inputs_come_from_the_press_drive(devices: Devices, bit: int, name: str) -> None:
    assert not getattr(filled(devices), name)
    devices.axes.press.inputs = 1 << bit
    r = filled(devices)
    assert getattr(r, name) and r.safety_chain + r.guard_closed + r.contactor_closed == 1


def test_the_inputs_are_as_old_as_their_last_frame(devices: Devices) -> None:
    assert filled(devices).inputs_at_s == float("-inf")
    devices.axes.press.inputs_stamp_s = 0.7
    assert filled(devices).inputs_at_s == 0.7


@pytest.mark.parametrize(("closed", "wanted"), [(True, False), (False, True)])
def test_a_contactor_that_is_not_as_wanted_is_asked_again(devices: Devices, closed: bool, wanted: bool) -> None:
    press = devices.axes.press
    press.inputs = closed << 18
    filled(devices)
    devices.apply(Setpoints(contactor=closed))
    assert not press.outputs_unanswered
    devices.apply(Setpoints(contactor=wanted))
    assert press.outputs_unanswered


def test_setpoints_reach_their_drives(devices: Devices) -> None:
    devices.apply(Setpoints(
        wheel_rad_s=12.0, belt_m_s=0.5, press_mm_s=-3.0, positions={"sideslip": 20.0, "camber": 5.0}, enable=True,
        contactor=True,
    ))
    axes = devices.axes
    assert (axes.wheel.target, axes.belt.target, axes.press.target) == (12.0, 0.5, -3.0)
    assert {name: drive.target for name, drive in axes.positioned.items()} == {"sideslip": 20.0, "camber": 5.0}
    assert all(drive.goal is Goal.ENABLED for drive in devices.drives)
    assert axes.press.outputs == OUTPUT_CONTACTOR


def test_a_quick_stop_leaves_the_press_its_retraction(devices: Devices) -> None:
    devices.apply(Setpoints(press_mm_s=-10.0, enable=True, quick_stop=True))
    assert devices.axes.press.goal is Goal.ENABLED and devices.axes.press.target == -10.0
    assert devices.axes.wheel.goal is devices.axes.belt.goal is Goal.QUICK_STOP


def test_disabled_drives_get_the_goal_disabled(devices: Devices) -> None:
    devices.apply(Setpoints())
    assert all(drive.goal is Goal.DISABLED for drive in devices.drives)
    assert devices.axes.press.outputs == 0


def test_all_is_off_only_without_a_powered_stage(devices: Devices) -> None:
    assert devices.all_off()
    devices.axes.positioned["camber"].state = State.QUICK_STOP_ACTIVE
    assert not devices.all_off()


def test_a_manual_axis_has_no_drive() -> None:
    config = rig("axes.camber={manual: true}")
    ports, _, _ = simulated_ports(config, 0, None)
    devices = Devices(config, Ports(ports.can, ports.lines))
    assert "camber" not in devices.axes.positioned and len(devices.drives) == 4


def test_on_a_rig_the_readings_are_those_of_the_plant(mid_burst: Simulation) -> None:
    r, plant = mid_burst.ctx.readings, mid_burst.world.plant
    assert r.force_z_n == pytest.approx(plant.force_z_n, abs=10.0)
    assert r.slip_m_s == pytest.approx(plant.slip_m_s, abs=0.005)
    assert hypot(r.force_x_n, r.force_y_n) == pytest.approx(hypot(plant.force_x_n, plant.force_y_n), abs=15.0)
    assert r.hub_c == pytest.approx(plant.hub_c, abs=1.0)


def test_on_a_rig_the_torques_of_press_and_belt_show_load_and_friction(mid_burst: Simulation) -> None:
    r, plant = mid_burst.ctx.readings, mid_burst.world.plant
    screw = mid_burst.ctx.rig.axes.press.screw
    assert screw is not None
    assert screw.reached_n(r.press_torque_nm) - 5.0 < plant.force_z_n < screw.held_n(r.press_torque_nm) + 5.0
    assert r.belt_torque_nm == pytest.approx(0.4 - 0.05 * plant.belt_force_n, rel=0.05)
