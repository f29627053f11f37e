"""Exposure of a fault depends on the rig and the plan, never on control's beliefs."""

from __future__ import annotations

from functools import cache

import pytest

from drivers.canopen import objects as o
from sim.faults.kinds import Expected, Exposure, FaultKind
from sim.machines.wheel_on_belt.faults import CATALOGUE, LANGUAGE
from sim.machines.wheel_on_belt.faults.catalogue import WheelExposure
from tester.kinds.wheel_on_belt.image.process_image import Press
from tests.campaigns.faults.exposure import Exposed
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.stage import Stage


@cache
def sliding() -> Stage:
    moment = next(m for m in rehearse("short")[0] if m.step.endswith(" measure") and m.phase == "middle")
    found: list[Stage] = []

    def keep(moment: Moment, twins: Twins) -> None:
        found.append(twins.copy())

    visit("short", [moment], keep)
    return found[0]


def kind(exposure: Exposure | WheelExposure) -> FaultKind:
    return FaultKind("it", CATALOGUE["belt torn"].make, exposure, Expected.TRIP, 1.0)


@pytest.mark.parametrize(
    "exposure", [Exposure.ENABLED, WheelExposure.TURNING, WheelExposure.LOADED, WheelExposure.PRESSING,
                 WheelExposure.SLIDING, WheelExposure.RUBBING, WheelExposure.HEATING, WheelExposure.RUNNING],
)  # fmt: skip
def test_what_control_wants_and_knows_switches_no_budget_off(exposure: Exposure | WheelExposure):
    stage = sliding().copy()
    exposed = Exposed(stage, kind(exposure))
    assert exposed.now()
    engine = stage.run.engine
    demand, readings, state = engine.ctx.demand, engine.ctx.readings, engine.control.state
    demand.enabled, demand.press, demand.load_n = False, Press.LIFT, 0.0
    readings.drives_enabled = False
    state.setpoints.heat, engine.ctx.contact.loaded, state.load.loaded = False, False, False
    assert exposed.now()


def test_a_torn_belt_is_exposed_although_nothing_slides_on_it():
    stage = sliding().copy()
    stage.rig.plant.slip_m_s = 0.0
    assert Exposed(stage, kind(WheelExposure.RUBBING)).now()


@pytest.mark.parametrize("axis", ["wheel", "belt"])
@pytest.mark.parametrize("off_m_s", [-0.15, 0.0, 0.15])
def test_a_runaway_axis_is_exposed_where_its_speed_differs_from_its_command(axis: str, off_m_s: float):
    stage = sliding().copy()
    base, radius_m = stage.rig.axes[axis].axis.value, 0.0005 * stage.rig.plant.diameter_mm
    stage.inject(LANGUAGE.parse(f"t=0 s: {axis} runs away {base + off_m_s / (radius_m if axis == 'wheel' else 1.0):.6g}"
                       f" {'rad/s' if axis == 'wheel' else 'm/s'}").shifted(stage.next_s))  # fmt: skip
    exposed = Exposed(stage, CATALOGUE[f"{axis} runs away"])
    assert not exposed.now()
    seen = False
    for _ in range(12):
        stage.tick()
        seen = seen or exposed.now()
    assert seen is bool(off_m_s)


@pytest.mark.parametrize("axis", ["wheel", "belt"])
def test_a_frozen_speed_is_exposed_once_another_one_is_commanded(axis: str):
    stage = sliding().copy()
    stage.inject(LANGUAGE.parse(f"t=0 s: {axis} drive feedback frozen").shifted(stage.next_s))
    exposed = Exposed(stage, CATALOGUE[f"{axis} drive feedback frozen"])
    for _ in range(3):
        stage.tick()
    assert not exposed.now()
    drive = stage.rig.axes[axis]
    drive.store.values[(o.TARGET_VELOCITY, 0)] //= 2
    assert exposed.now()


def test_a_press_told_to_lift_holds_no_load():
    stage = sliding().copy()
    exposed = Exposed(stage, kind(WheelExposure.PRESSING))
    stage.rig.axes["press"].axis.aim(-10.0)  # type: ignore[union-attr]
    assert not exposed.now()


def test_a_cell_that_shows_half_of_it_is_exposed_once_its_load_is_brought():
    stage = sliding().copy()
    stage.inject(LANGUAGE.parse("t=0 s: load cell reads low").shifted(stage.next_s))
    stage.tick()
    exposed = Exposed(stage, kind(WheelExposure.MISWEIGHED))
    assert not exposed.now()
    stage.rig.plant.force_z_n = 400.0
    assert exposed.now()


@pytest.mark.parametrize(
    ("output", "hidden_k", "exposed"), [(100.0, 7.0, True), (70.0, 7.0, False), (100.0, 5.0, False)]
)
def test_heat_is_hidden_where_much_is_given_and_much_of_it_not_shown(output: float, hidden_k: float, exposed: bool):
    stage = sliding().copy()
    plant, jacket = stage.rig.plant, stage.rig.jacket
    jacket.pv_c = plant.parameters.ambient + 5.0
    plant.heat.hub_c = jacket.pv_c + hidden_k
    jacket.running, jacket.output = True, output
    assert Exposed(stage, kind(WheelExposure.HIDDEN)).now() is exposed
    jacket.pv_c += 20.0
    plant.heat.hub_c += 20.0
    assert not Exposed(stage, kind(WheelExposure.HIDDEN)).now(), "7 K of 25 K are within twice the row's share"


@pytest.mark.parametrize("exposure", [WheelExposure.MISREAD, WheelExposure.STARVED, WheelExposure.UNASKED,
                                      WheelExposure.OVERHEATED, WheelExposure.HOT, WheelExposure.WELDED,
                                      Exposure.CONNECTING, WheelExposure.MISWEIGHED, WheelExposure.HIDDEN])  # fmt: skip
def test_a_sound_rig_shows_no_fault_of_a_sensor_or_of_the_heat(exposure: Exposure | WheelExposure):
    assert not Exposed(sliding().copy(), kind(exposure)).now()
