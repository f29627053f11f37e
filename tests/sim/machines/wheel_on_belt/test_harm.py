"""The harm observer judges the true state, not the measured one."""

from __future__ import annotations

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds import load_rig
from tester.run.simulated import spec_of
from tests.campaigns.faults.wheel_harm import HarmObserver, Truth


@pytest.fixture
def rig() -> WheelRig:
    config = load_rig("sim")
    rig = WheelRig(spec_of(config), config.sim, 0)
    rig.install(0, 0, "1#", new_specimen=True)
    return rig


def watched(rig: WheelRig, seconds: float, *, must_stand: bool = False, planned_w: float = 0.0) -> dict[str, str]:
    """Watch a rig whose state does not change for some time."""
    observer = HarmObserver(rig, planned_w)
    observer.look(must_stand)
    for _ in range(round(seconds / 0.01)):
        rig.now_s += 0.01
        observer.look(must_stand)
    return observer.found


def test_a_rig_at_rest_does_no_harm(rig: WheelRig):
    assert watched(rig, 2.0, must_stand=True) == {}


def test_a_force_above_the_limit_is_harm_at_once(rig: WheelRig):
    rig.plant.force_z_n = 501.0
    assert "force" in watched(rig, 0.02)


def test_a_hot_contact_and_a_hot_hub_are_harm(rig: WheelRig):
    rig.plant.surface_c = 131.0
    rig.plant.heat.hub_c = 156.0
    assert set(watched(rig, 0.02)) == {"contact temperature", "hub temperature"}


@pytest.mark.parametrize(("seconds", "harm"), [(0.4, False), (0.7, True)])
def test_slip_power_is_harm_after_half_a_second(rig: WheelRig, seconds: float, harm: bool):
    rig.plant.force_z_n, rig.plant.slip_m_s = 400.0, 1.0
    rig.axes["wheel"].axis.value, rig.axes["belt"].axis.value = 10.0, 1.0
    assert ("slip power" in watched(rig, seconds)) is harm


def test_slip_power_that_is_planned_is_none(rig: WheelRig):
    rig.plant.force_z_n, rig.plant.slip_m_s = 400.0, 1.0
    rig.axes["wheel"].axis.value, rig.axes["belt"].axis.value = 10.0, 1.0
    assert watched(rig, 1.0, planned_w=400.0) == {}


@pytest.mark.parametrize(("seconds", "harm"), [(0.2, False), (0.5, True)])
def test_rubbing_a_standing_wheel_is_harm_by_its_energy(rig: WheelRig, seconds: float, harm: bool):
    plant = rig.plant
    plant.force_z_n, plant.force_x_n, plant.slip_m_s = 200.0, 140.0, 0.8
    rig.axes["belt"].axis.value = 0.8
    assert ("one axis stopped under load" in watched(rig, seconds)) is harm


@pytest.mark.parametrize(("seconds", "harm"), [(0.4, False), (0.7, True)])
def test_heat_on_a_standing_wheel_is_harm_after_half_a_second(rig: WheelRig, seconds: float, harm: bool):
    io = rig.axes["press"].io
    assert io is not None
    io.contactor_closed = True
    rig.jacket.heater_w = 100.0
    assert ("heat on a standing wheel" in watched(rig, seconds)) is harm


def test_heat_that_the_contactor_holds_back_is_none(rig: WheelRig):
    rig.jacket.heater_w = 100.0
    assert Truth.of(rig).heater_w == 0.0


def test_motion_where_everything_must_stand_is_harm(rig: WheelRig):
    rig.axes["belt"].axis.value = 0.05
    assert "motion where everything must stand" in watched(rig, 0.05, must_stand=True)
    assert watched(rig, 0.05, must_stand=False) == {}


def test_an_approaching_press_is_motion_and_a_retracting_press_is_not(rig: WheelRig):
    rig.axes["press"].axis.value = -20.0
    assert watched(rig, 0.05, must_stand=True) == {}
    observer = HarmObserver(rig)
    observer.look(must_stand=True)
    rig.now_s += 0.01
    rig.axes["press"].axis.position += 1.5
    observer.look(must_stand=True)
    assert "motion where everything must stand" in observer.found


def test_everything_missing_for_the_safe_state_is_named(rig: WheelRig):
    rig.plant.force_z_n = 8.0
    rig.axes["wheel"].axis.value = 2.0
    missing = Truth.of(rig).unsafe()
    assert [text.split()[0] for text in missing] == ["force", "wheel"]


def test_a_creeping_wheel_is_safe_in_a_cool_down_only(rig: WheelRig):
    rig.axes["wheel"].axis.value = 0.1 / 0.045
    assert Truth.of(rig).unsafe(creeping=True) == []
    assert Truth.of(rig).unsafe() != []
